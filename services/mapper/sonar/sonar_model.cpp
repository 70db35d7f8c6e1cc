#include "services/mapper/sonar/sonar_model.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "services/common/geometry/rounding.hpp"

namespace luminav {
namespace {

constexpr int kArcCorners = 5;  // the chord stays within 0.2 % of the arc

Eigen::Matrix2d rotation(double angle) {
  return Eigen::Rotation2Dd(angle).toRotationMatrix();
}

/// Corners of a sector [cells], so that the centre of cell (c, r) is (c, r); apex first, then the arc.
std::array<Eigen::Vector2d, kArcCorners + 1> corners_of_sector(const GridGeometry& geometry, const Sector& sector) {
  std::array<Eigen::Vector2d, kArcCorners + 1> corners;
  corners[0] = sector.apex;
  const Eigen::Matrix2d turn = rotation((sector.to_angle - sector.from_angle) / (kArcCorners - 1));
  Eigen::Vector2d ray = sector.radius * rotation(sector.from_angle).col(0);
  for (std::size_t i = 1; i < corners.size(); ++i, ray = turn * ray) {
    corners[i] = sector.apex + ray;
  }
  for (Eigen::Vector2d& corner : corners) {
    corner = (corner - geometry.origin) / geometry.resolution - Eigen::Vector2d(0.5, 0.5);
  }
  return corners;
}

}  // namespace

SectorRows rows_of_sector(const GridGeometry& geometry, const Sector& sector) {
  const auto corners = corners_of_sector(geometry, sector);
  const auto [lowest, highest] = std::minmax_element(
      corners.begin(), corners.end(), [](const auto& one, const auto& other) { return one.y() < other.y(); });
  SectorRows rows;
  rows.first_row = std::max(0, ceil_to_int(lowest->y()));
  const int last_row = std::min(geometry.rows - 1, floor_to_int(highest->y()));
  rows.columns.assign(static_cast<std::size_t>(std::max(0, last_row - rows.first_row + 1)), {geometry.columns, -1});
  // a sector is convex, its corners counter-clockwise: edges that go up end its rows, those that go down begin them
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d& next = corners[(i + 1) % corners.size()];
    const bool goes_up = corners[i].y() < next.y();
    const Eigen::Vector2d& low = goes_up ? corners[i] : next;
    const Eigen::Vector2d& high = goes_up ? next : corners[i];
    const double slope = (high.x() - low.x()) / (high.y() - low.y());
    const int to = std::min(last_row, floor_to_int(high.y()));
    for (int row = std::max(rows.first_row, ceil_to_int(low.y())); row <= to && high.y() > low.y(); ++row) {
      const double x = low.x() + slope * (row - low.y());
      ColumnRange& columns = rows.columns[static_cast<std::size_t>(row - rows.first_row)];
      if (goes_up) {
        columns.last = std::min(geometry.columns - 1, floor_to_int(x));
      } else {
        columns.first = std::max(0, ceil_to_int(x));
      }
    }
  }
  return rows;
}

std::int8_t to_evidence(double log_odds) {
  return static_cast<std::int8_t>(std::clamp(std::lround(log_odds * kEvidencePerLogOdds), -127L, 127L));
}

FreeSpaceModel::FreeSpaceModel(const SonarModelParams& params) : params_(params) {
  if (!(params.minimum_range >= 0.0 && params.maximum_range > params.minimum_range)) {
    throw std::invalid_argument("sonar model: maximum_range must be above minimum_range");
  }
  if (!(params.half_angle > 0.0 && params.half_angle < 0.5 * kPi)) {
    throw std::invalid_argument("sonar model: half_angle must be between 0 and pi/2");
  }
}

void FreeSpaceModel::apply(const BeamReading& reading, const SliceRanges& limits, OccupancyGrid& grid) const {
  const double seen = reading.has_echo ? reading.range - params_.free_margin : params_.no_echo_range;
  const double length = std::min(seen, params_.free_range);
  if (length <= 0.0) {
    return;
  }
  // silence takes away what is believed to stand there; it does not prove that nothing does
  const double share = reading.has_echo ? 1.0 : params_.no_echo_share;
  const std::int8_t min = reading.has_echo ? to_evidence(params_.min_log_odds) : std::int8_t{0};
  const EvidenceVote cone{static_cast<std::int8_t>(-to_evidence(share * params_.free_log_odds)), min};
  const EvidenceVote core{static_cast<std::int8_t>(-to_evidence(share * params_.core_log_odds)), min};
  if (params_.kind == SonarModelKind::kLine) {
    const EvidenceVote both{static_cast<std::int8_t>(cone.change + core.change), min};
    lower_line(reading.world_from_sonar, std::min(length, limits[kSlices / 2]), both, grid);
    return;
  }
  lower_cone(reading.world_from_sonar, params_.half_angle, limits, length, cone, grid);
  lower_cone(reading.world_from_sonar, 0.5 * params_.half_angle, limits, std::min(length, params_.core_range), core,
             grid);
}

void FreeSpaceModel::lower_cone(const Pose2& apex, double half_angle, const SliceRanges& limits, double max,
                                EvidenceVote vote, OccupancyGrid& grid) const {
  if (vote.change == 0) {
    return;
  }
  const double slice = 2.0 * params_.half_angle / kSlices;
  const auto range_of = [&](int k) { return std::min(limits[static_cast<std::size_t>(k)], max); };
  // neighbouring slices of one range are drawn as one: mostly that is all of them
  for (int first = 0, last = 0; first < kSlices; first = last) {
    const double range = range_of(first);
    while (last < kSlices && range_of(last) == range) {
      ++last;
    }
    const double from = std::max(-half_angle, -params_.half_angle + first * slice);
    const double to = std::min(half_angle, -params_.half_angle + last * slice);
    if (to <= from || range <= 0.0) {
      continue;
    }
    const SectorRows rows = rows_of_sector(grid.geometry, {apex.position(), apex.theta + from, apex.theta + to, range});
    std::int8_t* cells = grid.evidence.data() + grid.geometry.index({0, rows.first_row});
    for (const ColumnRange columns : rows.columns) {
      for (int column = columns.first; column <= columns.last; ++column) {
        cells[column] = vote.of(cells[column]);
      }
      cells += grid.geometry.columns;
    }
  }
}

void FreeSpaceModel::lower_line(const Pose2& apex, double length, const EvidenceVote& vote, OccupancyGrid& grid) {
  // one step per cell of the longer axis (a digital differential analyser)
  const Eigen::Vector2d start = (apex.position() - grid.geometry.origin) / grid.geometry.resolution;
  const Eigen::Vector2d ray = length / grid.geometry.resolution * rotation(apex.theta).col(0);
  const int steps = std::max(1, ceil_to_int(ray.cwiseAbs().maxCoeff()));
  const Eigen::Vector2d step = ray / steps;
  for (int i = 0; i < steps; ++i) {
    const Cell cell{floor_to_int(start.x() + i * step.x()), floor_to_int(start.y() + i * step.y())};
    if (grid.geometry.contains(cell)) {
      std::int8_t& evidence = grid.evidence[grid.geometry.index(cell)];
      evidence = vote.of(evidence);
    }
  }
}

std::vector<ArcCell> cells_of_echo(const SonarModelParams& params, const GridGeometry& geometry,
                                   const BeamReading& reading, double widening) {
  const bool is_line = params.kind == SonarModelKind::kLine;
  // a quarter of a cell behind the reading: the surface is its front, not its middle
  const double range = reading.range + 0.25 * geometry.resolution;
  const double half = is_line ? 0.0 : params.half_angle + widening;
  const int steps = ceil_to_int(half * range / (0.5 * geometry.resolution));  // from the axis to each border
  const Eigen::Matrix2d turn = rotation(steps == 0 ? 0.0 : half / steps);
  Eigen::Vector2d ray = range * rotation(reading.world_from_sonar.theta - half).col(0);
  std::vector<ArcCell> cells;
  cells.reserve(static_cast<std::size_t>(2 * steps + 1));
  for (int k = -steps; k <= steps; ++k, ray = turn * ray) {
    const double off_axis = steps == 0 ? 0.0 : half * k / steps;
    const Cell cell = geometry.cell_at(reading.world_from_sonar.position() + ray);
    const double share = std::min(1.0, std::abs(off_axis) / params.half_angle);
    const double weight = 1.0 - (1.0 - params.edge_weight) * share * share;
    if (!cells.empty() && cells.back().cell == cell) {
      cells.back().weight = std::max(cells.back().weight, weight);
    } else if (geometry.contains(cell)) {
      const int slice = static_cast<int>((off_axis / params.half_angle + 1.0) / 2.0 * kSlices);
      cells.push_back({cell, std::clamp(slice, 0, kSlices - 1), weight});
    }
  }
  return cells;
}

}  // namespace luminav
