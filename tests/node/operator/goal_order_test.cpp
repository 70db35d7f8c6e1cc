#include "services/operator/goal_order.hpp"

#include <gtest/gtest.h>

#include <luminav/goal_t.hpp>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

/// The planner's side of the bus.
class GoalOrderTest : public ::testing::Test {
 protected:
  GoalOrderTest() { lcm_.subscribe(channels::kGoal, &GoalOrderTest::on_goal, this); }

  static goal_t goal(std::int64_t id) {
    goal_t message{};
    message.utime = message.id = id;
    message.action = goal_t::ACTION_GO;
    message.count = 1;
    message.poses.resize(1);
    return message;
  }
  void say(std::int64_t goal_id, int state, const std::string& cause = "", double target_x = 2.0) {
    navigation_status_t status{};
    status.utime = 1;
    status.has_target = state < navigation_status_t::STATE_ARRIVED || state == navigation_status_t::STATE_PAUSED;
    status.x = status.has_target ? target_x : 0.0;
    status.goal_id = goal_id;
    status.state = static_cast<std::int8_t>(state);
    status.cause = cause;
    status.distance_left = 3.25;
    lcm_.publish(channels::kNavigationStatus, &status);
    drain();
  }
  void drain() {
    while (lcm_.handleTimeout(0) > 0) {
    }
  }
  void on_goal(const lcm::ReceiveBuffer* buffer, const std::string&) {
    goal_t message{};
    ASSERT_GT(message.decode(buffer->data, 0, static_cast<int>(buffer->data_size)), 0);
    received_.push_back(message);
  }

  lcm::LCM lcm_{"memq://"};
  std::vector<goal_t> received_;
};

TEST_F(GoalOrderTest, RepeatsTheGoalUntilItIsEchoed) {
  GoalOrder request(lcm_, goal(7));
  for (int i = 0; i < 3; ++i) {
    request.tick();
  }
  drain();
  EXPECT_EQ(received_.size(), 3U);
  say(7, navigation_status_t::STATE_PLANNING);
  request.tick();
  drain();
  EXPECT_EQ(received_.size(), 3U);
  EXPECT_FALSE(request.outcome());
}

TEST_F(GoalOrderTest, CountsOnFromAnEarlierGoalWhoseSendersClockWasAhead) {
  GoalOrder request(lcm_, goal(7));
  request.tick();
  say(1000, navigation_status_t::STATE_ARRIVED);  // which the planner has done: it takes no older one
  request.tick();
  drain();
  ASSERT_EQ(received_.size(), 2U);
  EXPECT_GT(received_.back().id, 1000);
  EXPECT_FALSE(request.outcome());
  say(received_.back().id, navigation_status_t::STATE_ARRIVED);
  EXPECT_EQ(request.outcome(), Outcome::kArrived);
}

TEST_F(GoalOrderTest, TellsEveryEndWithItsCause) {
  const std::pair<int, Outcome> ends[] = {{navigation_status_t::STATE_ARRIVED, Outcome::kArrived},
                                          {navigation_status_t::STATE_NO_PATH, Outcome::kNoPath},
                                          {navigation_status_t::STATE_BLOCKED, Outcome::kBlocked},
                                          {navigation_status_t::STATE_STUCK, Outcome::kStuck},
                                          {navigation_status_t::STATE_CANCELLED, Outcome::kCancelled},
                                          {navigation_status_t::STATE_LOST, Outcome::kLost}};
  for (const auto& [state, outcome] : ends) {
    GoalOrder request(lcm_, goal(9));
    request.tick();
    say(9, navigation_status_t::STATE_FOLLOWING);
    EXPECT_FALSE(request.outcome());
    say(9, state, "door is shut");
    ASSERT_TRUE(request.outcome());
    EXPECT_EQ(*request.outcome(), outcome);
    EXPECT_EQ(request.cause(), "door is shut");
  }
}

TEST_F(GoalOrderTest, IsNotFooledByTheEndOfAnEarlierGoal) {
  GoalOrder request(lcm_, goal(9));
  request.tick();
  say(8, navigation_status_t::STATE_ARRIVED);
  EXPECT_FALSE(request.outcome());
}

TEST_F(GoalOrderTest, NoticesThatAnotherGoalTookItsPlace) {
  GoalOrder request(lcm_, goal(9));
  request.tick();
  say(9, navigation_status_t::STATE_FOLLOWING);
  say(10, navigation_status_t::STATE_PLANNING, "", 5.0);
  EXPECT_EQ(request.outcome(), Outcome::kReplaced);
}

TEST_F(GoalOrderTest, TellsThatSomebodyElseCancelledIt) {
  GoalOrder request(lcm_, goal(9));
  request.tick();
  say(9, navigation_status_t::STATE_FOLLOWING);
  say(10, navigation_status_t::STATE_CANCELLED, "cancelled on the way to (2.00, 0.00)");
  EXPECT_EQ(request.outcome(), Outcome::kCancelled);
  EXPECT_EQ(request.cause(), "cancelled on the way to (2.00, 0.00)");
}

TEST_F(GoalOrderTest, OutlastsAPauseBySomebodyElse) {
  GoalOrder request(lcm_, goal(9));
  request.tick();
  say(9, navigation_status_t::STATE_FOLLOWING);
  say(10, navigation_status_t::STATE_PAUSED, "paused on the way to (2.00, 0.00)");
  EXPECT_EQ(request.progress(), "paused | 3.2 m left | paused on the way to (2.00, 0.00)");
  request.tick();
  say(11, navigation_status_t::STATE_LOCALIZING);
  say(11, navigation_status_t::STATE_FOLLOWING);
  EXPECT_FALSE(request.outcome());
  drain();
  EXPECT_EQ(received_.size(), 1U) << "it is taken up already";
  say(11, navigation_status_t::STATE_ARRIVED);
  EXPECT_EQ(request.outcome(), Outcome::kArrived);
}

TEST_F(GoalOrderTest, GivesUpAfterFiveSecondsOfSilence) {
  GoalOrder unheard(lcm_, goal(9));
  for (int i = 0; i < 25; ++i) {
    unheard.tick();
    EXPECT_FALSE(unheard.outcome());
  }
  unheard.tick();
  EXPECT_EQ(unheard.outcome(), Outcome::kNobodyAnswers);

  GoalOrder heard(lcm_, goal(9));
  say(9, navigation_status_t::STATE_FOLLOWING);
  for (int i = 0; i < 26; ++i) {
    heard.tick();
  }
  EXPECT_EQ(heard.outcome(), Outcome::kPlannerSilent);
}

TEST_F(GoalOrderTest, CancelsUnderANewIdAndWaitsForItsEcho) {
  GoalOrder request(lcm_, goal(9));
  request.tick();
  say(9, navigation_status_t::STATE_FOLLOWING);
  request.cancel(11);
  drain();
  EXPECT_EQ(received_.back().id, 11);
  EXPECT_EQ(received_.back().action, goal_t::ACTION_CANCEL);
  say(9, navigation_status_t::STATE_FOLLOWING);
  EXPECT_FALSE(request.outcome());
  say(11, navigation_status_t::STATE_CANCELLED);
  EXPECT_EQ(request.outcome(), Outcome::kCancelled);
}

TEST_F(GoalOrderTest, ShowsStatePoseDistanceAndSentence) {
  GoalOrder request(lcm_, goal(9));
  request.tick();
  EXPECT_EQ(request.progress(), "asking the planner");
  pose_t pose{};
  pose.utime = 1;
  pose.state = pose_t::STATE_TRACKING;
  pose.x = 1.5;
  pose.y = -2.0;
  pose.theta = 1.5707963;
  lcm_.publish(channels::kPose, &pose);
  say(9, navigation_status_t::STATE_WAITING, "somebody stands in the way");
  EXPECT_EQ(request.progress(), "waiting | at (1.50, -2.00) 90 deg | 3.2 m left | somebody stands in the way");
}

TEST_F(GoalOrderTest, SurvivesBytesThatAreNoStatus) {
  GoalOrder request(lcm_, goal(9));
  request.tick();
  const std::uint8_t bytes[] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  lcm_.publish(channels::kNavigationStatus, bytes, sizeof(bytes));
  drain();
  EXPECT_FALSE(request.outcome());
}

TEST_F(GoalOrderTest, EndsAPauseAndAResumptionAsSoonAsTheyAreObeyed) {
  goal_t pause = goal(7);
  pause.action = goal_t::ACTION_PAUSE;
  GoalOrder pausing(lcm_, pause);
  say(7, navigation_status_t::STATE_PAUSED);
  EXPECT_EQ(pausing.outcome(), Outcome::kPaused);
  goal_t resume = goal(8);
  resume.action = goal_t::ACTION_RESUME;
  GoalOrder resuming(lcm_, resume);
  say(8, navigation_status_t::STATE_LOCALIZING);
  EXPECT_EQ(resuming.outcome(), Outcome::kResumed);
}

TEST_F(GoalOrderTest, SaysThatThereIsNoGoalToPause) {
  goal_t pause = goal(7);
  pause.action = goal_t::ACTION_PAUSE;
  GoalOrder pausing(lcm_, pause);
  say(7, navigation_status_t::STATE_ARRIVED);
  EXPECT_EQ(pausing.outcome(), Outcome::kNothingToDo);
}

}  // namespace
}  // namespace luminav
