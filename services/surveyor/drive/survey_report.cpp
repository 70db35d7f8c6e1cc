#include "services/surveyor/drive/survey_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "services/surveyor/drive/pose_at.hpp"

namespace luminav {
namespace {

using nlohmann::json;

constexpr double kUnsure = 0.15;       // [m] 1-sigma of a fixture's place from which another drive is worth it
constexpr double kWrongLength = 0.05;  // fraction by which a kind may look longer or shorter than the file says
constexpr double kLongGap = 2.0;       // [s] without odometry
constexpr double kLongBlindWay = 5.0;  // [m] without an image
constexpr double kMoved = 0.20;        // [m] by which a fixture hangs elsewhere than its file has it
constexpr int kExpected = 6;           // images that ought to have shown a fixture
constexpr double kMinSigma = 0.002;    // [m, and rad] that no survey is better than
constexpr double kLoopWay = 30.0;      // [m] from which a drive can be expected to close a loop

/// The building that the survey goes on with; nullptr = none.
const Building* base_of(const Survey& survey, const SurveyModel& model) {
  return survey.is_placed ? &model.known->building : nullptr;
}

/// Numbers of the fixtures in the building's file.
std::vector<int> ids_of(const Survey& survey, const SurveyModel& model) {
  const Building* base = base_of(survey, model);
  int last = 0;
  for (std::size_t f = 0; base != nullptr && f < base->fixtures.size(); ++f) {
    last = std::max(last, base->fixtures[f].id);
  }
  std::vector<int> ids;
  for (const SurveyedFixture& fixture : survey.estimate.fixtures) {
    ids.push_back(fixture.known >= 0 ? base->fixtures[static_cast<std::size_t>(fixture.known)].id : ++last);
  }
  return ids;
}

bool has_closure(const Survey& survey) {
  return std::any_of(survey.estimate.fixtures.begin(), survey.estimate.fixtures.end(),
                     [](const SurveyedFixture& fixture) { return fixture.passes.size() > 1; });
}

std::string place(const Pose2& pose) {
  return fmt::format("({:.1f}, {:.1f})", pose.x, pose.y);
}

void add_log_remarks(const Survey& survey, const SurveyLog& log, std::vector<std::string>& remarks) {
  if (log.is_cut) {
    remarks.push_back("the log is cut off; what was whole before was used");
  }
  if (log.longest_gap > kLongGap) {
    remarks.push_back(fmt::format("the log has a gap of {:.1f} s without ODOMETRY; the map is less sure from there on",
                                  log.longest_gap));
  }
  if (log.blind_way > kLongBlindWay) {
    remarks.push_back(
        fmt::format("the robot drove {:.0f} m without an image; fixtures there are missing", log.blind_way));
  }
  if (log.looked_at == 0) {
    remarks.push_back(
        "the log's images were not looked at: of how large the map is only wheels and ceiling height tell");
  }
  if (log.drive.echoes.empty()) {
    remarks.push_back("the log has no SONAR: the map shows only where the robot drove");
  }
  for (const NamedMoment& named : log.places) {
    if (!pose_at(survey.frames, survey.estimate.poses, log.drive.odometry, named.utime)) {
      remarks.push_back(fmt::format("the place {} was named where the map does not reach: it is left out", named.name));
    }
  }
  if (survey.joined_parts > 0) {
    remarks.push_back(
        fmt::format("odometry began anew, the robot was carried or another log began, {} times: these parts were laid "
                    "on the map by the "
                    "fixtures that both have seen",
                    survey.joined_parts));
  }
  if (survey.left_out > 0.0) {
    remarks.push_back(fmt::format(
        "odometry began anew, or the robot was carried: of {:.0f} m nobody can tell where they lie, {:.0f} m "
        "are on the map; drive there once more from a place that is on it",
        survey.left_out, survey.distance));
  }
}

void add_kind_remarks(const Survey& survey, const CeilingKinds& kinds, std::vector<std::string>& remarks) {
  for (std::size_t k = 0; k < kinds.kinds.size(); ++k) {
    const double excess = survey.excess_length[k];
    const bool is_used =
        std::any_of(survey.estimate.fixtures.begin(), survey.estimate.fixtures.end(),
                    [&](const SurveyedFixture& fixture) { return fixture.kind == static_cast<int>(k); });
    if (std::abs(excess) > kWrongLength) {
      remarks.push_back(fmt::format(
          "fixtures of kind {} look {:.0f} % {} than the file of kinds says: measure their length ({:.2f} m "
          "there) and the ceiling's height ({:.2f} m) again",
          k + 1, 100.0 * std::abs(excess), excess > 0.0 ? "longer" : "shorter", kinds.kinds[k].length,
          kinds.ceiling_height));
    }
    if (!is_used) {
      remarks.push_back(fmt::format("no fixture of kind {} was found", k + 1));
    }
  }
}

/// What of the known building is not as its file says.
void add_known_remarks(const Survey& survey, const SurveyModel& model, std::vector<std::string>& remarks) {
  if (!survey.is_placed) {
    if (model.known) {
      remarks.push_back(why_not_placed(survey, model));
    }
    return;
  }
  std::vector<int> unseen;
  for (std::size_t f = 0; f < survey.fixtures.size(); ++f) {
    const SurveyedFixture& fixture = survey.estimate.fixtures[f];
    if (fixture.known < 0) {
      continue;
    }
    const int id = model.known->building.fixtures[static_cast<std::size_t>(fixture.known)].id;
    const double moved = survey.fixtures[f].moved;
    if (fixture.passes.empty() && survey.fixtures[f].expected >= kExpected) {
      unseen.push_back(id);
    } else if (!fixture.passes.empty() && moved > kMoved) {
      remarks.push_back(fmt::format("fixture {} hangs {:.2f} m from where the file had it", id, moved));
    }
  }
  if (!unseen.empty()) {
    remarks.push_back(
        fmt::format("not seen though the robot passed below: fixtures {} of the file; they stay in it: are "
                    "they dark, or gone?",
                    fmt::join(unseen, ", ")));
  }
}

/// Of what never burned among lamps that did, some may be none.
void add_lamp_remarks(const Survey& survey, const std::vector<int>& ids, std::vector<std::string>& remarks) {
  std::vector<int> dark;
  for (std::size_t f = 0; f < survey.fixtures.size(); ++f) {
    const SurveyedFixture& fixture = survey.estimate.fixtures[f];
    if (fixture.known < 0 && !survey.fixtures[f].has_burned) {
      dark.push_back(ids[f]);
    }
  }
  if (!dark.empty() && 2 * dark.size() < survey.fixtures.size()) {
    remarks.push_back(
        fmt::format("fixtures {} never burned while most did: are they lamps? A vent of a lamp's size looks like one "
                    "that is off; the robot finds its way by it all the same, and a report of lamps will call it dead",
                    fmt::join(dark, ", ")));
  }
}

void add_closure_remarks(const Survey& survey, const std::vector<int>& ids, std::vector<std::string>& remarks) {
  if (!has_closure(survey) && survey.distance > kLoopWay) {
    remarks.push_back(
        "the drive passed no fixture twice: nothing checks the map, which bends by as much as the "
        "uncertainties say; drive back to where you began");
  }
  for (const ClosureDoubt& doubt : survey.doubts) {
    const auto& fixtures = survey.estimate.fixtures;
    remarks.push_back(fmt::format(
        "not closed between {} and {}: fixture {} may be fixture {} (+- {:.2f} m); drive once more from the one to the "
        "other",
        place(fixtures[static_cast<std::size_t>(doubt.fixture)].world_from_fixture),
        place(fixtures[static_cast<std::size_t>(doubt.candidates.front())].world_from_fixture),
        ids[static_cast<std::size_t>(doubt.fixture)], ids[static_cast<std::size_t>(doubt.candidates.front())],
        doubt.sigma));
  }
  int unsure = 0;
  for (const JudgedFixture& fixture : survey.fixtures) {
    unsure += fixture.sigma_along > kUnsure ? 1 : 0;
  }
  if (unsure > 0) {
    remarks.push_back(
        fmt::format("{} of {} fixtures are known to no better than {:.2f} m; they are red in the plan: "
                    "drive there once more",
                    unsure, survey.fixtures.size(), kUnsure));
  }
}

/// Root mean square of the fixtures' 1-sigma.
SurveyAccuracy accuracy_of(const Survey& survey) {
  double position = 0.0;
  double heading = 0.0;
  for (const JudgedFixture& fixture : survey.fixtures) {
    position += fixture.sigma_along * fixture.sigma_along;
    heading += fixture.sigma_heading * fixture.sigma_heading;
  }
  const auto count = static_cast<double>(std::max<std::size_t>(1, survey.fixtures.size()));
  return {std::max(kMinSigma, std::sqrt(position / count)), std::max(kMinSigma, std::sqrt(heading / count))};
}

const char* name_of(Judgement judgement) {
  switch (judgement) {
    case Judgement::kFixture:
      return "fixture";
    case Judgement::kSeldomSeen:
      return "seen too seldom";
    case Judgement::kOverlaps:
      return "overlaps another one";
  }
  return "fixture";
}

json to_json(const SurveyedFixture& fixture, const JudgedFixture& judged) {
  const Pose2& pose = fixture.world_from_fixture;
  return {{"kind", fixture.kind + 1},
          {"x", pose.x},
          {"y", pose.y},
          {"theta", pose.theta},
          {"passes", fixture.passes.size()},
          {"seen", judged.seen},
          {"expected", judged.expected},
          {"has_burned", judged.has_burned}};
}

/// Adds places of the robot, the ones that lie apart.
void add_seen_from(const std::vector<Pose2>& poses, std::vector<Eigen::Vector2d>& places) {
  constexpr double kApart = 0.5;  // [m]
  for (const Pose2& pose : poses) {
    if (std::none_of(places.begin(), places.end(), [&](const Eigen::Vector2d& place) {
          return (place - pose.position()).squaredNorm() < kApart * kApart;
        })) {
      places.push_back(pose.position());
    }
  }
}

}  // namespace

Building building_of(const Survey& survey, const SurveyLog& log, const SurveyModel& model, const std::string& name) {
  const Building* base = base_of(survey, model);
  Building building;
  if (base != nullptr) {
    building = *base;
    building.fixtures.clear();
  } else {
    building.name = name;
    building.ceiling_height = model.kinds.ceiling_height;
    building.is_complete = false;
    building.places.push_back({"start", survey.estimate.poses.front(), true});
  }
  building.map_file = "map.yaml";
  building.survey = accuracy_of(survey);
  const std::vector<int> ids = ids_of(survey, model);
  for (std::size_t f = 0; f < ids.size(); ++f) {
    const SurveyedFixture& surveyed = survey.estimate.fixtures[f];
    const bool is_known = surveyed.known >= 0;
    Fixture fixture = is_known ? base->fixtures[static_cast<std::size_t>(surveyed.known)]
                               : model.kinds.kinds[static_cast<std::size_t>(surveyed.kind)];
    building.is_complete = building.is_complete && is_known;
    fixture.id = ids[f];
    if (!surveyed.passes.empty()) {
      fixture.world_from_fixture = surveyed.world_from_fixture;
      fixture.world_from_fixture.theta = wrap_modulo(surveyed.world_from_fixture.theta, symmetry_period(fixture.shape));
    }
    building.fixtures.push_back(fixture);
  }
  // somebody said so of a file to which nothing is added, or the robot passed below all that it can reach
  building.is_complete = building.is_complete || (log.is_explored && survey.left_out == 0.0);
  if (!building.is_complete) {
    add_seen_from(survey.estimate.poses, building.seen_from);
  }
  for (const NamedMoment& named : log.places) {
    if (const std::optional<Pose2> pose =
            pose_at(survey.frames, survey.estimate.poses, log.drive.odometry, named.utime)) {
      std::erase_if(building.places, [&](const Place& place) { return place.name == named.name; });
      building.places.push_back({named.name, *pose, true});
    }
  }
  return building;
}

std::string why_not_placed(const Survey& survey, const SurveyModel& model) {
  std::vector<std::string> kinds;
  add_kind_remarks(survey, model.kinds, kinds);
  return fmt::format(
      "{}: nobody can tell where in it the drive lies: of the {} fixtures that the robot passed fewer than six lie as "
      "the "
      "file has them, or they do so at several places; is it of this building, and to scale?{}{}",
      model.known->file.string(), survey.fixtures.size(), kinds.empty() ? "" : " ", fmt::join(kinds, "; "));
}

std::vector<std::string> remarks_on(const Survey& survey, const SurveyLog& log, const SurveyModel& model) {
  std::vector<std::string> remarks;
  add_log_remarks(survey, log, remarks);
  add_kind_remarks(survey, model.kinds, remarks);
  add_known_remarks(survey, model, remarks);
  if (!survey.estimate.has_converged) {
    remarks.push_back("the estimate did not settle: do not drive by this map");
  }
  add_lamp_remarks(survey, ids_of(survey, model), remarks);
  add_closure_remarks(survey, ids_of(survey, model), remarks);
  return remarks;
}

std::string survey_json(const Survey& survey, const SurveyModel& model, const std::vector<std::string>& remarks) {
  const std::vector<int> number = ids_of(survey, model);
  json fixtures = json::array();
  for (std::size_t f = 0; f < survey.fixtures.size(); ++f) {
    json entry = to_json(survey.estimate.fixtures[f], survey.fixtures[f]);
    entry["id"] = number[f];
    entry["is_known"] = survey.estimate.fixtures[f].known >= 0;
    const Eigen::Matrix3d& covariance = survey.fixtures[f].covariance;
    entry["covariance"] = std::vector<double>(covariance.data(), covariance.data() + covariance.size());
    entry["sigma_m"] = survey.fixtures[f].sigma_along;
    entry["sigma_deg"] = degrees(survey.fixtures[f].sigma_heading);
    fixtures.push_back(std::move(entry));
  }
  json dropped = json::array();
  for (std::size_t f = 0; f < survey.dropped.size(); ++f) {
    json entry = to_json(survey.estimate.dropped[f], survey.dropped[f]);
    entry["why"] = name_of(survey.dropped[f].judgement);
    dropped.push_back(std::move(entry));
  }
  json doubts = json::array();
  for (const ClosureDoubt& doubt : survey.doubts) {
    std::vector<int> ids;
    for (const int candidate : doubt.candidates) {
      ids.push_back(number[static_cast<std::size_t>(candidate)]);
    }
    doubts.push_back(
        {{"fixture", number[static_cast<std::size_t>(doubt.fixture)]}, {"may_be", ids}, {"sigma_m", doubt.sigma}});
  }
  const SurveyEstimate& estimate = survey.estimate;
  const Pose2& begin = estimate.poses.front();
  return json{{"begin_utime", survey.frames.front().utime},
              {"begin", {begin.x, begin.y, begin.theta}},
              {"distance_m", survey.distance},
              {"left_out_m", survey.left_out},
              {"joined_parts", survey.joined_parts},
              {"images", survey.frames.size()},
              {"kinds", model.kinds.kinds.size()},
              {"excess_length", survey.excess_length},
              {"regularity", survey.regularity},
              {"has_converged", estimate.has_converged},
              {"wheels", {{"scale", estimate.wheels[0]}, {"ratio", estimate.wheels[1]}, {"base", estimate.wheels[2]}}},
              {"camera",
               {{"tilt_x", estimate.camera[0]},
                {"tilt_y", estimate.camera[1]},
                {"yaw", estimate.camera[2]},
                {"scale", estimate.camera[3]},
                {"time_offset", estimate.camera[4]},
                {"lens", estimate.camera[5]}}},
              {"fixtures", fixtures},
              {"dropped", dropped},
              {"not_closed", doubts},
              {"remarks", remarks}}
             .dump(1) +
         "\n";
}

std::vector<int> unsure_fixtures(const Survey& survey, const SurveyModel& model) {
  const std::vector<int> number = ids_of(survey, model);
  std::vector<int> ids;
  for (std::size_t f = 0; f < survey.fixtures.size(); ++f) {
    if (survey.fixtures[f].sigma_along > kUnsure) {
      ids.push_back(number[f]);
    }
  }
  for (const ClosureDoubt& doubt : survey.doubts) {
    ids.push_back(number[static_cast<std::size_t>(doubt.fixture)]);
  }
  return ids;
}

}  // namespace luminav
