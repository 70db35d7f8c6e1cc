#include "services/localizer/hypotheses/evidence_collector.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

constexpr double kTolerance = 1e-12;

class EvidenceCollection : public ::testing::Test {
 protected:
  /// What a round that begins now is given.
  EvidenceRound begin(bool has_image) {
    EvidenceRound round;
    round.has_image = has_image;
    collector_.hand_over(round);
    return round;
  }
  void drive(double distance) {
    for (int i = 0; i < 10; ++i) {
      collector_.advance({0.1 * distance, 0.0, 0.0});
    }
  }

  ObservationModel model_{{}, {}, {}, {}};
  EvidenceCollector collector_{model_, 0.5};
};

TEST_F(EvidenceCollection, IsHandedOverOnce) {
  drive(0.7);
  collector_.listen({PlacedEcho{}});
  collector_.add_image({ObjectTrack{}});
  EXPECT_NEAR(collector_.motion().step.pose.x, 0.7, kTolerance);
  const EvidenceRound first = begin(true);
  EXPECT_TRUE(first.motion.has_moved);
  EXPECT_NEAR(first.motion.step.pose.x, 0.7, kTolerance);
  EXPECT_GT(first.motion.step.covariance(0, 0), 0.0);
  EXPECT_NEAR(first.motion.distance, 0.7, kTolerance);
  EXPECT_EQ(first.echoes.size(), 1U);
  EXPECT_EQ(first.forgotten.size(), 1U);
  const EvidenceRound second = begin(true);
  EXPECT_FALSE(second.motion.has_moved || collector_.motion().has_moved);
  EXPECT_EQ(second.motion.distance, 0.0);
  EXPECT_TRUE(second.echoes.empty() && second.forgotten.empty());
}

TEST_F(EvidenceCollection, LetsAnImageCountForTheWaySinceTheOneBefore) {
  begin(true);
  drive(0.1);
  begin(false);
  drive(0.1);
  EXPECT_NEAR(begin(true).share, 0.4, kTolerance);
  collector_.advance({0.0, 0.0, 0.2});
  EXPECT_NEAR(begin(true).share, 0.2, kTolerance);
  drive(5.0);
  EXPECT_EQ(begin(true).share, 1.0);
}

TEST_F(EvidenceCollection, LetsAnImageStandForFewOfThoseThatPassed) {
  for (int i = 0; i < 5; ++i) {
    collector_.add_image({});
  }
  EXPECT_EQ(begin(true).images, EvidenceRound::kMaxImages);
  collector_.add_image({});
  EXPECT_EQ(begin(true).images, 1);
}

TEST_F(EvidenceCollection, SettlesTheSceneAcrossAGap) {
  drive(0.7);
  collector_.bridge({0.3, 0.0, 0.0}, Eigen::Matrix3d::Identity());
  const EvidenceRound round = begin(true);
  EXPECT_TRUE(round.motion.settles);
  EXPECT_NEAR(round.motion.step.pose.x, 1.0, kTolerance);
  EXPECT_EQ(round.share, 1.0);
  EXPECT_FALSE(begin(true).motion.settles);
}

TEST_F(EvidenceCollection, IsEmptyForANewList) {
  drive(0.7);
  collector_.listen({PlacedEcho{}});
  collector_.clear();
  const EvidenceRound round = begin(false);
  EXPECT_FALSE(round.motion.has_moved);
  EXPECT_TRUE(round.echoes.empty());
}

}  // namespace
}  // namespace luminav
