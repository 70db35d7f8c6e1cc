#include "services/mapper/sonar/sonar_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "services/common/geometry/rounding.hpp"
#include "services/common/geometry/vector_clones.hpp"
#include "services/mapper/sonar/turning_direction.hpp"

namespace luminav {
namespace {

/// Indices of cells along a line from `start` by `step`, both in cells, in a grid of so many columns.
LUMINAV_VECTOR_CLONES
void index_line(double start_x, double start_y, double step_x, double step_y, int columns, int from, int count,
                int* indices) {
  for (int k = 0; k < count; ++k) {
    const double x = start_x + (from + k) * step_x;
    const double y = start_y + (from + k) * step_y;
    indices[k] = static_cast<int>(y) * columns + static_cast<int>(x);
  }
}

}  // namespace

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
  // silence takes away what is believed to stand there; it does not prove that nothing does
  echo_ = votes_of(1.0, to_evidence(params_.min_log_odds));
  silence_ = votes_of(params_.no_echo_share, 0);
}

FreeSpaceModel::Votes FreeSpaceModel::votes_of(double share, std::int8_t min) const {
  Votes votes;
  votes.cone = {static_cast<std::int8_t>(-to_evidence(share * params_.free_log_odds)), min};
  votes.core = {static_cast<std::int8_t>(-to_evidence(share * params_.core_log_odds)), min};
  const EvidenceVote both{static_cast<std::int8_t>(votes.cone.change + votes.core.change), min};
  for (int before = -128; before < 128; ++before) {
    votes.of_line[static_cast<std::uint8_t>(before)] = both.of(static_cast<std::int8_t>(before));
  }
  return votes;
}

void FreeSpaceModel::apply(const BeamReading& reading, const SliceRanges& limits, OccupancyGrid& grid) {
  const double seen = reading.has_echo ? reading.range - params_.free_margin : params_.no_echo_range;
  const double length = std::min(seen, params_.free_range);
  if (length <= 0.0) {
    return;
  }
  const Votes& votes = reading.has_echo ? echo_ : silence_;
  if (params_.kind == SonarModelKind::kLine) {
    const double limit = std::min(length, limits[kSlices / 2]);
    line(grid.geometry, reading.world_from_sonar, limit, votes.of_line, grid.evidence);
    return;
  }
  sector(grid.geometry, reading.world_from_sonar, params_.half_angle, limits, length, votes.cone, grid.evidence);
  sector(grid.geometry, reading.world_from_sonar, 0.5 * params_.half_angle, limits,
         std::min(length, params_.core_range), votes.core, grid.evidence);
}

void FreeSpaceModel::sector(const GridGeometry& geometry, const Pose2& apex, double half_angle,
                            const SliceRanges& ranges, double max, const EvidenceVote& vote,
                            std::vector<std::int8_t>& evidence) {
  if (vote.change == 0) {
    return;
  }
  const double slice = 2.0 * params_.half_angle / kSlices;
  SliceRanges clipped;
  bool are_equal = true;
  for (std::size_t k = 0; k < clipped.size(); ++k) {
    clipped[k] = std::min(ranges[k], max);
    are_equal = are_equal & (clipped[k] == clipped[0]);
  }
  // neighbouring slices of one range are drawn as one: mostly that is all of them
  for (int first = 0; first < kSlices;) {
    const double range = clipped[static_cast<std::size_t>(first)];
    int last = are_equal ? kSlices : first + 1;
    while (last < kSlices && clipped[static_cast<std::size_t>(last)] == range) {
      ++last;
    }
    const double from = std::max(-half_angle, -params_.half_angle + first * slice);
    const double to = std::min(half_angle, -params_.half_angle + last * slice);
    first = last;
    if (to > from && range > 0.0) {
      lower_sector(geometry, apex.position(), apex.theta + from, apex.theta + to, range, vote, spans_, evidence);
    }
  }
}

void FreeSpaceModel::line(const GridGeometry& geometry, const Pose2& apex, double length,
                          const std::array<std::int8_t, 256>& table, std::vector<std::int8_t>& evidence) {
  // one step per cell of the longer axis (a digital differential analyser)
  const Eigen::Vector2d start = (apex.position() - geometry.origin) / geometry.resolution;
  const Eigen::Vector2d ray = length / geometry.resolution * unit_vector(apex.theta);
  const int steps = std::max(1, ceil_to_int(ray.cwiseAbs().maxCoeff()));
  const Eigen::Vector2d step = ray / steps;
  const Eigen::Vector2d end = start + ray;
  const bool is_inside = start.minCoeff() >= 0.0 && end.minCoeff() >= 0.0 &&
                         std::max(start.x(), end.x()) < geometry.columns &&
                         std::max(start.y(), end.y()) < geometry.rows;
  std::int8_t* const cells = evidence.data();
  if (is_inside) {
    constexpr int kChunk = 64;
    std::array<int, kChunk> indices;
    for (int i = 0; i < steps; i += kChunk) {
      const int count = std::min(kChunk, steps - i);
      index_line(start.x(), start.y(), step.x(), step.y(), geometry.columns, i, count, indices.data());
      for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
        std::int8_t& cell = cells[indices[k]];
        cell = table[static_cast<std::uint8_t>(cell)];
      }
    }
    return;
  }
  for (int i = 0; i < steps; ++i) {
    const double x = start.x() + i * step.x();
    const double y = start.y() + i * step.y();
    if (x >= 0.0 && y >= 0.0 && x < geometry.columns && y < geometry.rows) {
      std::int8_t& cell = cells[geometry.index({static_cast<int>(x), static_cast<int>(y)})];
      cell = table[static_cast<std::uint8_t>(cell)];
    }
  }
}

}  // namespace luminav
