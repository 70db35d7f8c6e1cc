#include "services/localizer/hypotheses/sonar_evidence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace luminav {
namespace {

constexpr double kHalfAngle = radians(12.5);
constexpr double kFieldError = 0.03;  // of a log-likelihood: the field knows its walls to a cell

/// 6 m x 6 m, free but for the columns of 0.1 m from `unknown_from` on, with walls from y = 0 to y = 6 in these
/// columns.
WallField field(const std::vector<int>& columns, int unknown_from = 60, bool is_complete = true) {
  PriorMap map;
  map.geometry = {0.1, {0.0, 0.0}, 60, 60};
  map.cells.assign(map.geometry.size(), Prior::kFree);
  for (int row = 0; row < 60; ++row) {
    for (int column = unknown_from; column < 60; ++column) {
      map.cells[map.geometry.index({column, row})] = Prior::kUnknown;
    }
    for (const int column : columns) {
      map.cells[map.geometry.index({column, row})] = Prior::kOccupied;
    }
  }
  return WallField(map, is_complete);
}

PoseBelief at(const Pose2& pose, double sigma = 0.0) {
  return {pose, sigma * sigma * Eigen::Matrix3d::Identity()};
}

/// Of a disc in the robot's middle, straight ahead.
PlacedEcho echo_at(double range) {
  return {{0.0, 0.0}, {range, 0.0}, range};
}

/// Likewise of a beam whose passage counts, silent or not.
PlacedEcho passing(double range, bool is_silent) {
  return {{0.0, 0.0}, {range, 0.0}, range, is_silent ? 0.0 : 1.0, 1.0};
}

class SonarEvidence : public ::testing::Test {
 protected:
  [[nodiscard]] double of(const PoseBelief& belief, const std::vector<PlacedEcho>& echoes) const {
    return log_likelihood_of_echoes(belief, echoes, walls_, kHalfAngle);
  }
  WallField walls_ = field({40});
  Pose2 facing_{2.05, 3.0, 0.0};  // 2 m before the wall's middle
};

TEST_F(SonarEvidence, SpeaksForAPoseFromWhichAWallIsThere) {
  // 0.6 of all echoes are from walls: 1 + 0.6 / 0.4 times as likely as from anything
  EXPECT_NEAR(of(at(facing_), {echo_at(2.0)}), std::log(2.5), kFieldError);
}

TEST_F(SonarEvidence, SaysNothingOfAnEchoFarFromAllWalls) {
  EXPECT_NEAR(of(at(facing_), {echo_at(1.0)}), 0.0, kFieldError);
}

TEST_F(SonarEvidence, SpeaksAgainstAPoseFromWhichTheEchoComesThroughAWall) {
  EXPECT_NEAR(of(at(facing_), {echo_at(3.5)}), -0.7, kFieldError);
}

TEST_F(SonarEvidence, SpeaksLoudlyAgainstAPoseWhoseFacingWallIsNotHeard) {
  EXPECT_NEAR(of(at(facing_), {passing(4.0, true)}), -2.9, kFieldError);
  EXPECT_NEAR(of(at(facing_), {passing(3.5, false)}), -3.6, kFieldError) << "it came through besides";
  EXPECT_NEAR(of(at(facing_, 0.9), {passing(4.0, true)}), 0.0, kFieldError) << "the wall may be farther away";
}

TEST_F(SonarEvidence, SaysNothingOfSilenceThatAWallMayExplain) {
  const Pose2 oblique{2.05, 3.0, radians(30.0)};
  EXPECT_NEAR(of(at(oblique), {passing(4.0, true)}), 0.0, kFieldError) << "a smooth wall seen at a slant is silent";
  EXPECT_NEAR(of(at({2.05, 5.9, 0.0}), {passing(4.0, true)}), 0.0, kFieldError) << "the wall ends beside the beam";
  EXPECT_NEAR(of(at({2.05, 3.0, kPi}), {passing(4.0, true)}), 0.0, kFieldError) << "no wall there";
}

TEST_F(SonarEvidence, HearsTheFaceOfAThickWallAndNotItsInside) {
  walls_ = field({40, 41, 42, 43, 44, 45, 46, 47, 48, 49});
  EXPECT_NEAR(of(at(facing_), {echo_at(2.0)}), std::log(2.5), kFieldError);
  EXPECT_NEAR(of(at(facing_), {echo_at(2.5)}), 0.0, kFieldError);
}

TEST_F(SonarEvidence, HearsNoWallThroughAnother) {
  walls_ = field({40, 50});
  EXPECT_NEAR(of(at(facing_), {echo_at(3.0)}), -0.7, kFieldError);
  walls_ = field({50});
  EXPECT_NEAR(of(at(facing_), {echo_at(3.0)}), std::log(2.5), kFieldError) << "it is heard where none is before it";
}

TEST_F(SonarEvidence, CountsAnEchoFromWhereTheMapMayHideAWallAsOneAtTheRightPose) {
  walls_ = field({}, 40, false);
  EXPECT_NEAR(of(at(facing_), {echo_at(3.0)}), 0.7, kFieldError);
  EXPECT_NEAR(of(at(facing_), {echo_at(1.0)}), 0.0, kFieldError) << "it is known to be free there";
  walls_ = field({}, 40, true);
  EXPECT_NEAR(of(at(facing_), {echo_at(3.0)}), 0.0, kFieldError) << "the map shows all walls";
  walls_ = field({39}, 40, false);
  EXPECT_NEAR(of(at(facing_), {echo_at(3.0)}), -0.7, kFieldError) << "it came through a wall";
}

TEST_F(SonarEvidence, LetsAPoseBeAsWrongAsItsCovarianceSays) {
  const Pose2 nearer{2.45, 3.0, 0.0};
  EXPECT_GT(of(at(nearer, 0.3), {echo_at(2.0)}), of(at(nearer), {echo_at(2.0)}) + 0.3);
  EXPECT_GT(of(at(facing_, 0.8), {echo_at(3.5)}), 0.0) << "it may as well stand before the wall";
}

TEST_F(SonarEvidence, FindsAWallThatOnlyTheSideOfTheBeamMeets) {
  // the beam's middle ends 0.4 m before the wall, its side at the wall
  const Pose2 oblique{2.05, 3.0, radians(40.0)};
  const double range = 2.0 / std::cos(radians(40.0) - 0.9 * kHalfAngle);
  const double ahead = 2.0 - range * std::cos(radians(40.0));
  ASSERT_GT(ahead, 0.2);
  EXPECT_NEAR(of(at(oblique), {echo_at(range)}), std::log(2.5), kFieldError);
}

TEST_F(SonarEvidence, AddsUpEchoesByTheirWeights) {
  PlacedEcho light = echo_at(2.0);
  light.weight = 0.25;
  EXPECT_NEAR(of(at(facing_), {echo_at(2.0), light}), 1.25 * of(at(facing_), {echo_at(2.0)}), 1e-12);
  EXPECT_EQ(of(at(facing_), {}), 0.0);
}

TEST_F(SonarEvidence, PlacesADiscWhereItIsOnTheRobot) {
  // a disc 0.2 m to the left of a robot that drives along the wall, looking right
  const PlacedEcho right{{0.0, 0.2}, {0.0, -1.8}, 2.0};
  EXPECT_NEAR(of(at({2.25, 3.0, 0.5 * kPi}), {right}), std::log(2.5), kFieldError);
  EXPECT_NEAR(of(at({2.25, 3.0, -0.5 * kPi}), {right}), 0.0, kFieldError);
}

}  // namespace
}  // namespace luminav
