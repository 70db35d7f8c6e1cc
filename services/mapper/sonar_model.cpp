#include "services/mapper/sonar_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "services/common/geometry/rounding.hpp"

namespace luminav {
namespace {

constexpr int kArcCorners = 5;  // the chord stays within 0.2 % of the arc

constexpr std::size_t kLanes = 16;  // cells at a time
using Lanes = std::int8_t __attribute__((vector_size(kLanes)));

std::int8_t lowered(std::int8_t cell, std::int8_t vote, std::int8_t least) {
  const int sum = cell + vote;
  return static_cast<std::int8_t>(sum < least ? std::min<int>(cell, least) : sum);
}

/// Takes a vote from `count` cells, not below `least`; what lies below already stays. `end` is where the grid ends.
void lower(std::int8_t* cells, std::ptrdiff_t count, std::int8_t vote, std::int8_t least, const std::int8_t* end) {
  constexpr Lanes kLane = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  const auto lanes = static_cast<std::ptrdiff_t>(kLanes);
  const Lanes votes = Lanes{} + vote;
  const Lanes floor = Lanes{} + least;
  const Lanes room = Lanes{} + static_cast<std::int8_t>(least - vote);  // the sum fits from here on
  for (; count > 0 && cells + lanes <= end; cells += lanes, count -= lanes) {
    Lanes before;
    std::memcpy(&before, cells, kLanes);
    const Lanes kept = before < floor ? before : floor;
    const Lanes after = before >= room ? before + votes : kept;
    const Lanes wanted = Lanes{} + static_cast<std::int8_t>(std::min(count, lanes));
    const Lanes result = kLane < wanted ? after : before;
    std::memcpy(cells, &result, kLanes);
  }
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    cells[i] = lowered(cells[i], vote, least);
  }
}

/// Turns by one step after the other without asking for sines again.
class Direction {
 public:
  Direction(double angle, double step)
      : way_(std::cos(angle), std::sin(angle)), turn_(std::cos(step), std::sin(step)) {}
  [[nodiscard]] const Eigen::Vector2d& get() const { return way_; }
  void advance() {
    way_ = Eigen::Vector2d(way_.x() * turn_.x() - way_.y() * turn_.y(), way_.x() * turn_.y() + way_.y() * turn_.x());
  }

 private:
  Eigen::Vector2d way_;
  Eigen::Vector2d turn_;
};

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
  Direction direction(from_angle, (to_angle - from_angle) / (kArcCorners - 1));
  for (std::size_t i = 1; i <= kArcCorners; ++i) {
    corners[i] = to_cells(apex + radius * direction.get());
    direction.advance();
  }
  double bottom = corners[0].y();
  double top = corners[0].y();
  for (const auto& corner : corners) {
    bottom = std::min(bottom, corner.y());
    top = std::max(top, corner.y());
  }
  const int first_row = std::max(0, ceil_to_int(std::clamp(bottom, -1.0, 1e6)));
  const int last_row = std::min(geometry.rows - 1, floor_to_int(std::clamp(top, -1.0, 1e6)));
  const auto rows = static_cast<std::size_t>(std::max(0, last_row - first_row + 1));
  spans.first_row = first_row;
  spans.first.assign(rows, geometry.columns);
  spans.last.assign(rows, -1);
  if (rows == 0) {
    return;
  }
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
    const int from = std::max(first_row, ceil_to_int(std::clamp(low.y(), -1.0, 1e6)));
    const int to = std::min(last_row, floor_to_int(std::clamp(high.y(), -1.0, 1e6)));
    const double far = geometry.columns + 1.0;
    int* const first = spans.first.data() - first_row;
    int* const last = spans.last.data() - first_row;
    for (int row = from; row <= to; ++row) {
      const double x = std::min(std::max(low.x() + slope * (row - low.y()), -2.0), far);
      first[row] = std::min(first[row], std::max(0, ceil_to_int(x)));
      last[row] = std::max(last[row], std::min(geometry.columns - 1, floor_to_int(x)));
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
        lower(evidence.data() + start, count, vote, least_, evidence.data() + evidence.size());
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
  const Eigen::Vector2d step = way / steps;
  const Eigen::Vector2d end = start + way;
  const bool is_inside = start.minCoeff() >= 0.0 && end.minCoeff() >= 0.0 &&
                         std::max(start.x(), end.x()) < geometry.columns &&
                         std::max(start.y(), end.y()) < geometry.rows;
  for (int i = 0; i < steps; ++i) {
    const double x = start.x() + i * step.x();
    const double y = start.y() + i * step.y();
    if (is_inside || (x >= 0.0 && y >= 0.0 && x < geometry.columns && y < geometry.rows)) {
      std::int8_t& cell = evidence[geometry.index({static_cast<int>(x), static_cast<int>(y)})];
      cell = lowered(cell, vote, least_);
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
  Direction direction(reading.world_from_sonar.theta - half, half / steps);
  const Eigen::Vector2d apex = (reading.world_from_sonar.position() - geometry.origin) / geometry.resolution;
  const double in_cells = range / geometry.resolution;
  for (int i = is_line ? 0 : -steps; i <= (is_line ? 0 : steps); ++i, direction.advance()) {
    const double offset = half * i / steps;
    const Eigen::Vector2d at = apex + in_cells * direction.get();
    if (!(at.x() >= 0.0 && at.y() >= 0.0 && at.x() < geometry.columns && at.y() < geometry.rows)) {
      continue;
    }
    const Cell cell{static_cast<int>(at.x()), static_cast<int>(at.y())};
    const double share = std::min(1.0, std::abs(offset) / params.half_angle);
    const double weight = 1.0 - (1.0 - params.edge_weight) * share * share;
    const double in_slices = (offset + params.half_angle) / (2.0 * params.half_angle) * kSlices;
    const int slice = std::clamp(floor_to_int(in_slices), 0, kSlices - 1);
    if (!cells.empty() && cells.back().cell == cell) {
      cells.back().weight = std::max(cells.back().weight, weight);
    } else {
      cells.push_back({cell, slice, weight});
    }
  }
}

}  // namespace luminav
