#include "services/common/building/lane_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

namespace luminav {
namespace {

// A robot cuts corners by about as much: who drives against a lane's direction beside it keeps so far away.
constexpr double kMargin = 0.3;  // [m]

bool belongs_to(const Zone& lane, const Eigen::Vector2d& point) {
  return contains(lane.polygon, point) || distance_to_edge(lane.polygon, point) < kMargin;
}

}  // namespace

LaneMap::LaneMap(const std::vector<Zone>& zones, const GridGeometry& geometry) : geometry_(geometry) {
  std::copy_if(zones.begin(), zones.end(), std::back_inserter(lanes_),
               [](const Zone& zone) { return zone.kind == ZoneKind::kOneWay; });
  if (lanes_.empty()) {
    return;
  }
  forbidden_.assign(geometry.size(), 0);
  for (const Zone& lane : lanes_) {
    std::uint8_t steps = 0;
    for (std::size_t i = 0; i < kLaneSteps.size(); ++i) {
      const bool is_against = goes_against(lane, {kLaneSteps[i].column, kLaneSteps[i].row});
      steps = static_cast<std::uint8_t>(steps | (is_against ? 1U << i : 0U));
    }
    for (int row = 0; row < geometry.rows; ++row) {
      for (int column = 0; column < geometry.columns; ++column) {
        if (belongs_to(lane, geometry.centre_of({column, row}))) {
          forbidden_[geometry.index({column, row})] |= steps;
        }
      }
    }
  }
}

bool LaneMap::is_against(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
  const Eigen::Vector2d piece = to - from;
  const int samples = std::max(1, static_cast<int>(std::ceil(piece.norm() / (0.5 * geometry_.resolution))));
  return std::any_of(lanes_.begin(), lanes_.end(), [&](const Zone& lane) {
    if (!goes_against(lane, piece)) {
      return false;
    }
    for (int i = 0; i <= samples; ++i) {
      if (belongs_to(lane, from + piece * (static_cast<double>(i) / samples))) {
        return true;
      }
    }
    return false;
  });
}

}  // namespace luminav
