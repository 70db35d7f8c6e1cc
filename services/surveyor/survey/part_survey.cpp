#include "services/surveyor/survey/part_survey.hpp"

#include <cmath>
#include <complex>
#include <utility>

#include "services/surveyor/survey/fixture_compass.hpp"
#include "services/surveyor/survey/straightening.hpp"
#include "services/surveyor/survey/wheel_guess.hpp"

namespace luminav {
namespace {

constexpr double kMinRegularity = 0.7;        // 0..1 of the fixtures' headings, from which right angles are believed
constexpr double kRightAngle = radians(0.7);  // [rad] 1-sigma by which fixtures hang askew, where they are
constexpr double kCoarseRightAngle = radians(6.0);  // [rad] the first pull on a path that has bent on the way
constexpr int kMaxRounds = 12;                      // of closing loops

/// Distance [m] driven.
double distance_of(const std::vector<KeyFrame>& frames) {
  double sum = 0.0;
  for (const KeyFrame& frame : frames) {
    for (const Pose2& step : frame.steps) {
      sum += std::hypot(step.x, step.y);
    }
  }
  return sum;
}

/// Every pass a fixture of its own, along a path.
SurveyEstimate estimate_along(std::vector<Pose2> path, const WheelCorrection& wheels, const Survey& survey) {
  SurveyEstimate estimate;
  estimate.wheels = {wheels.scale, wheels.ratio, wheels.base};
  estimate.poses = std::move(path);
  for (std::size_t p = 0; p < survey.passes.size(); ++p) {
    const FixturePass& pass = survey.passes[p];
    const PassSighting& middle = pass.sightings[pass.sightings.size() / 2];
    estimate.fixtures.push_back(
        {pass.kind,
         {static_cast<int>(p)},
         estimate.poses[static_cast<std::size_t>(middle.frame)] * middle.sighting.robot_from_fixture});
  }
  return estimate;
}

/// How far headings agree modulo a quarter turn: 1 = all, 0 = they point anywhere.
double regularity_of(const SurveyEstimate& estimate, const CeilingKinds& kinds) {
  std::complex<double> sum = 0.0;
  double count = 0.0;
  for (const SurveyedFixture& fixture : estimate.fixtures) {
    if (kinds.kinds[static_cast<std::size_t>(fixture.kind)].shape != FixtureShape::kRound) {
      sum += std::polar(1.0, 4.0 * fixture.world_from_fixture.theta);
      count += 1.0;
    }
  }
  return count == 0.0 ? 0.0 : std::abs(sum) / count;
}

}  // namespace

void close_loops(Survey& survey, const SurveyModel& model, const SurveyGraph& graph, const BuildingPrior& prior) {
  std::vector<PassPair> banned;
  for (int round = 0; round < kMaxRounds; ++round) {
    const Eigen::MatrixXd covariance = graph.fixture_covariance(survey.estimate, prior);
    const LoopClosures found =
        find_closures(survey.estimate, covariance, survey.frames, survey.passes, model.kinds, banned);
    survey.doubts = found.doubts;
    if (found.sure.empty()) {
      return;
    }
    survey.estimate = graph.optimise(merge(survey.estimate, found.sure), prior);
    const std::vector<PassPair> wrong = split_what_disagrees(survey.estimate, survey.passes, model.kinds);
    if (!wrong.empty()) {
      banned.insert(banned.end(), wrong.begin(), wrong.end());
      survey.estimate = graph.optimise(survey.estimate, prior);
    }
  }
}

BuildingPrior prior_of(const Survey& survey) {
  return {survey.regularity >= kMinRegularity ? kRightAngle : 0.0};
}

BuildingPrior learn_prior(Survey& survey, const SurveyModel& model, const SurveyGraph& graph) {
  survey.regularity = regularity_of(survey.estimate, model.kinds);
  const BuildingPrior prior = prior_of(survey);
  if (prior.right_angle > 0.0) {
    survey.estimate.direction = dominant_direction(survey.estimate, model.kinds);
    survey.estimate = graph.optimise(survey.estimate, {kCoarseRightAngle});
    survey.estimate = graph.optimise(survey.estimate, prior);
  }
  return prior;
}

Survey survey_part(std::vector<KeyFrame> frames, const SurveyModel& model) {
  Survey survey;
  survey.distance = distance_of(frames);
  survey.frames = std::move(frames);
  survey.passes = find_passes(survey.frames, model.kinds);
  if (survey.passes.empty()) {
    return survey;
  }
  const SurveyGraph graph(model, survey.frames, survey.passes);
  const double wheel_base = model.robot.wheel_base;
  const WheelCorrection wheels = guess_wheels(survey.frames, survey.passes, wheel_base, model.wheels);
  const std::vector<Pose2> path = dead_reckoning(survey.frames, wheel_base, wheels);
  survey.estimate = estimate_along(hold_heading(path, survey.passes), wheels, survey);
  const BuildingPrior prior = learn_prior(survey, model, graph);
  if (prior.right_angle == 0.0) {
    survey.estimate = graph.optimise(estimate_along(path, wheels, survey), prior);
  }
  close_loops(survey, model, graph, prior);
  return survey;
}

}  // namespace luminav
