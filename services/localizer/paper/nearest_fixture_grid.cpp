#include "services/localizer/paper/nearest_fixture_grid.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kMaxCells = 4e5;  // a fixture somebody put at 1e6 must not cost the memory of all cells between
constexpr std::int32_t kMaxBoxCells = 16;  // beyond it a box is wide

struct Span {
  double min = 0.0;
  double max = 0.0;
};

/// Least and largest distance, squared, from a point to the points of a box.
Span squared_distances(double x, double y, const PointBox& box) {
  const double outside_x = std::max({box.min_x - x, 0.0, x - box.max_x});
  const double outside_y = std::max({box.min_y - y, 0.0, y - box.max_y});
  const double far_x = std::max(std::abs(x - box.min_x), std::abs(x - box.max_x));
  const double far_y = std::max(std::abs(y - box.min_y), std::abs(y - box.max_y));
  return {outside_x * outside_x + outside_y * outside_y, far_x * far_x + far_y * far_y};
}

}  // namespace

NearestFixtureGrid::NearestFixtureGrid(const FixtureMap& map) {
  if (map.size() == 0) {
    start_.assign(2, 0);
    return;
  }
  Eigen::Vector2d min = map[0].world_from_fixture.position();
  Eigen::Vector2d max = min;
  for (const Fixture& fixture : map.fixtures()) {
    min = min.cwiseMin(fixture.world_from_fixture.position());
    max = max.cwiseMax(fixture.world_from_fixture.position());
  }
  min -= Eigen::Vector2d::Constant(kFarthest);
  max += Eigen::Vector2d::Constant(kFarthest);
  const Eigen::Vector2d extent = max - min;
  const double cell = std::max(0.5, std::sqrt(extent.x() * extent.y() / kMaxCells));
  cell_ = static_cast<float>(cell);
  cells_per_metre_ = 1.0F / cell_;
  origin_x_ = static_cast<float>(min.x());
  origin_y_ = static_cast<float>(min.y());
  columns_ = static_cast<std::int32_t>(extent.x() / cell) + 1;
  rows_ = static_cast<std::int32_t>(extent.y() / cell) + 1;
  start_.reserve(cell_of(0, rows_) + 1);
  start_.push_back(0);
  const double reach = kFarthest + cell;
  std::vector<int> near;
  for (std::int32_t row = 0; row < rows_; ++row) {
    for (std::int32_t column = 0; column < columns_; ++column) {
      const float x = origin_x_ + cell_ * static_cast<float>(column);
      const float y = origin_y_ + cell_ * static_cast<float>(row);
      // a little wider than the cell, so that rounding puts no point outside
      const float margin = 1e-4F + 1e-6F * (std::abs(x) + std::abs(y));
      const PointBox box{x - margin, y - margin, x + cell_ + margin, y + cell_ + margin};
      near.clear();
      map.find_near({x + 0.5F * cell_, y + 0.5F * cell_}, reach, near);
      double bound = kFarthest * kFarthest;
      for (const int index : near) {
        const Pose2& pose = map[index].world_from_fixture;
        bound = std::min(bound, squared_distances(pose.x, pose.y, box).max);
      }
      for (const int index : near) {
        const Pose2& pose = map[index].world_from_fixture;
        if (squared_distances(pose.x, pose.y, box).min <= bound) {
          entries_.push_back({static_cast<float>(pose.x), static_cast<float>(pose.y), static_cast<float>(pose.theta),
                              static_cast<float>(symmetry_period(map[index].shape)),
                              static_cast<std::uint32_t>(index)});
        }
      }
      start_.push_back(static_cast<std::uint32_t>(entries_.size()));
    }
  }
}

std::int32_t NearestFixtureGrid::column_of(float x) const {
  const float column = (x - origin_x_) * cells_per_metre_;
  return static_cast<std::int32_t>(std::clamp(column, 0.0F, static_cast<float>(columns_ - 1)));
}

std::int32_t NearestFixtureGrid::row_of(float y) const {
  const float row = (y - origin_y_) * cells_per_metre_;
  return static_cast<std::int32_t>(std::clamp(row, 0.0F, static_cast<float>(rows_ - 1)));
}

bool NearestFixtureGrid::find(const PointBox& box, BoxCandidates& candidates) const {
  candidates.count = 0;
  const std::int32_t first_column = column_of(box.min_x);
  const std::int32_t last_column = column_of(box.max_x);
  const std::int32_t first_row = row_of(box.min_y);
  const std::int32_t last_row = row_of(box.max_y);
  if ((last_column - first_column + 1) * (last_row - first_row + 1) > kMaxBoxCells) {
    return false;
  }
  std::uint32_t fixtures[2 * kMaxCandidates];
  const Entry* found[2 * kMaxCandidates];
  Span spans[2 * kMaxCandidates];
  std::size_t count = 0;
  double bound = kFarthest * kFarthest;
  for (std::int32_t row = first_row; row <= last_row; ++row) {
    for (std::int32_t column = first_column; column <= last_column; ++column) {
      const std::size_t cell = cell_of(column, row);
      for (std::uint32_t i = start_[cell]; i < start_[cell + 1]; ++i) {
        const Entry& entry = entries_[i];
        if (std::find(fixtures, fixtures + count, entry.fixture) != fixtures + count) {
          continue;
        }
        if (count == 2 * kMaxCandidates) {
          return false;
        }
        fixtures[count] = entry.fixture;
        found[count] = &entry;
        spans[count] = squared_distances(entry.x, entry.y, box);
        bound = std::min(bound, spans[count].max);
        ++count;
      }
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (spans[i].min > bound) {
      continue;
    }
    if (candidates.count == kMaxCandidates) {
      return false;
    }
    const std::size_t k = candidates.count++;
    candidates.x[k] = found[i]->x;
    candidates.y[k] = found[i]->y;
    candidates.theta[k] = found[i]->theta;
    candidates.period[k] = found[i]->period;
  }
  return true;
}

void NearestFixtureGrid::find_each(const float* x, const float* y, const NearestOffsets& nearest,
                                   std::size_t count) const {
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t cell = cell_of(column_of(x[i]), row_of(y[i]));
    Entry best{x[i] + static_cast<float>(kFarthest), y[i], 0.0F, 0.0F, 0};
    float min = static_cast<float>(kFarthest * kFarthest);
    for (std::uint32_t k = start_[cell]; k < start_[cell + 1]; ++k) {
      const float dx = entries_[k].x - x[i];
      const float dy = entries_[k].y - y[i];
      const float squared = dx * dx + dy * dy;
      if (squared < min) {
        min = squared;
        best = entries_[k];
      }
    }
    nearest.dx[i] = best.x - x[i];
    nearest.dy[i] = best.y - y[i];
    nearest.theta[i] = best.theta;
    nearest.period[i] = best.period;
  }
}

}  // namespace luminav
