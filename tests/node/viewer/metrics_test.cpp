#include "services/viewer/http/metrics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class MetricsTest : public ::testing::Test {
 protected:
  template <typename Message>
  void send(const char* channel, Message message) {
    message.utime = std::max<std::int64_t>(message.utime, 1);
    lcm_.publish(channel, &message);
    while (lcm_.handleTimeout(0) > 0) {
    }
  }
  void odometry(std::int64_t session, double x) {
    odometry_t message{};
    message.session = session;
    message.x = x;
    send(channels::kOdometry, message);
  }
  void navigation(std::int64_t goal, std::int8_t state) {
    navigation_status_t message{};
    message.goal_id = goal;
    message.state = state;
    send(channels::kNavigationStatus, message);
  }
  void node(std::int64_t instance, const std::string& process = "detector") {
    node_status_t message{};
    message.process = process;
    message.host = "robot";
    message.instance = instance;
    message.worst_step_us = 2500;
    send(channels::kNodeStatus, message);
  }
  lcm::LCM lcm_{"memq://"};
  Metrics metrics_{lcm_};
};

TEST_F(MetricsTest, SaysNothingOfWhatWasNotHeard) {
  EXPECT_THAT(metrics_.text(1), Not(HasSubstr("luminav_battery_volts")));
}

TEST_F(MetricsTest, AddsUpTheDistanceButNoJumpAndNoNewSession) {
  for (const double x : {0.0, 0.25, 0.5}) {
    odometry(1, x);
  }
  odometry(1, 10.0);
  odometry(2, 10.25);
  EXPECT_THAT(metrics_.text(1), HasSubstr("\nluminav_distance_meters_total 0.5\n"));
}

TEST_F(MetricsTest, CountsEachGoalOnceWhenItEnds) {
  navigation(1, navigation_status_t::STATE_ARRIVED);  // of before
  for (const std::int64_t goal : {2, 3}) {
    navigation(goal, navigation_status_t::STATE_FOLLOWING);
    navigation(goal, navigation_status_t::STATE_ARRIVED);
    navigation(goal, navigation_status_t::STATE_ARRIVED);
  }
  navigation(4, navigation_status_t::STATE_NO_PATH);
  EXPECT_THAT(metrics_.text(1), HasSubstr("luminav_goals_total{outcome=\"arrived\"} 2\n"));
  EXPECT_THAT(metrics_.text(1), HasSubstr("luminav_goals_total{outcome=\"no_path\"} 1\n"));
}

TEST_F(MetricsTest, CountsABumperThatStaysPressedOnce) {
  robot_status_t status{};
  for (const int bumpers : {0, 4, 4, 0, 1}) {
    status.bumpers_front = bumpers;
    send(channels::kRobotStatus, status);
  }
  EXPECT_THAT(metrics_.text(1), HasSubstr("luminav_contacts_total{kind=\"bumper\"} 2\n"));
}

TEST_F(MetricsTest, CountsRestartsAndForgetsASilentProcess) {
  node(7);
  node(7);
  node(8);
  const std::string labels = R"({process="detector",host="robot"})";
  EXPECT_THAT(metrics_.text(1), HasSubstr("luminav_process_restarts_total" + labels + " 1\n"));
  EXPECT_THAT(metrics_.text(1), HasSubstr("luminav_process_worst_step_seconds" + labels + " 0.0025\n"));
  EXPECT_THAT(metrics_.text(60'000'002), Not(HasSubstr("detector")));
}

TEST_F(MetricsTest, ANameCannotBreakALine) {
  node(7, "a\"b\\c\nd");
  EXPECT_THAT(metrics_.text(1), HasSubstr(R"({process="a\"b\\c d",host="robot"})"));
}

}  // namespace
}  // namespace luminav
