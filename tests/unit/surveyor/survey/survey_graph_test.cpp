#include "services/surveyor/survey/survey_graph.hpp"

#include <gtest/gtest.h>

#include "services/surveyor/survey/wheel_guess.hpp"
#include "tests/unit/surveyor/survey/synthetic_drive.hpp"

namespace luminav {
namespace {

/// A drive along a row of fixtures and what a survey makes of it, each pass for itself.
class SurveyGraphTest : public testing::Test {
 protected:
  void drive(const SyntheticErrors& errors) {
    for (int i = 0; i < 6; ++i) {
      fixtures_.push_back(fixture_at(i + 1, 2.0 + 2.5 * i, 0.0, i % 2 == 0 ? 0.0 : 0.5 * kPi));
    }
    const SyntheticDrive synthetic = drive_along({{0.0, 0.0}, {17.0, 0.0}}, fixtures_, model_, errors);
    frames_ = choose_key_frames(synthetic.drive, model_.robot.camera, 2.8);
    passes_ = find_passes(frames_, model_.kinds);
    estimate_.poses = dead_reckoning(frames_, model_.robot.wheel_base, {});
    for (std::size_t p = 0; p < passes_.size(); ++p) {
      const PassSighting& seen = passes_[p].sightings.front();
      estimate_.fixtures.push_back(
          {0,
           {static_cast<int>(p)},
           estimate_.poses[static_cast<std::size_t>(seen.frame)] * seen.sighting.robot_from_fixture});
    }
  }

  SurveyModel model_ = synthetic_model();
  std::vector<Fixture> fixtures_;
  std::vector<KeyFrame> frames_;
  std::vector<FixturePass> passes_;
  SurveyEstimate estimate_;
};

TEST_F(SurveyGraphTest, LeavesAPerfectDriveAsItIs) {
  drive({});
  const SurveyEstimate found = SurveyGraph(model_, frames_, passes_).optimise(estimate_, {});
  EXPECT_TRUE(found.has_converged);
  ASSERT_EQ(found.fixtures.size(), 6u);
  for (std::size_t f = 0; f < 6; ++f) {
    EXPECT_NEAR(found.fixtures[f].world_from_fixture.x - found.fixtures[0].world_from_fixture.x,
                2.5 * static_cast<double>(f), 2e-3);
    EXPECT_NEAR(found.fixtures[f].world_from_fixture.y, 0.0, 2e-3);
  }
}

TEST_F(SurveyGraphTest, FindsWheelsAndCameraWithTheFixtures) {
  SyntheticErrors errors;
  errors.wheels = {0.01, 0.004, 0.0};
  errors.camera_scale = 0.008;
  drive(errors);
  const SurveyEstimate found = SurveyGraph(model_, frames_, passes_).optimise(estimate_, {});
  EXPECT_NEAR(found.wheels[0], 0.01, 3e-3);
  EXPECT_NEAR(found.wheels[1], 0.004, 4e-4);
  EXPECT_NEAR(found.camera[3], 0.008, 3e-3);
  EXPECT_NEAR(found.fixtures[5].world_from_fixture.x - found.fixtures[0].world_from_fixture.x, 12.5, 0.05);
}

TEST_F(SurveyGraphTest, IsNotMadeSmallerByBloomOfFixturesThatTheBorderCuts) {
  SyntheticErrors errors;
  errors.bloom = 0.008;
  drive(errors);
  ASSERT_EQ(passes_.size(), 6u);
  const SurveyEstimate found = SurveyGraph(model_, frames_, passes_).optimise(estimate_, {});
  EXPECT_NEAR(found.fixtures[5].world_from_fixture.x - found.fixtures[0].world_from_fixture.x, 12.5, 0.015);
}

TEST_F(SurveyGraphTest, IsLessSureFartherOn) {
  drive({});
  const SurveyGraph graph(model_, frames_, passes_);
  const SurveyEstimate found = graph.optimise(estimate_, {});
  const Eigen::MatrixXd covariance = graph.fixture_covariance(found, {});
  ASSERT_EQ(covariance.rows(), 18);
  for (int f = 1; f < 6; ++f) {
    EXPECT_GT(covariance(3 * f, 3 * f), covariance(3 * f - 3, 3 * f - 3));
    EXPECT_GT(covariance(3 * f + 1, 3 * f + 1), covariance(3 * f - 2, 3 * f - 2));
  }
  EXPECT_GT(covariance(0, 0), 1e-6);
}

TEST_F(SurveyGraphTest, KnowsHeadingsBetterWhereFixturesHangAtRightAngles) {
  drive({});
  const SurveyGraph graph(model_, frames_, passes_);
  const BuildingPrior prior{radians(0.7), 0.0};
  const SurveyEstimate found = graph.optimise(estimate_, prior);
  EXPECT_NEAR(wrap_modulo(found.direction, 0.5 * kPi), 0.0, radians(0.1));
  EXPECT_LT(graph.fixture_covariance(found, prior)(17, 17), graph.fixture_covariance(found, {})(17, 17));
}

}  // namespace
}  // namespace luminav
