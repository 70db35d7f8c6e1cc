#include "services/jobs/job_inputs.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

pose_t tracked(std::int64_t utime) {
  pose_t pose{};
  pose.utime = utime;
  pose.state = pose_t::STATE_TRACKING;
  pose.x = 4.0;
  return pose;
}

/// One disc that looks to the left heard something, another nothing.
sonar_t sonar(std::int64_t utime) {
  sonar_t message{};
  message.utime = utime;
  message.range = {1.5F, 5.0F};
  message.fresh = {1, 1};
  message.has_echo = {1, 0};
  return message;
}

robot_status_t robot(std::int64_t utime) {
  robot_status_t status{};
  status.utime = utime;
  status.linear = 0.5;
  return status;
}

class JobInputsTest : public testing::Test {
 protected:
  JobInputs inputs_{{.robot_from_sonar = {{0.0, 0.1, 0.5 * kPi}, {0.1, 0.0, 0.0}}}};
};

TEST_F(JobInputsTest, KnowsWhereTheRobotIsForASecond) {
  EXPECT_FALSE(inputs_.pose_at(5'000'000));
  inputs_.take(tracked(5'000'000));
  ASSERT_TRUE(inputs_.pose_at(5'999'999));
  EXPECT_EQ(inputs_.pose_at(5'999'999)->x, 4.0);
  EXPECT_FALSE(inputs_.pose_at(6'000'000));
  pose_t lost = tracked(5'100'000);
  lost.state = pose_t::STATE_LOST;
  inputs_.take(lost);
  EXPECT_FALSE(inputs_.pose_at(5'100'000));
}

TEST_F(JobInputsTest, GivesEchoesInTheWorldAndOnce) {
  inputs_.take(sonar(5'000'000));
  EXPECT_TRUE(inputs_.moment(robot(5'000'000), 0.2).echoes.empty()) << "nobody knows where";
  inputs_.take(tracked(5'000'000));
  inputs_.take(sonar(5'100'000));
  const JobMoment moment = inputs_.moment(robot(5'200'000), 0.2);
  ASSERT_EQ(moment.echoes.size(), 1U);
  EXPECT_DOUBLE_EQ(moment.echoes[0].world_from_sonar.x, 4.0);
  EXPECT_DOUBLE_EQ(moment.echoes[0].world_from_sonar.y, 0.1);
  EXPECT_DOUBLE_EQ(moment.echoes[0].range, 1.5);
  EXPECT_DOUBLE_EQ(moment.driven, 0.1);
  EXPECT_TRUE(inputs_.moment(robot(5'400'000), 0.2).echoes.empty());
}

TEST_F(JobInputsTest, TellsOnceWhatThePlannerSaid) {
  navigation_status_t status{};
  status.goal_id = 7;
  inputs_.take(status);
  const JobMoment moment = inputs_.moment(robot(5'000'000), 0.2);
  ASSERT_TRUE(moment.navigation);
  EXPECT_EQ(moment.navigation->goal_id, 7);
  EXPECT_FALSE(inputs_.moment(robot(5'200'000), 0.2).navigation);
}

}  // namespace
}  // namespace luminav
