#include "services/operator/robot_order.hpp"

#include <gtest/gtest.h>

#include <luminav/motors_command_t.hpp>
#include <luminav/stop_t.hpp>
#include <vector>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kId = 7'000;

/// Driver and controller on the other side of the bus.
class RobotOrderTest : public ::testing::Test {
 protected:
  RobotOrderTest() {
    lcm_.subscribe(channels::kStop, &RobotOrderTest::on_stop, this);
    lcm_.subscribe(channels::kMotorsCommand, &RobotOrderTest::on_motors, this);
  }
  void driver_says(std::int64_t stop_id, bool engaged, double linear = 0.0, std::int64_t motors_id = 0) {
    robot_status_t status{};
    status.utime = 1;
    status.stop_id = stop_id;
    status.stop_engaged = engaged ? 1 : 0;
    status.linear = linear;
    status.motors_command_id = motors_id;
    lcm_.publish(channels::kRobotStatus, &status);
    drain();
  }
  void controller_says(std::int64_t stop_id, bool engaged) {
    control_status_t status{};
    status.utime = 1;
    status.stop_id = stop_id;
    status.stop_engaged = engaged ? 1 : 0;
    lcm_.publish(channels::kControlStatus, &status);
    drain();
  }
  void drain() {
    while (lcm_.handleTimeout(0) > 0) {
    }
  }
  template <typename Message>
  static Message decoded(const lcm::ReceiveBuffer* buffer) {
    Message message{};
    EXPECT_GT(message.decode(buffer->data, 0, static_cast<int>(buffer->data_size)), 0);
    return message;
  }
  void on_stop(const lcm::ReceiveBuffer* buffer, const std::string&) { stops_.push_back(decoded<stop_t>(buffer)); }
  void on_motors(const lcm::ReceiveBuffer* buffer, const std::string&) {
    motors_.push_back(decoded<motors_command_t>(buffer));
  }

  lcm::LCM lcm_{"memq://"};
  std::vector<stop_t> stops_;
  std::vector<motors_command_t> motors_;
};

TEST_F(RobotOrderTest, RepeatsAStopUntilDriverAndControllerObey) {
  RobotOrder order(lcm_, RobotWish::kStop, kId, "terminal");
  order.tick();
  driver_says(kId, true, 0.3);
  EXPECT_FALSE(order.is_obeyed()) << "the controller has not";
  EXPECT_NE(order.progress().find("controller"), std::string::npos);
  order.tick();
  drain();
  ASSERT_EQ(stops_.size(), 2U);
  EXPECT_EQ(stops_[1].id, kId);
  EXPECT_TRUE(stops_[1].engaged);
  controller_says(kId, true);
  EXPECT_TRUE(order.is_obeyed());
  EXPECT_FALSE(order.stands()) << "it still brakes";
  driver_says(kId, true, 0.0);
  EXPECT_TRUE(order.stands());
  order.tick();
  drain();
  EXPECT_EQ(stops_.size(), 2U);
}

TEST_F(RobotOrderTest, TakesNobodyElsesStopForItsRelease) {
  RobotOrder order(lcm_, RobotWish::kRelease, kId, "terminal");
  order.tick();
  driver_says(kId + 5, true);
  controller_says(kId + 5, true);
  EXPECT_FALSE(order.is_obeyed());
  driver_says(kId, false);
  controller_says(kId, false);
  EXPECT_TRUE(order.is_obeyed());
  drain();
  ASSERT_EQ(stops_.size(), 1U);
  EXPECT_FALSE(stops_[0].engaged);
}

TEST_F(RobotOrderTest, SwitchesTheMotors) {
  RobotOrder order(lcm_, RobotWish::kMotorsOff, kId, "terminal");
  order.tick();
  EXPECT_FALSE(order.is_obeyed());
  driver_says(0, false, 0.0, kId);
  EXPECT_TRUE(order.is_obeyed());
  ASSERT_EQ(motors_.size(), 1U);
  EXPECT_FALSE(motors_[0].enable);
}

}  // namespace
}  // namespace luminav
