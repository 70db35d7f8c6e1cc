#include "services/viewer/request_text.hpp"

#include <gtest/gtest.h>

#include <string>

namespace luminav {
namespace {

Building building_with_a_lift() {
  Building building;
  building.places.push_back({"lift", {1.5, 2.5, 0.5}, true});
  return building;
}

TEST(GoalRequestText, ReadsPointsHeadingsAndPlaces) {
  const goal_t goal = read_goal_request(
      R"({"action":"go","loop":true,"poses":[{"x":1,"y":-2.5},{"x":0,"y":0,"theta":7,"wait":3},{"place":"lift"}]})",
      building_with_a_lift());
  EXPECT_EQ(goal.action, goal_t::ACTION_GO);
  EXPECT_TRUE(goal.loop);
  ASSERT_EQ(goal.count, 3);
  EXPECT_DOUBLE_EQ(goal.poses[0].y, -2.5);
  EXPECT_FALSE(goal.poses[0].has_theta);
  EXPECT_TRUE(goal.poses[1].has_theta);
  EXPECT_NEAR(goal.poses[1].theta, 7.0 - 2.0 * 3.14159265, 1e-6);
  EXPECT_DOUBLE_EQ(goal.poses[1].wait, 3.0);
  EXPECT_EQ(goal.poses[2].place, "lift");
  EXPECT_DOUBLE_EQ(goal.poses[2].theta, 0.5);
}

TEST(JobRequestText, ReadsJobsAndWhatPeopleSayToThem) {
  const Building building = building_with_a_lift();
  const job_t carry = read_job_request(
      R"({"action":"add","kind":"carry","stops":[{"place":"lift"},{"x":1,"y":2,"pause":3,"text":"here"}],"priority":7,)"
      R"("on_timeout":"go_on"})",
      building);
  EXPECT_EQ(carry.action, job_t::ACTION_ADD);
  EXPECT_EQ(carry.kind, job_t::KIND_CARRY);
  EXPECT_EQ(carry.priority, 7);
  EXPECT_EQ(carry.on_timeout, job_t::TIMEOUT_GO_ON);
  ASSERT_EQ(carry.count, 2);
  EXPECT_EQ(carry.stops[0].place, "lift");
  EXPECT_DOUBLE_EQ(carry.stops[1].pause, 3.0);
  EXPECT_EQ(carry.stops[1].text, "here");
  EXPECT_EQ(read_job_request(R"({"action":"add","kind":"tour","tour":"morning"})", building).tour, "morning");
  EXPECT_EQ(read_job_request(R"({"action":"add","kind":"home"})", building).count, 0);
  const job_t confirm = read_job_request(R"({"action":"confirm","job":1764184500123456,"word":"loaded"})", building);
  EXPECT_EQ(confirm.action, job_t::ACTION_CONFIRM);
  EXPECT_EQ(confirm.job, 1'764'184'500'123'456);
  EXPECT_EQ(confirm.word, "loaded");
}

TEST(JobRequestText, RefusesEverythingElse) {
  const Building building = building_with_a_lift();
  for (const char* body : {"",
                           "[]",
                           "{}",
                           R"({"action":"do"})",
                           R"({"action":"add"})",
                           R"({"action":"add","kind":"fly"})",
                           R"({"action":"add","kind":"go","stops":7})",
                           R"({"action":"add","kind":"go","stops":[7]})",
                           R"({"action":"add","kind":"go","stops":[{"place":"attic"}]})",
                           R"({"action":"add","kind":"go","stops":[{"x":1}]})",
                           R"({"action":"add","kind":"go","stops":[{"x":1,"y":1e9}]})",
                           R"({"action":"add","kind":"go","stops":[{"place":"lift","wait":3}]})",
                           R"({"action":"add","kind":"home","priority":101})",
                           R"({"action":"add","kind":"home","priority":1.5})",
                           R"({"action":"add","kind":"home","on_timeout":"never"})",
                           R"({"action":"add","kind":"home","colour":"red"})",
                           R"({"action":"confirm"})",
                           R"({"action":"confirm","job":0})",
                           R"({"action":"confirm","job":"1"})",
                           R"({"action":"answer","job":5,"word":7})"}) {
    EXPECT_THROW((void)read_job_request(body, building), RequestError) << body;
  }
}

TEST(GoalRequestText, KnowsTheOtherActions) {
  const Building building;
  EXPECT_EQ(read_goal_request(R"({"action":"cancel"})", building).action, goal_t::ACTION_CANCEL);
  EXPECT_EQ(read_goal_request(R"({"action":"pause"})", building).action, goal_t::ACTION_PAUSE);
  EXPECT_EQ(read_goal_request(R"({"action":"resume"})", building).action, goal_t::ACTION_RESUME);
}

TEST(GoalRequestText, RefusesEverythingElse) {
  const Building building = building_with_a_lift();
  for (const char* body : {"",
                           "null",
                           "[]",
                           "{",
                           "{}",
                           R"({"action":"fly"})",
                           R"({"action":7})",
                           R"({"action":"go"})",
                           R"({"action":"go","poses":[]})",
                           R"({"action":"go","poses":{}})",
                           R"({"action":"go","poses":[1]})",
                           R"({"action":"go","poses":[{"x":1}]})",
                           R"({"action":"go","poses":[{"x":"1","y":2}]})",
                           R"({"action":"go","poses":[{"x":1e300,"y":2}]})",
                           R"({"action":"go","poses":[{"x":1e999,"y":2}]})",
                           R"({"action":"go","poses":[{"x":NaN,"y":2}]})",
                           R"({"action":"go","poses":[{"x":1,"y":2,"z":3}]})",
                           R"({"action":"go","poses":[{"place":"nowhere"}]})",
                           R"({"action":"go","poses":[{"x":1,"y":2,"wait":-1}]})",
                           R"({"action":"go","poses":[{"x":1,"y":2}],"loop":1})",
                           R"({"action":"go","poses":[{"x":1,"y":2}],"policy":"perhaps"})",
                           R"({"action":"go","poses":[{"x":1,"y":2}],"more":1})",
                           "{\"action\":\"go\",\"poses\":[{\"place\":\"\xff\"}]}"}) {
    EXPECT_THROW(read_goal_request(body, building), RequestError) << body;
  }
  std::string many = R"({"action":"go","poses":[)";
  for (int i = 0; i < 101; ++i) {
    many += i == 0 ? R"({"x":1,"y":2})" : R"(,{"x":1,"y":2})";
  }
  EXPECT_THROW(read_goal_request(many + "]}", building), RequestError);
  EXPECT_THROW(read_goal_request(std::string(60'000, '['), building), RequestError);
}

TEST(GoalRequestText, EndsARouteAtAStopThatCannotBeReachedUnlessToldToLeaveItOut) {
  const auto policy = [](const std::string& more) {
    return read_goal_request(R"({"action":"go","poses":[{"x":1,"y":2}])" + more + "}", Building{}).policy;
  };
  EXPECT_EQ(policy(""), goal_t::POLICY_STOP);
  EXPECT_EQ(policy(R"(,"policy":"skip")"), goal_t::POLICY_SKIP);
  EXPECT_EQ(policy(R"(,"policy":"retry","loop":true)"), goal_t::POLICY_RETRY);
}

TEST(StopRequestText, StopsWheneverItIsNotClearlyARelease) {
  for (const char* body :
       {"", "nonsense", "{}", "[]", R"({"engaged":true})", R"({"engaged":0})", R"({"engaged":"false"})"}) {
    EXPECT_TRUE(read_stop_request(body).engaged) << body;
  }
  EXPECT_FALSE(read_stop_request(R"({"engaged":false})").engaged);
}

TEST(MotorsRequestText, IsTrueOrFalse) {
  EXPECT_TRUE(read_motors_request(R"({"enable":true})").enable);
  EXPECT_THROW(read_motors_request(R"({"enable":1})"), RequestError);
  EXPECT_THROW(read_motors_request("{}"), RequestError);
}

TEST(InitialPoseRequestText, TurnsDeviationsIntoACovariance) {
  const initial_pose_t guess = read_initial_pose_request(R"({"x":1,"y":2,"theta":0.5,"sigma":2,"sigma_theta":0.1})");
  EXPECT_DOUBLE_EQ(guess.covariance[0], 4.0);
  EXPECT_DOUBLE_EQ(guess.covariance[4], 4.0);
  EXPECT_NEAR(guess.covariance[8], 0.01, 1e-12);
  EXPECT_DOUBLE_EQ(guess.covariance[1], 0.0);
  EXPECT_THROW(read_initial_pose_request(R"({"x":1,"y":2})"), RequestError);
  EXPECT_THROW(read_initial_pose_request(R"({"x":1,"y":2,"theta":0,"sigma":0})"), RequestError);
}

TEST(SurveyRequestText, FinishesOrNamesAPlace) {
  EXPECT_EQ(read_survey_request(R"({"action":"finish"})").action, survey_command_t::ACTION_FINISH);
  const survey_command_t place = read_survey_request(R"({"action":"place","name":"lift"})");
  EXPECT_EQ(place.action, survey_command_t::ACTION_PLACE);
  EXPECT_EQ(place.name, "lift");
  for (const char* body : {"", "{}", R"({"action":"place"})", R"({"action":"begin"})",
                           R"({"action":"finish","folder":"/"})", R"({"action":"place","name":7})"}) {
    EXPECT_THROW(read_survey_request(body), RequestError) << body;
  }
}

TEST(MapRequestText, NamesNoFile) {
  EXPECT_EQ(read_map_request(R"({"action":"save"})").action, map_command_t::ACTION_SAVE);
  EXPECT_EQ(read_map_request(R"({"action":"clear_evidence"})").action, map_command_t::ACTION_CLEAR_EVIDENCE);
  EXPECT_EQ(read_map_request(R"({"action":"save"})").path, "");
  for (const char* body : {R"({"action":"save","path":"/etc/passwd"})", R"({"action":"load"})", "{}", "[]"}) {
    EXPECT_THROW(read_map_request(body), RequestError) << body;
  }
}

TEST(SteeringText, IsReadStrictly) {
  const Steering steering =
      read_steering(R"({"session":7,"sequence":3,"linear":-0.25,"angular":1,"seen":1700000000000000})");
  EXPECT_EQ(steering.session, 7);
  EXPECT_EQ(steering.sequence, 3);
  EXPECT_DOUBLE_EQ(steering.linear, -0.25);
  EXPECT_DOUBLE_EQ(steering.angular, 1.0);
  EXPECT_EQ(steering.seen, 1'700'000'000'000'000);
  for (const char* body : {R"({"session":7,"sequence":3,"linear":0,"angular":0})",
                           R"({"session":7.5,"sequence":3,"linear":0,"angular":0,"seen":1})",
                           R"({"session":7,"sequence":-1,"linear":0,"angular":0,"seen":1})",
                           R"({"session":7,"sequence":99999999999,"linear":0,"angular":0,"seen":1})",
                           R"({"session":18446744073709551615,"sequence":1,"linear":0,"angular":0,"seen":1})",
                           R"({"session":7,"sequence":3,"linear":1e400,"angular":0,"seen":1})",
                           R"({"session":7,"sequence":3,"linear":"0","angular":0,"seen":1})"}) {
    EXPECT_THROW(read_steering(body), RequestError) << body;
  }
}

TEST(ProcessOrderText, KnowsThreeActions) {
  EXPECT_EQ(read_process_order(R"({"name":"mapper","action":"stop"})").action, ProcessOrder::Action::kStop);
  EXPECT_EQ(read_process_order(R"({"name":"mapper","action":"restart"})").name, "mapper");
  EXPECT_THROW(read_process_order(R"({"name":"mapper","action":"kill"})"), RequestError);
  EXPECT_THROW(read_process_order(R"({"action":"stop"})"), RequestError);
}

}  // namespace
}  // namespace luminav
