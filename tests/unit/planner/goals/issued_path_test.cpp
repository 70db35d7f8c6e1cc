#include "services/planner/goals/issued_path.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

class IssuedPathTest : public testing::Test {
 protected:
  IssuedPathTest() : stops(GoalParams{}) {
    GoalRequest goal;
    goal.id = 3;
    goal.stops.resize(1);
    goal.stops.front().pose = {2.0, 0.0, 0.5};
    stops.begin(goal, 0);
  }

  StopList stops;
  IssuedPath path;
  const std::int64_t now = 50'000'000;  // [us]
};

TEST_F(IssuedPathTest, CountsUpFromTheClockAndKeepsStandingStillUnderOneNumber) {
  path.stand_still(stops, now);
  EXPECT_EQ(path.path().sequence, 51);
  path.stand_still(stops, now + 10'000'000);
  EXPECT_EQ(path.path().sequence, 51);
  path.issue(path_to_stop({{0.0, 0.0}, {2.0, 0.0}}, stops.stop()), stops, now);
  EXPECT_EQ(path.path().sequence, 52);
  EXPECT_EQ(path.path().goal_id, 3);
}

TEST_F(IssuedPathTest, TakesWhatAnOrderLeavesOpenFromTheGoal) {
  path.issue(path_to_stop({{0.0, 0.0}, {2.0, 0.0}}, stops.stop()), stops, now);
  EXPECT_FALSE(path.path().has_theta);
  EXPECT_EQ(path.path().tolerance, stops.tolerance());
  path.issue(path_to_wait({{0.0, 0.0}}, 1.5), stops, now);
  EXPECT_TRUE(path.path().has_theta);
  EXPECT_EQ(path.path().theta, 1.5);
  EXPECT_EQ(path.path().tolerance, 0.3);
  EXPECT_EQ(path.path().heading_tolerance, stops.heading_tolerance());
}

TEST_F(IssuedPathTest, SaysWhatIsLeftAndWhatLiesAhead) {
  path.issue(path_to_stop({{0.0, 0.0}, {0.5, 0.0}, {1.0, 0.0}, {1.5, 0.0}, {2.0, 0.0}}, stops.stop()), stops, now);
  const Eigen::Vector2d robot(0.6, 0.1);
  path.advance(robot);
  EXPECT_NEAR(path.distance_to(robot), 0.1 * std::sqrt(2.0), 1e-9);
  EXPECT_EQ(path.remaining(robot), (Polyline{robot, {1.0, 0.0}, {1.5, 0.0}, {2.0, 0.0}}));
  EXPECT_EQ(path.point_ahead(robot, 0.6), (Eigen::Vector2d{1.5, 0.0}));
  EXPECT_FALSE(path.point_ahead(robot, 5.0));
}

TEST_F(IssuedPathTest, IsFinishedOnlyWhenTheControllerSaysSoOfThisPath) {
  path.issue(path_to_stop({{0.0, 0.0}, {2.0, 0.0}}, stops.stop()), stops, now);
  Situation situation;
  EXPECT_FALSE(path.is_finished(situation));
  situation.control = ControlReport{};
  situation.control->at_goal = true;
  situation.control->path_sequence = path.path().sequence - 1;
  EXPECT_FALSE(path.is_finished(situation));
  situation.control->path_sequence = path.path().sequence;
  EXPECT_TRUE(path.is_finished(situation));
}

}  // namespace
}  // namespace luminav
