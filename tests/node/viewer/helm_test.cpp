#include "services/viewer/helm.hpp"

#include <gtest/gtest.h>

#include <luminav/teleop_command_t.hpp>

#include "services/common/process/channels.hpp"
#include "services/common/process/subscriber.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kNow = 1'700'000'000'000'000;  // [us]

class HelmTest : public ::testing::Test {
 protected:
  HelmTest() : subscriber_(lcm_) {
    subscriber_.on(channels::kTeleopCommand, &HelmTest::on_teleop_command, this);
    robot_status_t status{};
    status.utime = kNow - 5'000;
    helm_.on_robot_status(status);
  }
  void on_teleop_command(const teleop_command_t& message) { commands_.push_back(message); }
  std::size_t sent() {
    while (lcm_.handleTimeout(0) > 0) {
    }
    return commands_.size();
  }
  static Steering steering(std::int64_t session, std::int32_t sequence, double linear, std::int64_t seen = kNow) {
    return {.session = session, .sequence = sequence, .linear = linear, .angular = 0.0, .seen = seen};
  }

  lcm::LCM lcm_{"memq://"};
  Helm helm_{lcm_, {}};
  Subscriber subscriber_;
  std::vector<teleop_command_t> commands_;
};

TEST_F(HelmTest, AnswersTheNewestWordOfTheRobot) {
  helm_.steer(steering(7, 1, 0.3), kNow + 20'000);
  ASSERT_EQ(sent(), 1U);
  EXPECT_EQ(commands_[0].utime, kNow - 5'000);
  EXPECT_EQ(commands_[0].session, 7);
  EXPECT_EQ(commands_[0].sequence, 1);
  EXPECT_DOUBLE_EQ(commands_[0].linear, 0.3);
}

TEST_F(HelmTest, RefusesWhatWasHeldUpOnTheWay) {
  EXPECT_THROW(helm_.steer(steering(7, 1, 0.3, kNow - 301'000), kNow), RequestError);
  EXPECT_THROW(helm_.steer(steering(7, 1, 0.3, kNow + 301'000), kNow), RequestError);
  helm_.steer(steering(7, 2, 0.3), kNow);
  helm_.steer(steering(7, 4, 0.0), kNow + 1);
  EXPECT_THROW(helm_.steer(steering(7, 3, 0.3), kNow + 2), RequestError);  // overtaken by the release
  EXPECT_THROW(helm_.steer(steering(7, 4, 0.3), kNow + 2), RequestError);
  EXPECT_EQ(sent(), 2U);
}

TEST_F(HelmTest, RefusesMoreThanTheRobotDoes) {
  EXPECT_THROW(helm_.steer(steering(7, 1, 0.51), kNow), RequestError);
  EXPECT_THROW(helm_.steer(steering(7, 1, -0.51), kNow), RequestError);
  EXPECT_EQ(sent(), 0U);
}

TEST_F(HelmTest, LetsOnePersonSteerAtATime) {
  helm_.steer(steering(7, 1, 0.3), kNow);
  EXPECT_THROW(helm_.steer(steering(8, 1, -0.3), kNow + 100'000), RequestError);
  helm_.steer(steering(8, 2, -0.3, kNow + 500'000), kNow + 500'000);  // the first one has let go
  EXPECT_THROW(helm_.steer(steering(7, 2, 0.3, kNow + 510'000), kNow + 510'000), RequestError);
  EXPECT_EQ(sent(), 2U);
}

TEST(Helm, NeedsARobot) {
  lcm::LCM lcm("memq://");
  Helm helm(lcm, {});
  EXPECT_THROW(helm.steer({.session = 7, .sequence = 1, .linear = 0.1, .seen = kNow}, kNow), RequestError);
}

}  // namespace
}  // namespace luminav
