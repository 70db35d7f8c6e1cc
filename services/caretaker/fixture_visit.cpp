#include "services/caretaker/fixture_visit.hpp"

#include <algorithm>

namespace luminav {
namespace {

constexpr double kMostly = 0.5;  // share of images that says so
constexpr double kHardly = 0.2;  // share of images that may be the detector's mistakes: of the 12 of a short visit, two
constexpr int kMinChanges = 4;
constexpr double kMinFlicker = 0.25;  // share of images on either side
constexpr double kMinDark = 0.08;     // share of images that show it dark: others may have missed it

}  // namespace

std::optional<bool> was_burning(const FixtureVisit& visit) {
  const int burning = visit.lit + visit.half;
  if (burning >= kMostly * visit.expected) {
    return true;
  }
  if (burning <= kHardly * visit.expected) {
    return false;
  }
  return std::nullopt;
}

bool was_half_lit(const FixtureVisit& visit) {
  return visit.half >= kMostly * visit.seen() && was_burning(visit).value_or(false);
}

bool was_flickering(const FixtureVisit& visit) {
  const int burning = visit.lit + visit.half;
  return visit.changes >= kMinChanges && std::min(burning, visit.expected - burning) >= kMinFlicker * visit.expected &&
         visit.unlit >= kMinDark * visit.expected;
}

}  // namespace luminav
