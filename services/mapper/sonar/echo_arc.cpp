#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "services/common/geometry/rounding.hpp"
#include "services/common/geometry/vector_clones.hpp"
#include "services/mapper/sonar/sonar_model.hpp"
#include "services/mapper/sonar/turning_direction.hpp"

namespace luminav {
namespace {

constexpr int kArcChunk = 64;  // samples at a time

struct ArcSampling {
  double apex_x;  // [cells]
  double apex_y;
  double range;        // [cells]
  double half;         // [rad] from the axis to the last sample
  double half_angle;   // [rad] of the cone
  double edge_weight;  // at its border
  int steps;           // from the axis to the last sample
};

struct ArcPlaces {
  std::array<double, kArcChunk> x;  // [cells]
  std::array<double, kArcChunk> y;
};

struct ArcShares {
  std::array<double, kArcChunk> weight;
  std::array<int, kArcChunk> slice;
};

constexpr int kAtOnce = 4;
using Doubles = double __attribute__((vector_size(kAtOnce * sizeof(double))));
using Ints = int __attribute__((vector_size(kAtOnce * sizeof(int))));
static_assert(kArcChunk % kAtOnce == 0);

/// The directions of samples that follow each other, turned all at once: each by itself would wait for the one before.
struct Directions {
  explicit Directions(TurningDirection direction) {
    for (int j = 0; j < kAtOnce; ++j, direction.advance()) {
      x[j] = direction.x();
      y[j] = direction.y();
    }
    static_assert(kAtOnce == 4);
    direction.double_turn();
    direction.double_turn();
    turn_x = direction.turn_x();
    turn_y = direction.turn_y();
  }
  void advance() {
    const Doubles before = x;
    x = before * turn_x - y * turn_y;
    y = before * turn_y + y * turn_x;
  }

  Doubles x;
  Doubles y;
  double turn_x;  // of so many samples
  double turn_y;
};

/// The next samples, and up to three more.
inline void place_samples(const ArcSampling& arc, int count, Directions& directions, ArcPlaces& places) {
  for (int k = 0; k < count; k += kAtOnce, directions.advance()) {
    const auto i = static_cast<std::size_t>(k);
    const Doubles x = arc.apex_x + arc.range * directions.x;
    const Doubles y = arc.apex_y + arc.range * directions.y;
    std::memcpy(&places.x[i], &x, sizeof(x));
    std::memcpy(&places.y[i], &y, sizeof(y));
  }
}

/// Samples `from` on, counted from the axis, and up to three more.
inline void share_samples(const ArcSampling& arc, int from, int count, ArcShares& shares) {
  for (int k = 0; k < count; k += kAtOnce) {
    const auto i = static_cast<std::size_t>(k);
    const Ints number = Ints{0, 1, 2, 3} + (from + k);
    const Doubles offset = arc.half * __builtin_convertvector(number, Doubles) / static_cast<double>(arc.steps);
    const Doubles beside = (offset < 0.0 ? -offset : offset) / arc.half_angle;
    const Doubles border = Doubles{} + 1.0;
    const Doubles share = beside < border ? beside : border;
    const Doubles weight = 1.0 - (1.0 - arc.edge_weight) * share * share;
    std::memcpy(&shares.weight[i], &weight, sizeof(weight));
    const Doubles across = (offset + arc.half_angle) / (2.0 * arc.half_angle) * static_cast<double>(kSlices);
    const Ints cut = __builtin_convertvector(across, Ints);
    const Ints first{};
    const Ints last = first + (kSlices - 1);
    const Ints from_first = cut > first ? cut : first;
    const Ints slice = from_first < last ? from_first : last;
    std::memcpy(&shares.slice[i], &slice, sizeof(slice));
  }
}

/// Shares of all samples of an arc of at most kArcChunk: they depend on how many these are, and else on the cone. They
/// are kept as long as one cone is asked for, which saves three divisions a sample.
const ArcShares& shares_of_whole_arc(const ArcSampling& arc) {
  constexpr std::size_t kMaxSteps = (kArcChunk - 1) / 2;
  struct Kept {
    double half = 0.0;
    double half_angle = 0.0;
    double edge_weight = 0.0;
    std::array<bool, kMaxSteps + 1> is_known{};
    std::array<ArcShares, kMaxSteps + 1> shares{};
  };
  constinit static thread_local Kept kept{};
  if (kept.half != arc.half || kept.half_angle != arc.half_angle || kept.edge_weight != arc.edge_weight) {
    kept.half = arc.half;
    kept.half_angle = arc.half_angle;
    kept.edge_weight = arc.edge_weight;
    kept.is_known.fill(false);
  }
  const auto steps = static_cast<std::size_t>(arc.steps);
  if (!kept.is_known[steps]) {
    share_samples(arc, -arc.steps, 2 * arc.steps + 1, kept.shares[steps]);
    kept.is_known[steps] = true;
  }
  return kept.shares[steps];
}

/// The cells of a whole arc of at most kArcChunk samples within the grid: each cell once, with the slice of its first
/// sample, and the weight of the one nearest to the axis, which is the highest. In loops that wait for nothing: nobody
/// guesses which sample is the first of its cell.
LUMINAV_VECTOR_CLONES
void cells_of_whole_arc(const ArcSampling& arc, const TurningDirection& direction, const ArcShares& shares,
                        std::vector<ArcCell>& cells) {
  const auto steps = static_cast<std::size_t>(arc.steps);
  const std::size_t count = 2 * steps + 1;
  ArcPlaces places;
  Directions directions(direction);
  place_samples(arc, static_cast<int>(count), directions, places);
  std::array<int, kArcChunk> column;
  std::array<int, kArcChunk> row;
  for (std::size_t i = 0; i < count; i += kAtOnce) {
    Doubles x;
    Doubles y;
    std::memcpy(&x, &places.x[i], sizeof(x));
    std::memcpy(&y, &places.y[i], sizeof(y));
    const Ints columns = __builtin_convertvector(x, Ints);
    const Ints rows = __builtin_convertvector(y, Ints);
    std::memcpy(&column[i], &columns, sizeof(columns));
    std::memcpy(&row[i], &rows, sizeof(rows));
  }
  std::array<std::uint32_t, kArcChunk> place;  // among the cells, of each sample
  place[0] = 0;
  for (std::size_t i = 1; i < count; ++i) {
    place[i] = place[i - 1] + (((column[i] ^ column[i - 1]) | (row[i] ^ row[i - 1])) != 0 ? 1 : 0);
  }
  cells.resize(place[count - 1] + 1);
  // where several samples share a cell the one that is written last stays
  for (std::size_t i = count; i-- > 0;) {
    cells[place[i]] = {{column[i], row[i]}, shares.slice[i], shares.weight[i]};
  }
  for (std::size_t i = 0; i <= steps; ++i) {
    cells[place[i]].weight = shares.weight[i];
  }
}

}  // namespace

void cells_of_echo(const SonarModelParams& params, const GridGeometry& geometry, const BeamReading& reading,
                   double widening, std::vector<ArcCell>& cells) {
  cells.clear();
  const bool is_line = params.kind == SonarModelKind::kLine;
  // a quarter of a cell behind the reading: the surface is its front, not its middle
  const double range = reading.range + 0.25 * geometry.resolution;
  const Eigen::Vector2d apex = (reading.world_from_sonar.position() - geometry.origin) / geometry.resolution;
  const double in_cells = range / geometry.resolution;
  const auto is_inside = [&](const Eigen::Vector2d& at) {
    return at.x() >= 0.0 && at.y() >= 0.0 && at.x() < geometry.columns && at.y() < geometry.rows;
  };
  if (is_line) {
    const Eigen::Vector2d at = apex + in_cells * unit_vector(reading.world_from_sonar.theta);
    if (is_inside(at)) {
      cells.push_back({{static_cast<int>(at.x()), static_cast<int>(at.y())}, kSlices / 2, 1.0});
    }
    return;
  }
  const double half = params.half_angle + widening;
  const int steps = std::max(1, ceil_to_int(half * range / (0.5 * geometry.resolution)));
  const TurningDirection direction(reading.world_from_sonar.theta - half, half / steps);
  const ArcSampling sampling{apex.x(), apex.y(), in_cells, half, params.half_angle, params.edge_weight, steps};
  const auto sample_count = 2 * static_cast<std::size_t>(steps) + 1;
  // the whole circle within the grid: no sample needs to be asked
  const double around = in_cells + 1.0;
  const bool are_inside =
      is_inside(apex - Eigen::Vector2d(around, around)) && is_inside(apex + Eigen::Vector2d(around, around));
  if (are_inside && sample_count <= kArcChunk && params.edge_weight <= 1.0) {
    cells_of_whole_arc(sampling, direction, shares_of_whole_arc(sampling), cells);
    return;
  }
  cells.resize(sample_count);
  ArcCell* last = cells.data() - 1;
  ArcCell cell{{-1, -1}, 0, 0.0};
  const auto take = [&](const Cell& at, int slice, double weight) {
    const bool is_new = ((at.column ^ cell.cell.column) | (at.row ^ cell.cell.row)) != 0;
    last += is_new ? 1 : 0;
    cell.cell = at;
    cell.slice = is_new ? slice : cell.slice;
    cell.weight = is_new ? weight : std::max(cell.weight, weight);
    *last = cell;
  };
  ArcPlaces places;
  ArcShares shares;
  Directions directions(direction);
  for (int from = -steps; from <= steps; from += kArcChunk) {
    const int count = std::min(kArcChunk, steps - from + 1);
    place_samples(sampling, count, directions, places);
    share_samples(sampling, from, count, shares);
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
      if (is_inside({places.x[k], places.y[k]})) {
        take({static_cast<int>(places.x[k]), static_cast<int>(places.y[k])}, shares.slice[k], shares.weight[k]);
      }
    }
  }
  cells.resize(static_cast<std::size_t>(last + 1 - cells.data()));
}

}  // namespace luminav
