#include "services/planner/goals/goal_sentences.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

TEST(GoalSentences, NameAPlaceWithItsCoordinatesOrTheseAlone) {
  GoalStop stop;
  stop.pose = {4.2, 3.1, 0.0};
  EXPECT_EQ(place_of(stop), "(4.2, 3.1)");
  stop.place = "kitchen";
  EXPECT_EQ(place_of(stop), "kitchen (4.2, 3.1)");
}

TEST(GoalSentences, SayHowFarTheNearestReachablePointIs) {
  GoalStop stop;
  stop.pose = {4.0, 3.0, 0.0};
  Route route;
  route.outcome = RouteOutcome::kGoalBlocked;
  route.nearest_reachable = Eigen::Vector2d(4.0, 4.5);
  EXPECT_EQ(no_path_sentence(route, {}, stop, 0.2),
            "goal (4.0, 3.0) lies in or beside an obstacle: nearest reachable point (4.0, 4.5) is 1.50 m away, "
            "tolerance 0.20 m");
}

TEST(GoalSentences, SayWhatTheControllerSays) {
  Situation situation;
  EXPECT_EQ(what_controller_says(situation), "the controller is silent");
  situation.control = ControlReport{};
  EXPECT_EQ(what_controller_says(situation), "the controller does not say why");
  situation.control->reason = "a box";
  EXPECT_EQ(what_controller_says(situation), "a box");
}

}  // namespace
}  // namespace luminav
