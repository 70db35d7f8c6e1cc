#include "services/surveyor/survey/survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "services/surveyor/known_building.hpp"
#include "services/surveyor/parts/carry_search.hpp"
#include "services/surveyor/parts/part_laying.hpp"
#include "services/surveyor/survey/part_survey.hpp"
#include "services/surveyor/survey/straightening.hpp"

namespace luminav {
namespace {

constexpr double kRow = 0.02;       // [m] 1-sigma of neighbours in a row
constexpr double kMaxMisfit = 4.5;  // deviations of a sighting that counts

/// The frames of each part of the drive.
std::vector<std::vector<KeyFrame>> parts_of(const std::vector<KeyFrame>& frames) {
  std::vector<std::vector<KeyFrame>> parts;
  for (const KeyFrame& frame : frames) {
    if (parts.empty() || parts.back().back().part != frame.part) {
      parts.emplace_back();
    }
    parts.back().push_back(frame);
  }
  return parts;
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
      survey.estimate.dropped.push_back(survey.estimate.fixtures[f]);
      survey.dropped.push_back(judged[f]);
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

/// Distance [m] of a fixture from where the known building has it.
double moved_by(const SurveyedFixture& fixture, const SurveyModel& model) {
  return fixture.known < 0
             ? 0.0
             : distance(fixture.world_from_fixture,
                        model.known->building.fixtures[static_cast<std::size_t>(fixture.known)].world_from_fixture);
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

Survey survey_drive(const SurveyDrive& drive, const SurveyModel& model) {
  check(drive);
  std::vector<KeyFrame> frames =
      choose_key_frames(drive, model.robot.camera, model.kinds.ceiling_height, find_lifts(drive));
  if (frames.empty()) {
    throw std::runtime_error("no image of the log falls between two ODOMETRY messages: were their clocks the same?");
  }
  split_at(frames, find_carries(frames, find_passes(frames, model.kinds), model));
  std::vector<Survey> parts;
  for (std::vector<KeyFrame>& part : parts_of(frames)) {
    parts.push_back(survey_part(std::move(part), model));
  }
  Survey survey = lay_parts(parts, model, drive.told);
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
  BuildingPrior prior = prior_of(survey);
  drop_outliers(survey, graph);
  drop_what_is_none(survey, model);
  prior.row = kRow;  // not before: passes not yet joined are no row
  survey.estimate = graph.optimise(survey.estimate, prior);
  for (std::size_t f = 0; f < survey.fixtures.size(); ++f) {
    survey.fixtures[f].moved = moved_by(survey.estimate.fixtures[f], model);
  }
  if (!survey.is_placed) {
    straighten(survey.estimate,
               prior.right_angle > 0.0 ? survey.estimate.direction : dominant_direction(survey.estimate, model.kinds));
  }
  add_uncertainty(survey.fixtures, survey.estimate, graph.fixture_covariance(survey.estimate, prior));
  return survey;
}

}  // namespace luminav
