#include "services/localizer/hypotheses/frame_comparison.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

/// A robot under the one fixture of a building.
class FrameComparisonTest : public ::testing::Test {
 protected:
  static Building one_fixture() {
    Building building;
    building.fixtures.resize(1);
    building.fixtures[0].world_from_fixture = {5.0, 5.0, 0.0};
    return building;
  }
  [[nodiscard]] FrameComparison compare(const SightingFrame& frame) const {
    const PoseBelief under{{5.0, 5.0, 0.0}, 1e-6 * Eigen::Matrix3d::Identity()};
    return FrameComparer(frame, 0.0, 0.0, model_, {}).compare(under);
  }
  static SightingFrame frame_of_the_fixture() {
    FixtureSighting sighting;
    sighting.length = 1.2;
    sighting.width = 0.3;
    sighting.covariance = 1e-4 * Eigen::Matrix3d::Identity();
    return {0, {sighting}};
  }

  ObservationModel model_{one_fixture(), {}, {}, {}};
};

TEST_F(FrameComparisonTest, AFixtureInViewIsExpectedAndMissedWhereNothingIsSeen) {
  EXPECT_EQ(compare(frame_of_the_fixture()).expected, std::vector{0});
  EXPECT_TRUE(compare(frame_of_the_fixture()).missed.empty());
  EXPECT_EQ(compare({}).expected, std::vector{0});
  EXPECT_EQ(compare({}).missed, std::vector{0});
}

TEST_F(FrameComparisonTest, AFixtureThatHangsElsewhereFitsNotAndIsNotMissed) {
  Building building = one_fixture();
  building.fixtures[0].shape = FixtureShape::kRound;
  building.fixtures[0].length = building.fixtures[0].width = 0.3;
  const ObservationModel model(building, {}, {}, {});
  SightingFrame frame = frame_of_the_fixture();
  FixtureSighting& sighting = frame.sightings[0];
  sighting.shape = FixtureShape::kRound;
  sighting.length = sighting.width = 0.3;
  const auto look = [&](double offset) {
    sighting.robot_from_fixture = {0.0, offset, 0.0};
    const PoseBelief under{{5.0, 5.0, 0.0}, 1e-6 * Eigen::Matrix3d::Identity()};
    return FrameComparer(frame, 0.0, 0.0, model, {}).compare(under);
  };
  EXPECT_EQ(look(0.5).fixture_of_sighting, std::vector{-1});
  EXPECT_TRUE(look(0.5).missed.empty());
  EXPECT_EQ(look(0.7).missed, std::vector{0});
}

TEST_F(FrameComparisonTest, APictureForTheLampsMissesNoneForTheyMayBeUnlit) {
  SightingFrame nothing;
  nothing.shows_unlit = false;
  EXPECT_TRUE(compare(nothing).expected.empty());
  EXPECT_TRUE(compare(nothing).missed.empty());
  SightingFrame seen = frame_of_the_fixture();
  seen.shows_unlit = false;
  EXPECT_EQ(compare(seen).expected, std::vector{0});
}

TEST_F(FrameComparisonTest, AnUnlistedLampSaysLessWhereNotAllAreListed) {
  SightingFrame elsewhere = frame_of_the_fixture();
  elsewhere.sightings[0].robot_from_fixture = {0.0, 0.8, 0.0};
  const auto likelihood = [&](const SightingFrame& frame) { return compare(frame).of(0, ObjectTrack{}); };
  const double against = likelihood(elsewhere);
  EXPECT_DOUBLE_EQ(against, HypothesisParams{}.misfit);
  model_.is_complete = false;
  EXPECT_DOUBLE_EQ(likelihood(elsewhere), log_likelihood_unlisted(ObjectTrack{}));
  EXPECT_GT(likelihood(elsewhere), against + 2.0);
  EXPECT_LT(likelihood(elsewhere), likelihood(frame_of_the_fixture()));
  model_.seen = SeenCeiling({{5.0, 5.8}});
  EXPECT_DOUBLE_EQ(likelihood(elsewhere), against) << "a survey looked there";
}

TEST(SeenCeiling, ContainsWhatIsNearAPlace) {
  const SeenCeiling seen({{0.0, 0.0}, {9.0, 3.0}});
  EXPECT_TRUE(seen.contains({0.3, 0.8}));
  EXPECT_TRUE(seen.contains({9.0, 3.8}));
  for (const Eigen::Vector2d& point :
       {Eigen::Vector2d(4.0, 1.0), Eigen::Vector2d(-1.3, 0.0), Eigen::Vector2d(99.0, 1e9)}) {
    EXPECT_FALSE(seen.contains(point)) << point.transpose();
  }
  EXPECT_FALSE(SeenCeiling({}).contains({0.0, 0.0}));
}

}  // namespace
}  // namespace luminav
