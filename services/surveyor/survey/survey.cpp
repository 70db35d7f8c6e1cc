#include "services/surveyor/survey/survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "services/surveyor/survey/carry_search.hpp"
#include "services/surveyor/survey/part_joining.hpp"
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
constexpr std::int64_t kSameTime = 50'000;    // [us] between an image and what a localizer said
constexpr std::size_t kToldEvery = 50;        // key frames between two of these
constexpr double kCoarseRightAngle = radians(6.0);  // [rad] the first pull on a path that has bent on the way

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

/// What is believed of how buildings are, by how far the fixtures hang at right angles.
BuildingPrior prior_of(const Survey& survey) {
  return {survey.regularity >= kMinRegularity ? kRightAngle : 0.0};
}

/// Learns that, and pulls the estimate there.
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

/// The map of one part, its loops closed.
Survey survey_part(std::vector<KeyFrame> frames, const SurveyModel& model) {
  Survey survey;
  survey.distance = distance_of(frames);
  survey.frames = std::move(frames);
  survey.passes = find_passes(survey.frames, model.kinds);
  if (!survey.passes.empty()) {
    const SurveyGraph graph(model, survey.frames, survey.passes);
    survey.estimate = graph.optimise(first_estimate(survey, model), {});
    const BuildingPrior prior = learn_prior(survey, model, graph);
    close_loops(survey, model, graph, prior);
  }
  return survey;
}

/// The estimate with those fixtures only that are believed to be some, and which of all they are.
std::pair<SurveyEstimate, std::vector<int>> believed_of(const Survey& survey, const SurveyModel& model) {
  const std::vector<JudgedFixture> judged = judge_fixtures(survey.estimate, survey.frames, survey.passes, model);
  SurveyEstimate believed = survey.estimate;
  std::vector<int> number;
  believed.fixtures.clear();
  for (std::size_t f = 0; f < judged.size(); ++f) {
    if (judged[f].judgement == Judgement::kFixture) {
      believed.fixtures.push_back(survey.estimate.fixtures[f]);
      number.push_back(static_cast<int>(f));
    }
  }
  return {believed, number};
}

/// How a part lies in the known building by what a localizer said on the way.
std::vector<Pose2> told_motions(const Survey& part, const std::vector<ToldPose>& told) {
  std::vector<Pose2> motions;
  auto next = told.begin();
  std::size_t used = 0;
  for (std::size_t i = 0; i < part.frames.size(); ++i) {
    const std::int64_t utime = part.frames[i].utime;
    next = std::find_if(next, told.end(), [&](const ToldPose& each) { return each.utime + kSameTime >= utime; });
    if (next != told.end() && next->utime <= utime + kSameTime && (motions.empty() || i >= used + kToldEvery)) {
      motions.push_back(next->world_from_robot * part.estimate.poses[i].inverse());
      used = i;
    }
  }
  return motions;
}

/// How to look for the place of a part on a map.
struct JoinRule {
  bool at_rest = false;                         // only where the map's last image was taken
  const PriorMap* walls = nullptr;              // in the map's frame, through which nobody drives
  const std::vector<ToldPose>* told = nullptr;  // likewise: looked at first
};

std::optional<PartJoint> find_joint(const Survey& map, const Survey& part, const SurveyModel& model,
                                    const JoinRule& rule) {
  const auto [first, first_number] = believed_of(map, model);
  const auto [second, second_number] = believed_of(part, model);
  PartJoining joining(first, second, model.kinds, sight_of(model));
  joining.keep_out_of(rule.walls);
  std::optional<PartJoint> joint;
  if (rule.at_rest) {
    joint = joining.find_at_rest(map.frames.back(), part.frames.front());
  } else {
    joint = rule.told != nullptr ? joining.find_among(told_motions(part, *rule.told)) : std::nullopt;
    joint = joint ? joint : joining.find();
  }
  if (joint) {
    for (FixturePair& pair : joint->pairs) {
      pair = {first_number[static_cast<std::size_t>(pair.first)], second_number[static_cast<std::size_t>(pair.second)]};
    }
  }
  return joint;
}

/// Puts frames and poses in the order of time.
void sort_by_time(Survey& survey) {
  std::vector<int> order(survey.frames.size());
  std::iota(order.begin(), order.end(), 0);
  const auto frame = [&](int index) -> const KeyFrame& { return survey.frames[static_cast<std::size_t>(index)]; };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return frame(a).utime < frame(b).utime; });
  std::vector<int> place(order.size());
  std::vector<KeyFrame> frames;
  std::vector<Pose2> poses;
  for (const int index : order) {
    place[static_cast<std::size_t>(index)] = static_cast<int>(frames.size());
    frames.push_back(frame(index));
    poses.push_back(survey.estimate.poses[static_cast<std::size_t>(index)]);
  }
  survey.frames = std::move(frames);
  survey.estimate.poses = std::move(poses);
  for (FixturePass& pass : survey.passes) {
    for (PassSighting& seen : pass.sightings) {
      seen.frame = place[static_cast<std::size_t>(seen.frame)];
    }
  }
}

/// Both on one map, with what both have seen as one fixture.
Survey put_together(Survey map, const Survey& part, const PartJoint& joint) {
  const auto frames = static_cast<int>(map.frames.size());
  const auto passes = static_cast<int>(map.passes.size());
  const auto fixtures = static_cast<int>(map.estimate.fixtures.size());
  map.frames.insert(map.frames.end(), part.frames.begin(), part.frames.end());
  for (FixturePass pass : part.passes) {
    for (PassSighting& seen : pass.sightings) {
      seen.frame += frames;
    }
    map.passes.push_back(std::move(pass));
  }
  for (const Pose2& pose : part.estimate.poses) {
    map.estimate.poses.push_back(joint.map_from_part * pose);
  }
  for (SurveyedFixture fixture : part.estimate.fixtures) {
    fixture.world_from_fixture = joint.map_from_part * fixture.world_from_fixture;
    for (int& pass : fixture.passes) {
      pass += passes;
    }
    map.estimate.fixtures.push_back(std::move(fixture));
  }
  if (frames == 0) {
    map.estimate.wheels = part.estimate.wheels;
    map.estimate.camera = part.estimate.camera;
  }
  std::vector<FixturePair> pairs = joint.pairs;
  for (FixturePair& pair : pairs) {
    pair.second += fixtures;
  }
  map.estimate = merge(std::move(map.estimate), pairs);
  map.distance += part.distance;
  map.joined_parts += part.joined_parts + 1;
  sort_by_time(map);
  return map;
}

/// A map with a part on it, if the graph of both agrees that what was taken for one fixture is one.
std::optional<Survey> join(const Survey& map, const Survey& part, const SurveyModel& model, const JoinRule& rule) {
  if (map.estimate.fixtures.empty() || part.estimate.fixtures.empty()) {
    return std::nullopt;
  }
  const std::optional<PartJoint> joint = find_joint(map, part, model, rule);
  if (!joint) {
    return std::nullopt;
  }
  Survey survey = put_together(map, part, *joint);
  const SurveyGraph graph(model, survey.frames, survey.passes);
  survey.estimate = graph.optimise(survey.estimate, {});
  const std::vector<PassPair> wrong =
      split_what_disagrees(survey.estimate, survey.passes, model.kinds, kMaxDisagreement, kMaxTurn);
  if (4 * wrong.size() > joint->pairs.size()) {
    return std::nullopt;
  }
  close_loops(survey, model, graph, learn_prior(survey, model, graph));
  return survey;
}

/// What the known building has, before anything was driven.
Survey survey_of(const KnownBuilding& known) {
  Survey survey;
  survey.joined_parts = -1;  // the first part is placed, the others are joined to it
  survey.estimate = estimate_of(known);
  return survey;
}

/// Lays chains on a map, one after the other as they find their place, and takes those away.
void lay_on(Survey& map, std::vector<Survey>& chains, const SurveyModel& model, const JoinRule& rule) {
  bool has_grown = true;
  while (has_grown) {
    has_grown = false;
    for (auto chain = chains.begin(); chain != chains.end() && !has_grown; ++chain) {
      if (std::optional<Survey> larger = join(map, *chain, model, rule)) {
        map = std::move(*larger);
        chains.erase(chain);
        has_grown = true;
      }
    }
  }
}

/// The longest of those with fixtures, which it takes away: others are no map.
Survey take_longest(std::vector<Survey>& chains) {
  const auto longest = std::max_element(chains.begin(), chains.end(), [](const Survey& a, const Survey& b) {
    return std::pair(!a.passes.empty(), a.distance) < std::pair(!b.passes.empty(), b.distance);
  });
  Survey survey = std::move(*longest);
  chains.erase(longest);
  return survey;
}

/// First those that begin where the one before ended, then those that lie on the known building, or else on the
/// longest, by what both saw. What cannot be placed is left out.
Survey join_parts(const std::vector<Survey>& parts, const SurveyModel& model, const std::vector<ToldPose>& told) {
  std::vector<Survey> chains;
  for (const Survey& part : parts) {
    std::optional<Survey> longer = chains.empty() ? std::nullopt : join(chains.back(), part, model, {.at_rest = true});
    if (longer) {
      chains.back() = std::move(*longer);
    } else {
      chains.push_back(part);
    }
  }
  Survey survey;
  if (model.known) {
    survey = survey_of(*model.known);
    lay_on(survey, chains, model, {.walls = model.known->map ? &*model.known->map : nullptr, .told = &told});
    survey.is_placed = !survey.frames.empty();
  }
  if (!survey.is_placed) {
    survey = take_longest(chains);
    lay_on(survey, chains, model, {});
  }
  for (const Survey& chain : chains) {
    survey.left_out += chain.distance;
  }
  return survey;
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
  Survey survey = join_parts(parts, model, drive.told);
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
