#include "services/surveyor/survey/fixture_judgement.hpp"

#include <gtest/gtest.h>

#include "tests/unit/surveyor/survey/synthetic_drive.hpp"

namespace luminav {
namespace {

/// A robot that drives 4 m along x below what it sees, or does not.
class FixtureJudgementTest : public testing::Test {
 protected:
  FixtureJudgementTest() {
    for (int i = 0; i <= 40; ++i) {
      frames_.emplace_back();
      estimate_.poses.push_back({0.1 * i, 0.0, 0.0});
    }
  }

  /// A fixture that is seen in the first `seen` of the images that have all of it in view.
  void add(const Pose2& world_from_fixture, int seen) {
    FixturePass pass;
    for (int i = 0; i <= 40 && seen > 0; ++i) {
      const Pose2 robot_from_fixture = estimate_.poses[static_cast<std::size_t>(i)].inverse() * world_from_fixture;
      if (std::abs(robot_from_fixture.x) < 0.35) {
        FixtureSighting sighting;
        sighting.robot_from_fixture = robot_from_fixture;
        pass.sightings.push_back({i, sighting});
        --seen;
      }
    }
    estimate_.fixtures.push_back({0, {static_cast<int>(passes_.size())}, world_from_fixture});
    passes_.push_back(pass);
  }

  [[nodiscard]] std::vector<JudgedFixture> judge() const {
    return judge_fixtures(estimate_, frames_, passes_, synthetic_model());
  }

  std::vector<KeyFrame> frames_;
  std::vector<FixturePass> passes_;
  SurveyEstimate estimate_;
};

TEST_F(FixtureJudgementTest, BelievesWhatIsSeenWheneverItIsInView) {
  add({2.0, 0.0, 0.0}, 6);
  const JudgedFixture judged = judge().front();
  EXPECT_EQ(judged.judgement, Judgement::kFixture);
  EXPECT_EQ(judged.seen, 6);
  EXPECT_GE(judged.expected, 6);
}

TEST_F(FixtureJudgementTest, SaysWhetherOneBurned) {
  add({2.0, 0.0, 0.0}, 6);
  EXPECT_FALSE(judge().front().has_burned);
  passes_.front().sightings.back().sighting.state = SightingState::kHalf;
  EXPECT_TRUE(judge().front().has_burned);
}

TEST_F(FixtureJudgementTest, DropsWhatIsSeenTooSeldom) {
  add({2.0, 0.0, 0.0}, 2);
  EXPECT_EQ(judge().front().judgement, Judgement::kSeldomSeen);
}

TEST_F(FixtureJudgementTest, DropsTheOneOfTwoThatIsSeenLess) {
  add({2.0, 0.0, 0.0}, 4);
  add({2.3, 0.1, 0.0}, 6);
  const std::vector<JudgedFixture> judged = judge();
  EXPECT_EQ(judged[0].judgement, Judgement::kOverlaps);
  EXPECT_EQ(judged[1].judgement, Judgement::kFixture);
}

TEST_F(FixtureJudgementTest, TakesOutOfTheUncertaintyWhatMovesTheWholeMap) {
  add({1.0, 0.0, 0.0}, 6);
  add({3.0, 0.0, 0.0}, 6);
  std::vector<JudgedFixture> judged = judge();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(6, 6);
  covariance(0, 0) = covariance(0, 3) = covariance(3, 0) = covariance(3, 3) = 1.0;  // both move along x alike
  add_uncertainty(judged, estimate_, covariance);
  EXPECT_NEAR(judged[0].sigma_along, 0.0, 1e-6);
  covariance(0, 3) = covariance(3, 0) = 0.0;  // each for itself: half of it is the map's
  add_uncertainty(judged, estimate_, covariance);
  EXPECT_NEAR(judged[0].sigma_along, std::sqrt(0.5), 1e-6);
}

}  // namespace
}  // namespace luminav
