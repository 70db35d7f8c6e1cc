#include "services/surveyor/parts/part_laying.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "services/surveyor/known_building.hpp"
#include "services/surveyor/parts/part_joining.hpp"
#include "services/surveyor/survey/part_survey.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kSameTime = 50'000;  // [us] between an image and what a localizer said
constexpr std::size_t kToldEvery = 50;      // key frames between two of these

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
  const std::vector<PassPair> wrong = split_what_disagrees(survey.estimate, survey.passes, model.kinds);
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

}  // namespace

Survey lay_parts(const std::vector<Survey>& parts, const SurveyModel& model, const std::vector<ToldPose>& told) {
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

}  // namespace luminav
