#include "tests/evaluation/changes_score/change_score.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace luminav {
namespace {

constexpr double kSamePose = 1e-3;           // [m, rad] between two files
constexpr double kRight = 0.15;              // [m] between a proposed place and the true one
constexpr double kRightTurn = radians(8.0);  // [rad]
constexpr double kStrangerReach = 0.5;       // [m] from what is new to a visit of it

double turn_between(const Fixture& a, const Fixture& b) {
  const double period = symmetry_period(a.shape);
  return period == 0.0 ? 0.0 : std::abs(wrap_modulo(a.world_from_fixture.theta - b.world_from_fixture.theta, period));
}

const Fixture* find(const Building& building, int id) {
  const auto found = std::find_if(building.fixtures.begin(), building.fixtures.end(),
                                  [id](const Fixture& fixture) { return fixture.id == id; });
  return found == building.fixtures.end() ? nullptr : &*found;
}

bool is_right(const CeilingChange& proposed, const CeilingChange& change) {
  if (proposed.kind != change.kind || (change.kind != ChangeKind::kNew && proposed.id != change.id)) {
    return false;
  }
  return change.kind == ChangeKind::kRemoved ||
         (distance(proposed.fixture.world_from_fixture, change.fixture.world_from_fixture) < kRight &&
          turn_between(proposed.fixture, change.fixture) < kRightTurn);
}

int visits_of(const CeilingChange& change, const LampLedger& ledger) {
  if (change.kind != ChangeKind::kNew) {
    return static_cast<int>(ledger.visits(change.id).size());
  }
  const std::vector<StrangerVisit>& strangers = ledger.strangers();
  return static_cast<int>(std::count_if(strangers.begin(), strangers.end(), [&](const StrangerVisit& visit) {
    return distance(visit.world_from_fixture, change.fixture.world_from_fixture) < kStrangerReach;
  }));
}

}  // namespace

ChangeScore::ChangeScore(Building told, const Building& truth) : told_(std::move(told)) {
  const auto add = [&](ChangeKind kind, const Fixture& fixture) {
    changes_.push_back({{kind, fixture.id, fixture, 0, 0, 0}, 0, false, false, 0.0});
  };
  for (const Fixture& fixture : told_.fixtures) {
    const Fixture* hung = find(truth, fixture.id);
    if (hung == nullptr) {
      add(ChangeKind::kRemoved, fixture);
    } else if (distance(hung->world_from_fixture, fixture.world_from_fixture) > kSamePose ||
               turn_between(*hung, fixture) > kSamePose) {
      add(ChangeKind::kMoved, *hung);
    }
  }
  for (const Fixture& fixture : truth.fixtures) {
    if (find(told_, fixture.id) == nullptr) {
      add(ChangeKind::kNew, fixture);
    }
  }
}

void ChangeScore::look(const LampLedger& ledger) {
  const std::vector<CeilingChange> proposals = propose_changes(ledger, told_);
  for (TrueChange& change : changes_) {
    const auto proposed = std::find_if(proposals.begin(), proposals.end(), [&](const CeilingChange& proposal) {
      return is_right(proposal, change.change);
    });
    if (!change.was_proposed) {
      change.passes = visits_of(change.change, ledger);
    }
    change.is_proposed = proposed != proposals.end();
    if (change.is_proposed) {
      change.was_proposed = true;
      change.offset = distance(proposed->fixture.world_from_fixture, change.change.fixture.world_from_fixture);
    }
  }
  for (const CeilingChange& proposal : proposals) {
    const bool is_true = std::any_of(changes_.begin(), changes_.end(),
                                     [&](const TrueChange& change) { return is_right(proposal, change.change); });
    const bool is_known =
        std::any_of(wrong_.begin(), wrong_.end(), [&](const CeilingChange& known) { return is_same(known, proposal); });
    if (!is_true && !is_known) {
      wrong_.push_back(proposal);
      false_.push_back(describe(proposal, told_));
    }
  }
}

std::string ChangeScore::to_json() const {
  nlohmann::json list = nlohmann::json::array();
  for (const TrueChange& change : changes_) {
    list.push_back({{"kind", name_of(change.change.kind)},
                    {"fixture", change.change.id},
                    {"passes", change.passes},
                    {"proposed", change.is_proposed},
                    {"offset_m", change.offset}});
  }
  return nlohmann::json{{"changes", list}, {"false", false_}}.dump(1) + "\n";
}

}  // namespace luminav
