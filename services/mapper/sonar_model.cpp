#include "services/mapper/sonar_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace luminav {
namespace {

constexpr int kArcCorners = 5;  // the chord stays within 0.2 % of the arc

/// Adds with the clamps of int8 kept away by the model's own: plain loop that compiles to saturating SIMD.
void add_clamped(std::int8_t* cells, int count, std::int8_t vote, std::int8_t least) {
  for (int i = 0; i < count; ++i) {
    const int sum = cells[i] + vote;
    cells[i] = static_cast<std::int8_t>(sum < least ? std::min<int>(cells[i], least) : sum);
  }
}

}  // namespace

std::int8_t to_evidence(double log_odds) {
  return static_cast<std::int8_t>(std::clamp(std::lround(log_odds * kEvidencePerLogOdds), -127L, 127L));
}

void fill_sector(const GridGeometry& geometry, const Eigen::Vector2d& apex, double from_angle, double to_angle,
                 double radius, CellSpans& spans) {
  // corners in cells, so that the centre of cell (c, r) is (c, r)
  std::array<Eigen::Vector2d, kArcCorners + 1> corners;
  const auto to_cells = [&](const Eigen::Vector2d& p) -> Eigen::Vector2d {
    return (p - geometry.origin) / geometry.resolution - Eigen::Vector2d(0.5, 0.5);
  };
  corners[0] = to_cells(apex);
  for (int i = 0; i < kArcCorners; ++i) {
    const double angle = from_angle + (to_angle - from_angle) * i / (kArcCorners - 1);
    corners[static_cast<std::size_t>(i) + 1] =
        to_cells(apex + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  double bottom = corners[0].y();
  double top = corners[0].y();
  for (const auto& corner : corners) {
    bottom = std::min(bottom, corner.y());
    top = std::max(top, corner.y());
  }
  const int first_row = std::max(0, static_cast<int>(std::ceil(std::max(bottom, -1.0))));
  const int last_row = std::min(geometry.rows - 1, static_cast<int>(std::floor(std::min(top, 1e6))));
  const auto rows = static_cast<std::size_t>(std::max(0, last_row - first_row + 1));
  spans.first_row = first_row;
  spans.first.assign(rows, geometry.columns);
  spans.last.assign(rows, -1);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d& a = corners[i];
    const Eigen::Vector2d& b = corners[(i + 1) % corners.size()];
    const Eigen::Vector2d& low = a.y() < b.y() ? a : b;
    const Eigen::Vector2d& high = a.y() < b.y() ? b : a;
    const double rise = high.y() - low.y();
    if (rise <= 0.0) {
      continue;
    }
    const double slope = (high.x() - low.x()) / rise;
    const int from = std::max(first_row, static_cast<int>(std::ceil(low.y())));
    const int to = std::min(last_row, static_cast<int>(std::floor(high.y())));
    for (int row = from; row <= to; ++row) {
      const double x = std::clamp(low.x() + slope * (row - low.y()), -2.0, geometry.columns + 1.0);
      const auto k = static_cast<std::size_t>(row - first_row);
      spans.first[k] = std::min(spans.first[k], std::max(0, static_cast<int>(std::ceil(x))));
      spans.last[k] = std::max(spans.last[k], std::min(geometry.columns - 1, static_cast<int>(std::floor(x))));
    }
  }
}

FreeSpaceModel::FreeSpaceModel(const SonarModelParams& params) : params_(params) {
  if (!(params.minimum_range >= 0.0 && params.maximum_range > params.minimum_range)) {
    throw std::invalid_argument("sonar model: maximum_range must be above minimum_range");
  }
  if (!(params.half_angle > 0.0 && params.half_angle < 0.5 * kPi)) {
    throw std::invalid_argument("sonar model: half_angle must be between 0 and pi/2");
  }
}

void FreeSpaceModel::apply(const BeamReading& reading, const SliceRanges& limits, OccupancyGrid& grid) {
  const double seen = reading.has_echo ? reading.range - params_.free_margin : params_.no_echo_range;
  const double length = std::min(seen, params_.free_range);
  if (length <= 0.0) {
    return;
  }
  const double share = reading.has_echo ? 1.0 : params_.no_echo_share;
  // silence takes away what is believed to stand there; it does not prove that nothing does
  least_ = reading.has_echo ? to_evidence(params_.least_log_odds) : std::int8_t{0};
  const auto vote = static_cast<std::int8_t>(-to_evidence(share * params_.free_log_odds));
  const auto core = static_cast<std::int8_t>(-to_evidence(share * params_.core_log_odds));
  if (params_.kind == SonarModelKind::kLine) {
    const double limit = std::min(length, limits[kSlices / 2]);
    line(grid.geometry, reading.world_from_sonar, limit, static_cast<std::int8_t>(vote + core), grid.evidence);
    return;
  }
  sector(grid.geometry, reading.world_from_sonar, params_.half_angle, limits, length, vote, grid.evidence);
  sector(grid.geometry, reading.world_from_sonar, 0.5 * params_.half_angle, limits,
         std::min(length, params_.core_range), core, grid.evidence);
}

void FreeSpaceModel::sector(const GridGeometry& geometry, const Pose2& apex, double half_angle,
                            const SliceRanges& ranges, double most, std::int8_t vote,
                            std::vector<std::int8_t>& evidence) {
  if (vote == 0) {
    return;
  }
  const double slice = 2.0 * params_.half_angle / kSlices;
  const auto range_of = [&](int k) { return std::min(ranges[static_cast<std::size_t>(k)], most); };
  // neighbouring slices of one range are drawn as one: mostly that is all of them
  for (int first = 0; first < kSlices;) {
    int last = first + 1;
    while (last < kSlices && range_of(last) == range_of(first)) {
      ++last;
    }
    const double from = std::max(-half_angle, -params_.half_angle + first * slice);
    const double to = std::min(half_angle, -params_.half_angle + last * slice);
    const double range = range_of(first);
    first = last;
    if (to <= from || range <= 0.0) {
      continue;
    }
    fill_sector(geometry, apex.position(), apex.theta + from, apex.theta + to, range, spans_);
    for (std::size_t k = 0; k < spans_.first.size(); ++k) {
      const int count = spans_.last[k] - spans_.first[k] + 1;
      if (count > 0) {
        const std::size_t start = geometry.index({spans_.first[k], spans_.first_row + static_cast<int>(k)});
        add_clamped(evidence.data() + start, count, vote, least_);
      }
    }
  }
}

void FreeSpaceModel::line(const GridGeometry& geometry, const Pose2& apex, double length, std::int8_t vote,
                          std::vector<std::int8_t>& evidence) {
  // one step per cell of the longer axis (a digital differential analyser)
  const Eigen::Vector2d start = (apex.position() - geometry.origin) / geometry.resolution;
  const Eigen::Vector2d way =
      length / geometry.resolution * Eigen::Vector2d(std::cos(apex.theta), std::sin(apex.theta));
  const int steps = std::max(1, static_cast<int>(std::ceil(way.cwiseAbs().maxCoeff())));
  for (int i = 0; i < steps; ++i) {
    const Eigen::Vector2d p = start + way * (static_cast<double>(i) / steps);
    const Cell cell{static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y()))};
    if (geometry.contains(cell)) {
      add_clamped(evidence.data() + geometry.index(cell), 1, vote, least_);
    }
  }
}

void cells_of_echo(const SonarModelParams& params, const GridGeometry& geometry, const BeamReading& reading,
                   double widening, std::vector<ArcCell>& cells) {
  cells.clear();
  // a quarter of a cell behind the reading: the surface is its front, not its middle
  const double range = reading.range + 0.25 * geometry.resolution;
  const bool is_line = params.kind == SonarModelKind::kLine;
  const double half = is_line ? 0.0 : params.half_angle + widening;
  const int steps = std::max(1, static_cast<int>(std::ceil(half * range / (0.5 * geometry.resolution))));
  for (int i = is_line ? 0 : -steps; i <= (is_line ? 0 : steps); ++i) {
    const double offset = half * i / steps;
    const double angle = reading.world_from_sonar.theta + offset;
    const Cell cell = geometry.cell_at(reading.world_from_sonar.position() +
                                       range * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    const double share = std::min(1.0, std::abs(offset) / params.half_angle);
    const double weight = 1.0 - (1.0 - params.edge_weight) * share * share;
    const double in_slices = (offset + params.half_angle) / (2.0 * params.half_angle) * kSlices;
    const int slice = std::clamp(static_cast<int>(std::floor(in_slices)), 0, kSlices - 1);
    if (!geometry.contains(cell)) {
      continue;
    }
    if (!cells.empty() && cells.back().cell == cell) {
      cells.back().weight = std::max(cells.back().weight, weight);
    } else {
      cells.push_back({cell, slice, weight});
    }
  }
}

}  // namespace luminav
