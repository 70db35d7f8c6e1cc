#include "services/caretaker/ceiling_changes.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "services/common/ceiling/fixture_map.hpp"
#include "services/common/configuration/whole_file.hpp"

namespace luminav {
namespace {

using nlohmann::json;

constexpr double kMinOffset = 0.15;        // [m] more than a pose that counts is wrong by, each time alike
constexpr double kMinTurn = radians(8.0);  // [rad]
constexpr double kAgreement = 0.08;        // [m] between visits
constexpr double kAgreementTurn = radians(6.0);
constexpr double kSeenShare = 0.5;  // of the images that had it in view
constexpr double kUnseenShare = 0.1;
constexpr double kGreyMargin = 10.0;    // grey levels by which it may be darker
constexpr double kSamePlace = 0.25;     // [m] of what is new
constexpr double kBesideElement = 0.5;  // [m] a vent that looks like a lamp
constexpr double kSameProposal = 0.30;  // [m]

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

bool is_seen(const FixtureVisit& visit) {
  return visit.seen() >= kSeenShare * visit.expected;
}

bool is_beside(const FixtureVisit& visit) {
  return std::hypot(visit.offset.x, visit.offset.y) > kMinOffset || std::abs(visit.offset.theta) > kMinTurn;
}

/// A turn [rad] as the one of those that look alike that is nearest to another turn.
double turn_beside(double turn, double other, double period) {
  return period > 0.0 ? other + std::remainder(turn - other, period) : other;
}

bool agree(const Pose2& a, const Pose2& b, double period) {
  return distance(a, b) < kAgreement && std::abs(turn_beside(a.theta, b.theta, period) - b.theta) < kAgreementTurn;
}

/// The newest visits that saw it at one offset beside its place, newest first: at least as many as did not. A robot
/// whose pose the moved fixture itself pulls along sees it at its place now and then.
std::vector<FixtureVisit> visits_beside(const std::vector<FixtureVisit>& visits, double period) {
  std::vector<FixtureVisit> best;
  for (const FixtureVisit& reference : visits) {
    if (!is_seen(reference) || !is_beside(reference)) {
      continue;
    }
    std::vector<FixtureVisit> beside;
    std::size_t counted = 0;  // of `beside`, as far back as they are the majority
    int others = 0;
    for (auto visit = visits.rbegin(); visit != visits.rend(); ++visit) {
      if (!is_seen(*visit)) {
        continue;
      }
      if (!is_beside(*visit) || !agree(visit->offset, reference.offset, period)) {
        others += is_beside(*visit) ? 2 : 1;  // a third place contradicts more than its own
      } else {
        beside.push_back(*visit);
        counted = static_cast<int>(beside.size()) >= others ? beside.size() : counted;
      }
    }
    beside.resize(counted);
    if (beside.size() > best.size()) {
      best = beside;
    }
  }
  return best;
}

std::optional<CeilingChange> find_moved(const Fixture& fixture, const std::vector<FixtureVisit>& visits) {
  const double period = symmetry_period(fixture.shape);
  const std::vector<FixtureVisit> beside = visits_beside(visits, period);
  if (static_cast<int>(beside.size()) < kMinChangeVisits) {
    return std::nullopt;
  }
  std::array<std::vector<double>, 3> offsets;
  for (const FixtureVisit& visit : beside) {
    offsets[0].push_back(visit.offset.x);
    offsets[1].push_back(visit.offset.y);
    offsets[2].push_back(turn_beside(visit.offset.theta, beside.front().offset.theta, period));
  }
  CeilingChange change{ChangeKind::kMoved,  fixture.id,        fixture, static_cast<int>(beside.size()),
                       beside.back().begin, beside.front().end};
  Pose2& pose = change.fixture.world_from_fixture;
  pose = {pose.x + median(offsets[0]), pose.y + median(offsets[1]), wrap_angle(pose.theta + median(offsets[2]))};
  return change;
}

/// In how little light [grey] a dark fixture of this shape was seen somewhere; nothing when none was.
std::optional<double> min_light(const LampLedger& ledger, const std::vector<Fixture>& fixtures, FixtureShape shape) {
  std::optional<double> min;
  for (const Fixture& fixture : fixtures) {
    if (fixture.shape != shape) {
      continue;
    }
    for (const FixtureVisit& visit : ledger.visits(fixture.id)) {
      if (visit.unlit >= kSeenShare * visit.expected) {
        min = std::min(min.value_or(visit.grey), visit.grey);
      }
    }
  }
  return min;
}

std::optional<CeilingChange> find_removed(const Fixture& fixture, const std::vector<FixtureVisit>& visits,
                                          std::optional<double> light) {
  if (!light) {
    return std::nullopt;
  }
  CeilingChange change{ChangeKind::kRemoved, fixture.id, fixture, 0, 0, 0};
  for (auto visit = visits.rbegin(); visit != visits.rend(); ++visit) {
    if (visit->seen() > kUnseenShare * visit->expected) {
      break;
    }
    if (visit->grey + kGreyMargin < *light) {
      continue;  // too dark to tell
    }
    change.until = change.visits == 0 ? visit->end : change.until;
    change.since = visit->begin;
    ++change.visits;
  }
  return change.visits >= kMinChangeVisits ? std::optional(change) : std::nullopt;
}

/// The kind of the building's fixtures that a stranger is most like, by what the localizer takes for one; nothing when
/// it is of none.
const Fixture* kind_of(const StrangerVisit& stranger, const std::vector<Fixture>& fixtures) {
  FixtureSighting sighting;
  sighting.shape = stranger.shape;
  sighting.length = stranger.length;
  sighting.width = stranger.width;
  sighting.state = SightingState::kLit;  // it may be, and then looks wider
  const Fixture* best = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const Fixture& fixture : fixtures) {
    const double misfit = std::abs(stranger.length - fixture.length) + std::abs(stranger.width - fixture.width);
    if (misfit < least && fits_kind_and_size(sighting, fixture, {})) {
      least = misfit;
      best = &fixture;
    }
  }
  return best;
}

bool is_listed(const Building& building, const Pose2& place) {
  return std::any_of(building.elements.begin(), building.elements.end(), [&](const CeilingElement& element) {
    return distance(element.world_from_element, place) < kBesideElement;
  });
}

std::vector<CeilingChange> find_new(const LampLedger& ledger, const Building& building) {
  std::vector<CeilingChange> changes;
  int free_id = 1;
  for (const Fixture& fixture : building.fixtures) {
    free_id = std::max(free_id, fixture.id + 1);
  }
  for (const StrangerVisit& stranger : ledger.strangers()) {
    const Fixture* kind = kind_of(stranger, building.fixtures);
    if (kind == nullptr || is_listed(building, stranger.world_from_fixture)) {
      continue;
    }
    const auto known = std::find_if(changes.begin(), changes.end(), [&](const CeilingChange& change) {
      return change.fixture.shape == kind->shape &&
             distance(change.fixture.world_from_fixture, stranger.world_from_fixture) < kSamePlace;
    });
    if (known != changes.end()) {
      ++known->visits;
      known->until = stranger.end;
      // the mean of all: each visit moves it by its share
      Pose2& mean = known->fixture.world_from_fixture;
      const double mean_heading = mean.theta;
      const double period = symmetry_period(kind->shape);
      const double turn = period > 0.0 ? std::remainder(stranger.world_from_fixture.theta - mean.theta, period) : 0.0;
      const double share = 1.0 / known->visits;
      mean = interpolate(mean, stranger.world_from_fixture, share);
      mean.theta = wrap_angle(mean_heading + share * turn);
      continue;
    }
    CeilingChange change{ChangeKind::kNew, 0, *kind, 1, stranger.begin, stranger.end};
    change.fixture.world_from_fixture = stranger.world_from_fixture;
    changes.push_back(change);
  }
  std::erase_if(changes, [](const CeilingChange& change) { return change.visits < kMinChangeVisits; });
  for (CeilingChange& change : changes) {
    change.id = change.fixture.id = free_id++;
  }
  return changes;
}

std::string date(std::int64_t utime) {
  return fmt::format("{:%d %b %Y, %H:%M}", fmt::localtime(static_cast<std::time_t>(utime / 1'000'000)));
}

json to_json(const CeilingChange& change) {
  const Pose2& pose = change.fixture.world_from_fixture;
  return {{"kind", static_cast<int>(change.kind)}, {"fixture", change.id}, {"pose", {pose.x, pose.y, pose.theta}}};
}

}  // namespace

const char* name_of(ChangeKind kind) {
  switch (kind) {
    case ChangeKind::kMoved:
      return "moved";
    case ChangeKind::kRemoved:
      return "removed";
    case ChangeKind::kNew:
      return "new";
  }
  return "";
}

std::vector<CeilingChange> propose_changes(const LampLedger& ledger, const Building& building) {
  std::vector<CeilingChange> changes;
  for (const Fixture& fixture : building.fixtures) {
    if (const auto moved = find_moved(fixture, ledger.visits(fixture.id))) {
      changes.push_back(*moved);
    }
  }
  for (const Fixture& fixture : building.fixtures) {
    const auto light = min_light(ledger, building.fixtures, fixture.shape);
    if (const auto removed = find_removed(fixture, ledger.visits(fixture.id), light)) {
      changes.push_back(*removed);
    }
  }
  const std::vector<CeilingChange> fresh = find_new(ledger, building);
  changes.insert(changes.end(), fresh.begin(), fresh.end());
  return changes;
}

std::string describe(const CeilingChange& change, const Building& building) {
  const Pose2& pose = change.fixture.world_from_fixture;
  const std::string evidence =
      fmt::format("in {} visits from {} to {}", change.visits, date(change.since), date(change.until));
  switch (change.kind) {
    case ChangeKind::kMoved: {
      const auto listed = std::find_if(building.fixtures.begin(), building.fixtures.end(),
                                       [&](const Fixture& fixture) { return fixture.id == change.id; });
      const Pose2 place = listed == building.fixtures.end() ? pose : listed->world_from_fixture;
      return fmt::format(
          "fixture {} is seen ({:+.2f}, {:+.2f}) m and {:+.0f} deg beside its place ({:.2f}, {:.2f}), {}", change.id,
          pose.x - place.x, pose.y - place.y, degrees(wrap_angle(pose.theta - place.theta)), place.x, place.y,
          evidence);
    }
    case ChangeKind::kRemoved:
      return fmt::format("fixture {} at ({:.2f}, {:.2f}) is not seen any more, though light enough, {}", change.id,
                         pose.x, pose.y, evidence);
    case ChangeKind::kNew:
      return fmt::format(
          "a fixture of {:.2f} x {:.2f} m is seen at ({:.2f}, {:.2f}), heading {:.0f} deg, where the file has none, {}",
          change.fixture.length, change.fixture.width, pose.x, pose.y, degrees(pose.theta), evidence);
  }
  return "";
}

bool is_same(const CeilingChange& a, const CeilingChange& b) {
  return a.kind == b.kind && (a.kind == ChangeKind::kNew || a.id == b.id) &&
         distance(a.fixture.world_from_fixture, b.fixture.world_from_fixture) < kSameProposal;
}

std::vector<CeilingChange> load_refusals(const std::filesystem::path& file) {
  std::error_code error;
  std::vector<CeilingChange> refusals;
  if (!std::filesystem::exists(file, error)) {
    return refusals;
  }
  try {
    for (const json& entry : json::parse(read_whole_file(file))) {
      CeilingChange change;
      change.kind = static_cast<ChangeKind>(std::clamp(entry.at("kind").get<int>(), 0, 2));
      change.id = entry.at("fixture").get<int>();
      const json& pose = entry.at("pose");
      change.fixture.world_from_fixture = {pose.at(0).get<double>(), pose.at(1).get<double>(),
                                           pose.at(2).get<double>()};
      refusals.push_back(change);
    }
  } catch (const json::exception& why) {
    throw std::runtime_error(fmt::format("{}: {}", file.string(), why.what()));
  }
  return refusals;
}

void save_refusals(const std::filesystem::path& file, const std::vector<CeilingChange>& refusals) {
  json list = json::array();
  for (const CeilingChange& change : refusals) {
    list.push_back(to_json(change));
  }
  write_whole_file(file, list.dump(2) + "\n");
}

}  // namespace luminav
