#include "services/surveyor/survey/survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <stdexcept>

#include "services/surveyor/survey/carry_search.hpp"
#include "services/surveyor/survey/straightening.hpp"
#include "services/surveyor/survey/wheel_guess.hpp"

namespace luminav {
namespace {

constexpr double kMinRegularity = 0.7;        // 0..1 of the fixtures' headings, from which right angles are believed
constexpr double kRightAngle = radians(0.7);  // [rad] 1-sigma by which fixtures hang askew, where they are
constexpr double kRow = 0.02;                 // [m] 1-sigma of neighbours in a row
constexpr double kMaxMisfit = 4.5;            // deviations of a sighting that counts
constexpr double kMaxDisagreement = 0.15;     // [m] by which a pass may differ from its fixture
constexpr double kMaxTurn = radians(5.0);     // [rad] likewise
constexpr int kMaxRounds = 12;                // of closing loops
constexpr double kCoarseRightAngle = radians(6.0);  // [rad] the first pull on a path that has bent on the way

/// Distance driven in each part of the drive.
std::map<int, double> distances(const std::vector<KeyFrame>& frames) {
  std::map<int, double> result;
  for (const KeyFrame& frame : frames) {
    double& sum = result[frame.part];
    for (const Pose2& step : frame.steps) {
      sum += std::hypot(step.x, step.y);
    }
  }
  return result;
}

/// Keeps the part of the drive with the longest way.
void keep_longest_part(Survey& survey) {
  const std::map<int, double> parts = distances(survey.frames);
  const auto longest =
      std::max_element(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  survey.distance = longest->second;
  for (const auto& [part, length] : parts) {
    survey.left_out += part == longest->first ? 0.0 : length;
  }
  const int kept = longest->first;
  std::erase_if(survey.frames, [kept](const KeyFrame& frame) { return frame.part != kept; });
}

/// Every pass a fixture of its own, along the path that the wheels told.
SurveyEstimate first_estimate(const Survey& survey, const SurveyModel& model) {
  SurveyEstimate estimate;
  const double wheel_base = model.robot.wheel_base;
  const WheelCorrection wheels = guess_wheels(survey.frames, survey.passes, wheel_base, model.wheels);
  estimate.wheels = {wheels.scale, wheels.ratio, wheels.base};
  estimate.poses = dead_reckoning(survey.frames, wheel_base, wheels);
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

/// Joins what is one, a round of sure closures after the other: each makes the next ones surer.
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
    const std::vector<PassPair> wrong =
        split_what_disagrees(survey.estimate, survey.passes, model.kinds, kMaxDisagreement, kMaxTurn);
    if (!wrong.empty()) {
      banned.insert(banned.end(), wrong.begin(), wrong.end());
      survey.estimate = graph.optimise(survey.estimate, prior);
    }
  }
}

/// Leaves out sightings that fit nothing: at the border of the view a wrong one always pulls the same way. A pass that
/// fits badly as a whole is kept: that is for others to judge.
void drop_outliers(Survey& survey, const SurveyGraph& graph) {
  const std::vector<std::vector<double>> misfits = graph.misfits(survey.estimate);
  for (std::size_t p = 0; p < survey.passes.size(); ++p) {
    std::vector<PassSighting> kept;
    for (std::size_t i = 0; i < misfits[p].size(); ++i) {
      if (misfits[p][i] <= kMaxMisfit) {
        kept.push_back(survey.passes[p].sightings[i]);
      }
    }
    if (2 * kept.size() > survey.passes[p].sightings.size()) {
      survey.passes[p].sightings = std::move(kept);
    }
  }
}

/// Moves what is no fixture from the estimate to the list of those dropped. Fixtures change their numbers.
void drop_what_is_none(Survey& survey, const SurveyModel& model) {
  const std::vector<JudgedFixture> judged = judge_fixtures(survey.estimate, survey.frames, survey.passes, model);
  std::vector<SurveyedFixture> kept;
  std::vector<int> number(judged.size(), -1);
  for (std::size_t f = 0; f < judged.size(); ++f) {
    if (judged[f].judgement == Judgement::kFixture) {
      number[f] = static_cast<int>(kept.size());
      kept.push_back(survey.estimate.fixtures[f]);
      survey.fixtures.push_back(judged[f]);
    } else {
      survey.dropped.push_back({survey.estimate.fixtures[f], judged[f]});
    }
  }
  survey.estimate.fixtures = std::move(kept);
  std::vector<ClosureDoubt> doubts;
  for (ClosureDoubt doubt : survey.doubts) {
    doubt.fixture = number[static_cast<std::size_t>(doubt.fixture)];
    for (int& candidate : doubt.candidates) {
      candidate = number[static_cast<std::size_t>(candidate)];
    }
    std::erase(doubt.candidates, -1);
    if (doubt.fixture >= 0 && !doubt.candidates.empty()) {
      doubts.push_back(doubt);
    }
  }
  survey.doubts = std::move(doubts);
}

void check(const SurveyDrive& drive) {
  if (drive.odometry.size() < 2) {
    throw std::runtime_error("the log has no ODOMETRY: without it nobody knows how far the robot drove");
  }
  if (drive.frames.empty()) {
    throw std::runtime_error("the log has neither FIXTURE_DETECTIONS nor CAMERA_IMAGE: nothing looked at the ceiling");
  }
}

}  // namespace

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

Survey survey_drive(const SurveyDrive& drive, const SurveyModel& model) {
  check(drive);
  Survey survey;
  survey.frames = choose_key_frames(drive, model.robot.camera, model.kinds.ceiling_height, find_lifts(drive));
  if (survey.frames.empty()) {
    throw std::runtime_error("no image of the log falls between two ODOMETRY messages: were their clocks the same?");
  }
  split_at(survey.frames, find_carries(survey.frames, find_passes(survey.frames, model.kinds), model));
  keep_longest_part(survey);
  survey.passes = find_passes(survey.frames, model.kinds);
  if (survey.passes.empty()) {
    throw std::runtime_error(
        fmt::format("no fixture of the {} kinds was seen in {} images over {:.0f} m: do the sizes in the file of kinds "
                    "fit, and is the ceiling {:.2f} m high?",
                    model.kinds.kinds.size(), survey.frames.size(), survey.distance, model.kinds.ceiling_height));
  }
  for (std::size_t k = 0; k < model.kinds.kinds.size(); ++k) {
    survey.excess_length.push_back(excess_length(survey.passes, model.kinds, static_cast<int>(k)));
  }
  const SurveyGraph graph(model, survey.frames, survey.passes);
  survey.estimate = graph.optimise(first_estimate(survey, model), {});
  survey.regularity = regularity_of(survey.estimate, model.kinds);
  BuildingPrior prior;
  if (survey.regularity >= kMinRegularity) {
    survey.estimate.direction = dominant_direction(survey.estimate, model.kinds);
    survey.estimate = graph.optimise(survey.estimate, {kCoarseRightAngle});
    prior.right_angle = kRightAngle;
    survey.estimate = graph.optimise(survey.estimate, prior);
  }
  close_loops(survey, model, graph, prior);
  drop_outliers(survey, graph);
  drop_what_is_none(survey, model);
  prior.row = kRow;  // not before: passes not yet joined are no row
  survey.estimate = graph.optimise(survey.estimate, prior);
  straighten(survey.estimate,
             prior.right_angle > 0.0 ? survey.estimate.direction : dominant_direction(survey.estimate, model.kinds));
  add_uncertainty(survey.fixtures, survey.estimate, graph.fixture_covariance(survey.estimate, prior));
  return survey;
}

}  // namespace luminav
