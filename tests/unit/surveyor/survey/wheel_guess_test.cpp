#include "services/surveyor/survey/wheel_guess.hpp"

#include <gtest/gtest.h>

#include "tests/unit/surveyor/survey/synthetic_drive.hpp"

namespace luminav {
namespace {

std::vector<Fixture> row() {
  std::vector<Fixture> fixtures;
  for (int i = 0; i < 10; ++i) {
    fixtures.push_back(fixture_at(i + 1, 2.5 * i, 0.0, 0.0));
  }
  return fixtures;
}

TEST(WheelGuess, FindsUnequalWheelsFromWhatPassesBy) {
  const SurveyModel model = synthetic_model();
  SyntheticErrors errors;
  errors.wheels.ratio = 0.008;
  const SyntheticDrive synthetic = drive_along({{0.0, 0.0}, {25.0, 0.0}}, row(), model, errors);
  const auto frames = choose_key_frames(synthetic.drive, model.robot.camera, 2.8);
  const auto passes = find_passes(frames, model.kinds);
  const double wheel_base = model.robot.wheel_base;
  const WheelCorrection wheels = guess_wheels(frames, passes, wheel_base, {});
  EXPECT_NEAR(wheels.ratio, 0.008, 5e-4);
  // by 35 degrees, were they taken for equal
  EXPECT_NEAR(dead_reckoning(frames, wheel_base, wheels).back().theta, 0.0, radians(2.5));
  EXPECT_GT(std::abs(dead_reckoning(frames, wheel_base, {}).back().theta), radians(25.0));
}

TEST(WheelGuess, KeepsWhatIsKnownWhereNothingPassesBy) {
  const SurveyModel model = synthetic_model();
  const WheelCorrection known{0.01, 0.002, -0.003};
  const WheelCorrection wheels = guess_wheels({}, {}, model.robot.wheel_base, known);
  EXPECT_DOUBLE_EQ(wheels.scale, known.scale);
  EXPECT_DOUBLE_EQ(wheels.ratio, known.ratio);
  EXPECT_DOUBLE_EQ(wheels.base, known.base);
}

}  // namespace
}  // namespace luminav
