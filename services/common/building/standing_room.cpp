#include "services/common/building/standing_room.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "services/common/building/distance_transform.hpp"

namespace luminav {

StandingRoom::StandingRoom(const PriorMap& map) : geometry_(map.geometry), part_(map.geometry.size(), 0) {
  const double reach = std::ceil(kRobotRadius / geometry_.resolution);  // [cells]
  std::vector<bool> is_solid(geometry_.size());
  std::transform(map.cells.begin(), map.cells.end(), is_solid.begin(), [](Prior cell) { return cell != Prior::kFree; });
  const std::vector<float> squared = squared_distances_to(is_solid, static_cast<std::size_t>(geometry_.columns));
  std::vector<bool> is_allowed(geometry_.size());
  std::transform(squared.begin(), squared.end(), is_allowed.begin(),
                 [&](float cells) { return static_cast<double>(cells) > reach * reach; });
  std::size_t largest_size = 0;
  for (std::size_t i = 0; i < part_.size(); ++i) {
    if (is_allowed[i] && part_[i] == 0) {
      const std::size_t size = flood(is_allowed, i, ++parts_);
      if (size > largest_size) {
        largest_size = size;
        largest_ = parts_;
      }
    }
  }
}

int StandingRoom::part_at(const Eigen::Vector2d& point) const {
  const Cell cell = geometry_.cell_at(point);
  return geometry_.contains(cell) ? part_[geometry_.index(cell)] : 0;
}

std::size_t StandingRoom::flood(const std::vector<bool>& is_allowed, std::size_t start, int part) {
  std::vector<std::size_t> open = {start};
  part_[start] = part;
  std::size_t size = 0;
  const auto columns = static_cast<std::size_t>(geometry_.columns);
  while (!open.empty()) {
    const std::size_t here = open.back();
    open.pop_back();
    ++size;
    const std::size_t column = here % columns;
    const std::array<std::pair<bool, std::size_t>, 4> neighbours = {{{column > 0, here - 1},
                                                                     {column + 1 < columns, here + 1},
                                                                     {here >= columns, here - columns},
                                                                     {here + columns < part_.size(), here + columns}}};
    for (const auto& [exists, next] : neighbours) {
      if (exists && is_allowed[next] && part_[next] == 0) {
        part_[next] = part;
        open.push_back(next);
      }
    }
  }
  return size;
}

PriorMap with_keep_out(PriorMap map, const std::vector<Zone>& zones) {
  for (int row = 0; row < map.geometry.rows; ++row) {
    for (int column = 0; column < map.geometry.columns; ++column) {
      if (find_zone(zones, ZoneKind::kKeepOut, map.geometry.centre_of({column, row})) != nullptr) {
        map.cells[map.geometry.index({column, row})] = Prior::kOccupied;
      }
    }
  }
  return map;
}

}  // namespace luminav
