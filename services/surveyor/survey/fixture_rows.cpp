#include "services/surveyor/survey/fixture_rows.hpp"

#include <cmath>

namespace luminav {
namespace {

constexpr double kMinSpacing = 0.8;  // [m] between neighbours
constexpr double kMaxSpacing = 5.0;  // [m]
constexpr double kInLine = 0.15;     // [m] across the row
constexpr double kEvenness = 0.20;   // [m] by which two spacings may differ

/// Along and across a row that runs so many quarter turns from the building's direction.
Eigen::Vector2d in_row(const Pose2& from, const Pose2& to, double direction, int quarter_turns) {
  return Pose2{0.0, 0.0, direction + 0.5 * kPi * quarter_turns}.inverse() *
         Eigen::Vector2d(to.position() - from.position());
}

/// The nearest fixture in line behind another one; -1 = none.
int next_in_row(const SurveyEstimate& estimate, int fixture, int quarter_turns) {
  const SurveyedFixture& from = estimate.fixtures[static_cast<std::size_t>(fixture)];
  int nearest = -1;
  double least = kMaxSpacing;
  for (std::size_t i = 0; i < estimate.fixtures.size(); ++i) {
    const SurveyedFixture& to = estimate.fixtures[i];
    const Eigen::Vector2d at =
        in_row(from.world_from_fixture, to.world_from_fixture, estimate.direction, quarter_turns);
    if (to.kind == from.kind && std::abs(at.y()) <= kInLine && at.x() >= kMinSpacing && at.x() < least) {
      least = at.x();
      nearest = static_cast<int>(i);
    }
  }
  return nearest;
}

}  // namespace

FixtureRows find_rows(const SurveyEstimate& estimate) {
  FixtureRows rows;
  for (const int quarter_turns : {0, 1}) {
    for (std::size_t f = 0; f < estimate.fixtures.size(); ++f) {
      const auto first = static_cast<int>(f);
      const int second = next_in_row(estimate, first, quarter_turns);
      if (second < 0) {
        continue;
      }
      rows.pairs.push_back({first, second, quarter_turns});
      const int third = next_in_row(estimate, second, quarter_turns);
      if (third < 0) {
        continue;
      }
      const auto spacing = [&](int from, int to) {
        return in_row(estimate.fixtures[static_cast<std::size_t>(from)].world_from_fixture,
                      estimate.fixtures[static_cast<std::size_t>(to)].world_from_fixture, estimate.direction,
                      quarter_turns)
            .x();
      };
      if (std::abs(spacing(first, second) - spacing(second, third)) <= kEvenness) {
        rows.triples.push_back({first, second, third, quarter_turns});
      }
    }
  }
  return rows;
}

}  // namespace luminav
