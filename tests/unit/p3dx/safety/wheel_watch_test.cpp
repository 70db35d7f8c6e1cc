#include "drivers/p3dx/safety/wheel_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace luminav {
namespace {

/// Packets at 10 Hz with wheels that are told something and count something.
class WheelWatchTest : public ::testing::Test {
 protected:
  void drive(double seconds, const DriveVelocity& told, double left, double right) {
    for (int i = 0; i < static_cast<int>(std::lround(10.0 * seconds)); ++i) {
      utime_ += 100'000;
      packet_.left_mm_s = static_cast<int>(std::lround(1e3 * left));
      packet_.right_mm_s = static_cast<int>(std::lround(1e3 * right));
      watch_.update(packet_, told, utime_);
    }
  }
  static InformationPacket with_motors() {
    InformationPacket packet;
    packet.motors_enabled = true;
    return packet;
  }
  WheelWatch watch_{{}};
  InformationPacket packet_ = with_motors();
  std::int64_t utime_ = 1'000'000;
};

TEST_F(WheelWatchTest, SaysNothingOfWheelsThatDoWhatTheyAreTold) {
  drive(0.3, {0.5, 0.0}, 0.0, 0.0);  // gathers speed
  drive(5.0, {0.5, 0.5}, 0.42, 0.58);
  drive(0.6, {0.0, 0.0}, 0.3, 0.3);  // brakes
  drive(5.0, {0.0, 1.0}, -0.165, 0.165);
  drive(0.6, {0.0, -1.0}, -0.1, 0.1);  // turns round
  drive(5.0, {0.0, -1.0}, 0.165, -0.165);
  EXPECT_EQ(watch_.fault(), "");
}

TEST_F(WheelWatchTest, NamesAWheelThatIsToldToTurnAndCountsNothingWithinTwoSeconds) {
  drive(5.0, {0.4, 0.0}, 0.4, 0.4);
  drive(0.8, {0.4, 0.0}, 0.0, 0.4);
  EXPECT_EQ(watch_.fault(), "");
  drive(0.6, {0.4, 0.0}, 0.0, 0.4);
  EXPECT_EQ(watch_.fault(), "the left wheel is told to turn and its encoder does not count it");
}

TEST_F(WheelWatchTest, AddsUpTheTimesInWhichADeadEncoderShouldHaveCounted) {
  for (int i = 0; i < 20; ++i) {
    drive(0.3, {0.3, 0.0}, 0.3, 0.0);
    drive(0.3, {0.0, 0.0}, 0.0, 0.0);
  }
  EXPECT_EQ(watch_.fault(), "the right wheel is told to turn and its encoder does not count it");
}

TEST_F(WheelWatchTest, NamesADeadEncoderLaterWhileTheOtherWheelIsToldToStand) {
  const DriveVelocity about_the_left{0.1, 0.1 / 0.165};
  drive(3.0, about_the_left, 0.0, 0.2);
  drive(1.7, about_the_left, 0.0, 0.0);
  EXPECT_EQ(watch_.fault(), "") << "it may be held";
  drive(0.3, about_the_left, 0.0, 0.0);
  EXPECT_EQ(watch_.fault(), "the right wheel is told to turn and its encoder does not count it");
}

TEST_F(WheelWatchTest, LetsARobotGoOnThatWasCarried) {
  drive(5.0, {0.4, 0.0}, 0.4, 0.4);
  drive(10.0, {0.4, 0.0}, 0.0, 0.0);
  drive(0.2, {0.4, 0.0}, 0.1, 0.0);  // one wheel is on the floor before the other
  drive(5.0, {0.4, 0.0}, 0.4, 0.4);
  EXPECT_EQ(watch_.fault(), "");
}

TEST_F(WheelWatchTest, LetsARobotGoOnThatLookedAboutWhileItWasCarried) {
  drive(2.0, {0.4, 0.0}, 0.4, 0.4);
  for (int i = 0; i < 6; ++i) {
    drive(0.5, {0.3, 0.0}, 0.0, 0.0);
    drive(0.9, {0.1, 0.1 / 0.165}, 0.0, 0.0);  // about the left wheel
  }
  drive(5.0, {0.08, 0.75}, 0.0, 0.0);  // the left wheel slowly back
  EXPECT_EQ(watch_.fault(), "");
  drive(2.0, {0.4, 0.0}, 0.4, 0.4);
  drive(2.0, {0.1, 0.1 / 0.165}, 0.0, 0.0);
  EXPECT_NE(watch_.fault(), "") << "put down again it counts as before";
}

TEST_F(WheelWatchTest, NamesAWheelThatCountsBackwards) {
  drive(1.6, {0.3, 0.0}, 0.3, -0.3);
  EXPECT_EQ(watch_.fault(), "the right wheel is told to turn and its encoder does not count it");
}

TEST_F(WheelWatchTest, NamesAWheelThatTurnsAlthoughItIsToldToStand) {
  drive(1.6, {0.0, 0.0}, 0.2, 0.0);
  EXPECT_EQ(watch_.fault(), "the left wheel turns although it is told to stand");
}

TEST_F(WheelWatchTest, LeavesBlockedWheelsAndMotorsThatAreOffToThoseWhoSaySo) {
  packet_.stall_left = true;
  drive(5.0, {0.4, 0.0}, 0.0, 0.4);
  packet_ = InformationPacket();  // somebody pushes it
  drive(5.0, {0.0, 0.0}, 0.5, 0.5);
  EXPECT_EQ(watch_.fault(), "");
}

TEST_F(WheelWatchTest, StandsByWhatItFoundUntilItIsToldToLookAgain) {
  drive(2.0, {0.4, 0.0}, 0.0, 0.4);
  drive(2.0, {0.4, 0.0}, 0.4, 0.4);
  EXPECT_NE(watch_.fault(), "");
  watch_.restart();
  drive(2.0, {0.4, 0.0}, 0.4, 0.4);
  EXPECT_EQ(watch_.fault(), "");
}

}  // namespace
}  // namespace luminav
