#include "drivers/p3dx/safety/motors_supervisor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace luminav {
namespace {

using testing::HasSubstr;
constexpr std::int64_t kCycle = 100'000;  // [us]

/// A robot whose packets are shown to the supervisor every 0.1 s.
struct Robot {
  /// ENABLE values sent during `cycles`.
  std::vector<bool> show(MotorsSupervisor& supervisor, int cycles) {
    std::vector<bool> sent;
    for (int i = 0; i < cycles; ++i) {
      now += kCycle;
      if (const auto enable = supervisor.update(packet, now)) {
        sent.push_back(*enable);
        if (obeys) {
          packet.motors_enabled = *enable && !packet.stop_button;
        }
      }
    }
    return sent;
  }
  InformationPacket packet;
  bool obeys = true;
  std::int64_t now = 1'000'000;
};

TEST(MotorsSupervisor, SwitchesThemOnAfterConnecting) {
  MotorsSupervisor supervisor(true);
  Robot robot;
  supervisor.on_connected();
  EXPECT_THAT(robot.show(supervisor, 20), testing::ElementsAre(true));
  EXPECT_EQ(supervisor.reason(), "");
}

TEST(MotorsSupervisor, LeavesThemOffUntilRequested) {
  MotorsSupervisor supervisor(false);
  Robot robot;
  supervisor.on_connected();
  EXPECT_THAT(robot.show(supervisor, 50), testing::IsEmpty());
  EXPECT_THAT(supervisor.reason(), HasSubstr("until they are requested"));
  supervisor.request(true);
  EXPECT_THAT(robot.show(supervisor, 20), testing::ElementsAre(true));
  EXPECT_EQ(supervisor.reason(), "");
}

TEST(MotorsSupervisor, AsksAgainOnceASecondWhenEnableIsLost) {
  MotorsSupervisor supervisor(true);
  Robot robot;
  robot.obeys = false;
  supervisor.on_connected();
  EXPECT_EQ(robot.show(supervisor, 50).size(), 5U);
  EXPECT_THAT(supervisor.reason(), HasSubstr("does not switch its motors on"));
}

TEST(MotorsSupervisor, DoesNotFightWhoeverSwitchesThemOffAtTheRobot) {
  MotorsSupervisor supervisor(true);
  Robot robot;
  supervisor.on_connected();
  robot.show(supervisor, 20);
  robot.packet.motors_enabled = false;
  EXPECT_THAT(robot.show(supervisor, 50), testing::IsEmpty());
  EXPECT_THAT(supervisor.reason(), HasSubstr("switched off at the robot"));
  supervisor.request(true);
  EXPECT_THAT(robot.show(supervisor, 20), testing::ElementsAre(true));
}

TEST(MotorsSupervisor, IsNotFooledByOneDamagedPacket) {
  MotorsSupervisor supervisor(true);
  Robot robot;
  supervisor.on_connected();
  robot.show(supervisor, 20);
  robot.packet.motors_enabled = false;
  robot.show(supervisor, 1);
  robot.packet.motors_enabled = true;
  robot.show(supervisor, 20);
  EXPECT_EQ(supervisor.reason(), "");
  EXPECT_TRUE(supervisor.wish());
}

TEST(MotorsSupervisor, WantsANewRequestAfterTheStopButton) {
  MotorsSupervisor supervisor(true);
  Robot robot;
  supervisor.on_connected();
  robot.show(supervisor, 20);
  robot.packet.stop_button = true;
  robot.packet.motors_enabled = false;
  EXPECT_THAT(robot.show(supervisor, 30), testing::IsEmpty());
  EXPECT_THAT(supervisor.reason(), HasSubstr("is pressed"));
  robot.packet.stop_button = false;
  EXPECT_THAT(robot.show(supervisor, 30), testing::IsEmpty());
  EXPECT_THAT(supervisor.reason(), HasSubstr("was pressed"));
  supervisor.request(true);
  EXPECT_THAT(robot.show(supervisor, 20), testing::ElementsAre(true));
}

TEST(MotorsSupervisor, SwitchesThemOffAtARobotThatStartsWithThemOn) {
  MotorsSupervisor supervisor(false);
  Robot robot;
  robot.packet.motors_enabled = true;
  supervisor.on_connected();
  EXPECT_THAT(robot.show(supervisor, 20), testing::ElementsAre(false));
}

TEST(MotorsSupervisor, TakesTheButtonOnTheRobotForARequest) {
  MotorsSupervisor supervisor(false);
  Robot robot;
  supervisor.on_connected();
  robot.show(supervisor, 20);
  robot.packet.motors_enabled = true;
  EXPECT_THAT(robot.show(supervisor, 20), testing::IsEmpty());
  EXPECT_TRUE(supervisor.wish());
}

TEST(MotorsSupervisor, SwitchesThemOnAgainAfterAReconnection) {
  MotorsSupervisor supervisor(true);
  Robot robot;
  supervisor.on_connected();
  robot.show(supervisor, 20);
  robot.packet.motors_enabled = false;  // a new session begins without
  supervisor.on_connected();
  EXPECT_THAT(robot.show(supervisor, 20), testing::ElementsAre(true));
}

}  // namespace
}  // namespace luminav
