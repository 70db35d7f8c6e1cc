#include "services/localizer/paper/nearest_fixture_grid.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kMaxCells = 4e6;  // a fixture somebody put at 1e6 must not cost the memory of all cells between
constexpr float kFarAway = 1e6F;   // [m]

}  // namespace

NearestFixtureGrid::NearestFixtureGrid(const FixtureMap& map) : entries_{{kFarAway, kFarAway, 0.0F, 0.0F}} {
  if (map.size() == 0) {
    return;
  }
  for (const Fixture& fixture : map.fixtures()) {
    const Pose2& pose = fixture.world_from_fixture;
    entries_.push_back({static_cast<float>(pose.x), static_cast<float>(pose.y), static_cast<float>(pose.theta),
                        static_cast<float>(symmetry_period(fixture.shape))});
  }
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(kFarthest);
  const Eigen::Vector2d extent = map.extent().sizes() + 2.0 * reach;
  geometry_.resolution = std::max(0.1, std::sqrt(extent.x() * extent.y() / kMaxCells));
  geometry_.origin = map.extent().min() - reach;
  geometry_.columns = static_cast<int>(extent.x() / geometry_.resolution) + 1;
  geometry_.rows = static_cast<int>(extent.y() / geometry_.resolution) + 1;
  origin_x_ = static_cast<float>(geometry_.origin.x());
  origin_y_ = static_cast<float>(geometry_.origin.y());
  cells_per_metre_ = static_cast<float>(1.0 / geometry_.resolution);
  columns_ = static_cast<float>(geometry_.columns);
  rows_ = static_cast<float>(geometry_.rows);
  nearest_.assign(geometry_.size(), 0);
  std::vector<double> distances(geometry_.size(), kFarthest);
  for (int index = 0; index < map.size(); ++index) {
    const Eigen::Vector2d centre = map[index].world_from_fixture.position();
    const Cell low = geometry_.cell_at(centre - reach);
    const Cell high = geometry_.cell_at(centre + reach);
    for (Cell cell = low; cell.row <= high.row; ++cell.row) {
      for (cell.column = low.column; cell.column <= high.column; ++cell.column) {
        const double distance = (geometry_.centre_of(cell) - centre).norm();
        if (geometry_.contains(cell) && distance < distances[geometry_.index(cell)]) {
          distances[geometry_.index(cell)] = distance;
          nearest_[geometry_.index(cell)] = static_cast<std::uint32_t>(index + 1);
        }
      }
    }
  }
}

}  // namespace luminav
