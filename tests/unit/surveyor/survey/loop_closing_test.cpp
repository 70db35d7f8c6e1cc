#include "services/surveyor/survey/loop_closing.hpp"

#include <gtest/gtest.h>

#include "tests/unit/surveyor/survey/synthetic_drive.hpp"

namespace luminav {
namespace {

/// Fixtures of one pass each, seen from one key frame each, in the order of the drive.
class LoopClosingTest : public testing::Test {
 protected:
  void add(double x, double y, double travelled, double theta = 0.0) {
    const auto index = static_cast<int>(passes_.size());
    KeyFrame frame;
    frame.travelled = travelled;
    frames_.push_back(frame);
    estimate_.poses.push_back({x, y, 0.0});
    FixtureSighting sighting;
    sighting.robot_from_fixture = {0.0, 0.0, theta};
    passes_.push_back({0, {{index, sighting}}});
    estimate_.fixtures.push_back({0, {index}, {x, y, theta}});
  }

  /// With the same uncertainty [m] of each fixture for itself.
  [[nodiscard]] LoopClosures search(double sigma, const std::vector<PassPair>& banned = {}) const {
    const auto size = static_cast<Eigen::Index>(3 * estimate_.fixtures.size());
    const Eigen::MatrixXd covariance = 0.5 * sigma * sigma * Eigen::MatrixXd::Identity(size, size);
    return find_closures(estimate_, covariance, frames_, passes_, synthetic_model().kinds, banned);
  }

  /// A row of three, and the same row again after a way round, shifted by a drift [m].
  void drive_past_a_row_twice(double drift) {
    for (int i = 0; i < 3; ++i) {
      add(2.5 * i, 0.0, 2.5 * i);
    }
    for (int i = 0; i < 3; ++i) {
      add(2.5 * i + drift, drift, 60.0 + 2.5 * i);
    }
  }

  std::vector<KeyFrame> frames_;
  std::vector<FixturePass> passes_;
  SurveyEstimate estimate_;
};

TEST_F(LoopClosingTest, ClosesWhatIsClear) {
  drive_past_a_row_twice(0.25);
  const LoopClosures found = search(0.3);
  ASSERT_EQ(found.sure.size(), 3u);
  EXPECT_EQ(found.sure[0].first, 0);
  EXPECT_EQ(found.sure[0].second, 3);
  EXPECT_TRUE(found.doubts.empty());
}

TEST_F(LoopClosingTest, DoubtsWhatMayBeTheNextOneInTheRow) {
  drive_past_a_row_twice(1.2);
  const LoopClosures found = search(1.5);
  EXPECT_TRUE(found.sure.empty());
  EXPECT_FALSE(found.doubts.empty());
}

TEST_F(LoopClosingTest, LeavesApartWhatIsTooFarAway) {
  drive_past_a_row_twice(1.2);
  const LoopClosures found = search(0.1);
  EXPECT_TRUE(found.sure.empty());
  EXPECT_TRUE(found.doubts.empty());
}

TEST_F(LoopClosingTest, DemandsASecondOneThatAgrees) {
  add(0.0, 0.0, 0.0);
  add(2.5, 0.0, 2.5);
  add(0.25, 0.0, 60.0);
  const LoopClosures found = search(0.4);
  EXPECT_TRUE(found.sure.empty());
  EXPECT_EQ(found.doubts.size(), 1u);
}

TEST_F(LoopClosingTest, TakesNoFixtureForOneThatIsTurned) {
  add(0.0, 0.0, 0.0);
  add(0.0, 0.0, 60.0, 0.5 * kPi);
  EXPECT_TRUE(search(0.05).sure.empty());
}

TEST_F(LoopClosingTest, ObeysWhatWasFoundWrong) {
  add(0.0, 0.0, 0.0);
  add(0.02, 0.0, 60.0);
  EXPECT_EQ(search(0.05).sure.size(), 1u);
  EXPECT_TRUE(search(0.05, {{1, 0}}).sure.empty());
}

TEST_F(LoopClosingTest, MergesToTheEarlierPlace) {
  drive_past_a_row_twice(0.25);
  const SurveyEstimate merged = merge(estimate_, {{0, 3}, {1, 4}});
  ASSERT_EQ(merged.fixtures.size(), 4u);
  EXPECT_EQ(merged.fixtures[0].passes, (std::vector<int>{0, 3}));
  EXPECT_EQ(merged.fixtures[3].passes, (std::vector<int>{5}));
  EXPECT_DOUBLE_EQ(merged.fixtures[1].world_from_fixture.x, 2.5);
}

TEST_F(LoopClosingTest, SplitsPassesThatDisagree) {
  add(0.0, 0.0, 0.0);
  add(0.05, 0.0, 30.0);
  add(0.5, 0.0, 60.0);
  estimate_ = merge(estimate_, {{0, 1}, {1, 2}});
  ASSERT_EQ(estimate_.fixtures.size(), 1u);
  const std::vector<PassPair> wrong =
      split_what_disagrees(estimate_, passes_, synthetic_model().kinds, 0.15, radians(5.0));
  ASSERT_EQ(estimate_.fixtures.size(), 2u);
  EXPECT_EQ(estimate_.fixtures[0].passes, (std::vector<int>{0, 1}));
  EXPECT_NEAR(estimate_.fixtures[1].world_from_fixture.x, 0.5, 1e-12);
  EXPECT_EQ(wrong.size(), 2u);
}

}  // namespace
}  // namespace luminav
