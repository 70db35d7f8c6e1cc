#include "services/caretaker/shared_switches.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

namespace luminav {
namespace {

constexpr std::int64_t kTogether = 120'000'000;  // [us] between the beginnings of two visits
constexpr double kNeighbour = 5.0;               // [m]
const double kNeighbourOdds = std::log(4.0);     // of sharing a switch, before anything was seen
const double kStrangerOdds = std::log(1.0 / 20.0);
const double kEnough = std::log(50.0);
constexpr double kFaultless = 0.98;   // of two lamps on one switch: how often they look alike
constexpr double kMaxByChance = 0.8;  // of two on different switches, where all lamps burn at each visit

struct Together {
  int alike = 0;
  int different = 0;
  int burning_a = 0;
  int burning_b = 0;
};

Together count_together(const std::vector<FixtureVisit>& a, const std::vector<FixtureVisit>& b, std::int64_t until) {
  Together together;
  for (const FixtureVisit& mine : a) {
    const std::optional<bool> burns = was_burning(mine);
    if (mine.begin >= until || !burns) {
      continue;
    }
    for (const FixtureVisit& other : b) {
      const std::optional<bool> other_burns = was_burning(other);
      if (!other_burns || !are_together(mine, other)) {
        continue;
      }
      ++(*burns == *other_burns ? together.alike : together.different);
      together.burning_a += *burns ? 1 : 0;
      together.burning_b += *other_burns ? 1 : 0;
      break;  // a visit speaks once
    }
  }
  return together;
}

double log_odds(const Together& together, double prior) {
  const double visits = together.alike + together.different;
  const double a = (together.burning_a + 1.0) / (visits + 2.0);
  const double b = (together.burning_b + 1.0) / (visits + 2.0);
  const double by_chance = std::min(kMaxByChance, a * b + (1.0 - a) * (1.0 - b));
  return prior + together.alike * std::log(kFaultless / by_chance) +
         together.different * std::log((1.0 - kFaultless) / (1.0 - by_chance));
}

}  // namespace

bool are_together(const FixtureVisit& a, const FixtureVisit& b) {
  return std::llabs(a.begin - b.begin) < kTogether;
}

std::vector<int> switch_partners(const LampLedger& ledger, const std::vector<Fixture>& fixtures, int id,
                                 std::int64_t until) {
  const auto self = std::find_if(fixtures.begin(), fixtures.end(), [id](const Fixture& f) { return f.id == id; });
  std::vector<int> partners;
  if (self == fixtures.end()) {
    return partners;
  }
  for (const Fixture& other : fixtures) {
    if (other.id == id) {
      continue;
    }
    const bool is_near = distance(other.world_from_fixture, self->world_from_fixture) < kNeighbour;
    const Together together = count_together(ledger.visits(id), ledger.visits(other.id), until);
    if (log_odds(together, is_near ? kNeighbourOdds : kStrangerOdds) > kEnough) {
      partners.push_back(other.id);
    }
  }
  return partners;
}

}  // namespace luminav
