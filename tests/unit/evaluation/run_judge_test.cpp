#include "tests/evaluation/judge/run_judge.hpp"

#include <gtest/gtest.h>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr Pose2 kBelow{0.0, 0.0, 0.0};       // a fixture is above
constexpr Pose2 kElsewhere{10.0, 0.0, 0.0};  // none is

/// One fixture of 1.2 x 0.3 m at the origin, 2.8 m up.
WorldTruth one_fixture() {
  WorldTruth world;
  Fixture fixture;
  fixture.id = 1;
  world.building.fixtures = {fixture};
  world.robot.camera.mounting.z = 0.3;
  return world;
}

/// Wheels slip from 2 to 5 s.
Scenario one_slip() {
  Scenario scenario;
  ScenarioEvent& slip = scenario.events.emplace_back();
  slip.kind = EventKind::kSlip;
  slip.at = 2.0;
  slip.duration = 3.0;
  return scenario;
}

class RunJudgeTest : public ::testing::Test {
 protected:
  explicit RunJudgeTest(const Scenario& scenario = {}) : judge_(lcm_, scenario, one_fixture()) {}

  template <typename Message>
  void say(const char* channel, const Message& message) {
    lcm_.publish(channel, &message);
    lcm_.handle();
  }

  /// For some time [s] the robot is in one place, in somebody's hands or not, and believes what it says.
  void stay(double duration, const Pose2& where, bool is_carried, std::int8_t state, const Pose2& belief) {
    for (double passed = 0.0; passed < duration - 0.05; passed += 0.1) {
      utime_ += 100'000;
      carries_ += is_carried && !was_carried_ ? 1 : 0;
      was_carried_ = is_carried;
      sim_truth_t truth{};
      truth.utime = utime_;
      truth.x = where.x;
      truth.y = where.y;
      truth.theta = where.theta;
      truth.carried = is_carried ? 1 : 0;
      truth.carries = carries_;
      truth.clearance = 1.0;
      say(channels::kSimTruth, truth);
      pose_t pose{};
      pose.utime = utime_;
      pose.sequence = ++sequence_;
      pose.state = state;
      pose.x = belief.x;
      pose.y = belief.y;
      pose.theta = belief.theta;
      pose.covariance[0] = pose.covariance[4] = pose.covariance[8] = 1e-4;
      say(channels::kPose, pose);
    }
  }
  void track(double duration, const Pose2& where) { stay(duration, where, false, pose_t::STATE_TRACKING, where); }

  lcm::LCM lcm_{"memq://"};
  RunJudge judge_;
  std::int64_t utime_ = 1'000'000;
  std::int32_t sequence_ = 0;
  std::int32_t carries_ = 0;
  bool was_carried_ = false;
};

TEST_F(RunJudgeTest, CountsACarryThatWasNoticedAndRecoveredFrom) {
  track(2.0, kBelow);
  stay(0.5, kElsewhere, true, pose_t::STATE_TRACKING, kBelow);  // within its second of grace
  stay(2.0, kElsewhere, true, pose_t::STATE_AMBIGUOUS, kBelow);
  stay(5.0, kElsewhere, false, pose_t::STATE_AMBIGUOUS, kBelow);
  track(1.0, kElsewhere);
  const RunReport report = judge_.report({});
  EXPECT_EQ(report.carries, 1);
  EXPECT_EQ(report.carries_noticed, 1);
  EXPECT_EQ(report.carries_recovered, 1);
  EXPECT_EQ(report.confident_wrong_s, 0.0);
  EXPECT_EQ(report.tracking_ratio, 1.0) << "what comes between carry and recovery is the carry's";
}

TEST_F(RunJudgeTest, CountsWhoeverStaysSureInTheWrongPlace) {
  track(2.0, kBelow);
  stay(0.5, kElsewhere, true, pose_t::STATE_TRACKING, kBelow);
  stay(3.0, kElsewhere, false, pose_t::STATE_TRACKING, kBelow);
  stay(3.0, kElsewhere, false, pose_t::STATE_AMBIGUOUS, kBelow);
  const RunReport report = judge_.report({});
  EXPECT_EQ(report.carries, 1);
  EXPECT_EQ(report.carries_noticed, 0);
  EXPECT_EQ(report.carries_recovered, 0);
  EXPECT_NEAR(report.confident_wrong_s, 2.5, 0.15);
}

TEST_F(RunJudgeTest, IsNotRecoveredByAWrongPose) {
  track(2.0, kBelow);
  stay(2.0, kElsewhere, true, pose_t::STATE_AMBIGUOUS, kBelow);
  stay(2.0, kElsewhere, false, pose_t::STATE_TRACKING, {5.0, 0.0, 0.0});
  EXPECT_EQ(judge_.report({}).carries_recovered, 0);
  EXPECT_GT(judge_.report({}).confident_wrong_s, 1.0);
}

TEST_F(RunJudgeTest, FollowsWithItsEyesWhoeverIsNeverContradicted) {
  track(2.0, kBelow);
  stay(2.0, kBelow, true, pose_t::STATE_TRACKING, kBelow);
  track(1.0, kBelow);
  EXPECT_EQ(judge_.report({}).carries_noticed, 1);
  EXPECT_EQ(judge_.report({}).carries_recovered, 1);
}

class SlipJudgeTest : public RunJudgeTest {
 protected:
  SlipJudgeTest() : RunJudgeTest(one_slip()) {}
  void be_wrong(double duration, const Pose2& where, std::int8_t state = pose_t::STATE_TRACKING) {
    stay(duration, where, false, state, where * Pose2{0.6, 0.0, 0.0});
  }
};

TEST_F(SlipJudgeTest, ExcusesAWrongPoseUntilASecondAfterTheFirstImageThatContradicts) {
  track(2.5, kElsewhere);
  be_wrong(10.0, kElsewhere);  // where no fixture tells it
  EXPECT_EQ(judge_.report({}).confident_wrong_s, 0.0);
  be_wrong(0.9, kBelow);
  EXPECT_EQ(judge_.report({}).confident_wrong_s, 0.0);
  be_wrong(3.0, kBelow);
  EXPECT_NEAR(judge_.report({}).confident_wrong_s, 2.9, 0.15);
  be_wrong(3.0, kElsewhere);
  EXPECT_NEAR(judge_.report({}).confident_wrong_s, 5.9, 0.15) << "it has been told";
}

TEST_F(SlipJudgeTest, CountsTheSecondFromAnImageThatContradictsAPoseThatIsNotYetWrong) {
  track(2.5, kElsewhere);
  stay(2.0, kBelow, false, pose_t::STATE_TRACKING, {0.4, 0.0, 0.0});
  be_wrong(2.0, kElsewhere);
  EXPECT_NEAR(judge_.report({}).confident_wrong_s, 2.0, 0.15);
}

TEST_F(SlipJudgeTest, ExcusesNothingOnceAnImageAfterTheSlipAgrees) {
  track(5.5, kElsewhere);
  track(1.0, kBelow);
  be_wrong(2.0, kElsewhere);
  EXPECT_NEAR(judge_.report({}).confident_wrong_s, 2.0, 0.15);
}

TEST_F(SlipJudgeTest, ExcusesNothingBeforeTheSlip) {
  track(0.5, kElsewhere);
  be_wrong(1.0, kElsewhere);
  EXPECT_NEAR(judge_.report({}).confident_wrong_s, 1.0, 0.15);
}

TEST_F(SlipJudgeTest, ExcusesNoPoseThatIsDeclaredAfterItWasNoticed) {
  track(2.5, kElsewhere);
  be_wrong(1.0, kElsewhere, pose_t::STATE_AMBIGUOUS);
  be_wrong(2.0, kElsewhere);
  EXPECT_NEAR(judge_.report({}).confident_wrong_s, 2.0, 0.15);
}

TEST_F(RunJudgeTest, LeavesOutACarryThatGoesOnAsTheRunEnds) {
  for (const std::int8_t state : {pose_t::STATE_TRACKING, pose_t::STATE_AMBIGUOUS}) {
    track(2.0, kBelow);
    stay(0.5, kElsewhere, true, state, kBelow);
    const RunReport report = judge_.report({});
    EXPECT_EQ(report.carries, carries_ - 1);
    EXPECT_EQ(report.carries_noticed, carries_ - 1);
    EXPECT_EQ(report.carries_recovered, carries_ - 1);
    stay(1.0, kElsewhere, true, pose_t::STATE_AMBIGUOUS, kBelow);
    track(1.0, kElsewhere);
    EXPECT_EQ(judge_.report({}).carries, carries_);
    EXPECT_EQ(judge_.report({}).carries_noticed, carries_);
    EXPECT_EQ(judge_.report({}).carries_recovered, carries_);
  }
}

}  // namespace
}  // namespace luminav
