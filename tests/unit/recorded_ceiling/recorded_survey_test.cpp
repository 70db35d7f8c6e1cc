// A survey of a real robot's drive, which had neither wheels nor a map to go by.

#include "tests/unit/recorded_ceiling/recorded_survey.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "services/common/geometry/angle.hpp"

namespace luminav::testing {
namespace {

// What the recording's author noted of the hall.
constexpr double kPitchAcross = 10.0 * 0.3048;  // [m]
constexpr double kPitchAlong = 12.0 * 0.3048;   // [m]
constexpr double kPitchTolerance = 0.02;        // fraction
constexpr double kTurnTolerance = radians(1.0);
constexpr double kMaxSpread = 0.06;       // [m] of the fixtures around the grid
constexpr std::size_t kMinFixtures = 12;  // that the robot came near

TEST(RecordedSurvey, FindsTheGridOfTheLightsWithoutAReferencePose) {
  const RecordedSurvey recorded = survey_recording("fisheye-published.toml");
  const LightGrid& grid = recorded.grid;
  EXPECT_NEAR(grid.pitch.x(), kPitchAcross, kPitchTolerance * kPitchAcross);
  EXPECT_NEAR(grid.pitch.y(), kPitchAlong, kPitchTolerance * kPitchAlong);
  EXPECT_NEAR(std::abs(grid.angle), 0.5 * kPi, kTurnTolerance);
  EXPECT_NEAR(grid.turn, 0.0, kTurnTolerance);
  EXPECT_LT(grid.spread, kMaxSpread);
}

TEST(RecordedSurvey, HasAllTheDriveOnOneMapAndNoFixtureTwice) {
  const RecordedSurvey recorded = survey_recording("fisheye-published.toml");
  EXPECT_EQ(recorded.survey.left_out, 0.0);
  EXPECT_GE(recorded.survey.fixtures.size(), kMinFixtures);
  EXPECT_EQ(recorded.grid.crossings, recorded.survey.fixtures.size());
}

}  // namespace
}  // namespace luminav::testing
