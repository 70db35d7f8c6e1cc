#include "services/mapper/sonar_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <tuple>

#include "services/common/geometry/rounding.hpp"
#include "services/common/geometry/vector_clones.hpp"

namespace luminav {
namespace {

constexpr int kArcCorners = 5;  // the chord stays within 0.2 % of the arc

constexpr std::size_t kLanes = 16;  // cells at a time
using Lanes = std::int8_t __attribute__((vector_size(kLanes)));

std::int8_t lowered(std::int8_t cell, std::int8_t vote, std::int8_t least) {
  // no branch: half of the cells have come to the least
  return static_cast<std::int8_t>(std::max<int>(cell + vote, std::min<int>(cell, least)));
}

/// Takes a vote from `count` cells, not below `least`; what lies below already stays. `end` is where the grid ends.
inline void lower(std::int8_t* cells, std::ptrdiff_t count, std::int8_t vote, std::int8_t least,
                  const std::int8_t* end) {
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

/// The line x = low_x + slope * (y - low_y), in cells.
struct Edge {
  double low_x;
  double low_y;
  double slope;
};

/// Widens the spans of rows [from, to] to the cells beside an edge; the same in vectors as one by one.
LUMINAV_VECTOR_CLONES
void cut_rows(const Edge& edge, int from, int to, int columns, int* first, int* last) {
  constexpr int kRows = 4;
  using Doubles = double __attribute__((vector_size(kRows * sizeof(double))));
  using Longs = std::int64_t __attribute__((vector_size(kRows * sizeof(std::int64_t))));
  using Ints = int __attribute__((vector_size(kRows * sizeof(int))));
  const double far = columns + 1.0;
  int row = from;
  const Doubles farthest = Doubles{} + far;
  const Doubles nearest = Doubles{} - 2.0;
  const Ints zero{};
  const Ints last_column = zero + (columns - 1);
  while (row <= to && to - from >= kRows - 1) {
    row = std::min(row, to - kRows + 1);  // some rows of the last vector are cut twice: that changes nothing
    const Ints rows = zero + row + Ints{0, 1, 2, 3};
    Doubles x = edge.low_x + edge.slope * (__builtin_convertvector(rows, Doubles) - edge.low_y);
    x = x < nearest ? nearest : x;
    x = x < farthest ? x : farthest;
    const Ints cut = __builtin_convertvector(x, Ints);
    const Doubles whole = __builtin_convertvector(cut, Doubles);
    // of a comparison that holds all bits are set: -1
    Ints up = cut - __builtin_convertvector(static_cast<Longs>(x > whole), Ints);
    Ints down = cut + __builtin_convertvector(static_cast<Longs>(x < whole), Ints);
    up = up > zero ? up : zero;
    down = down < last_column ? down : last_column;
    Ints before;
    std::memcpy(&before, first + row, sizeof(before));
    up = up < before ? up : before;
    std::memcpy(first + row, &up, sizeof(up));
    std::memcpy(&before, last + row, sizeof(before));
    down = down > before ? down : before;
    std::memcpy(last + row, &down, sizeof(down));
    row += kRows;
  }
  for (; row <= to; ++row) {
    const double x = std::min(std::max(edge.low_x + edge.slope * (row - edge.low_y), -2.0), far);
    first[row] = std::min(first[row], std::max(0, ceil_to_int(x)));
    last[row] = std::max(last[row], std::min(columns - 1, floor_to_int(x)));
  }
}

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

struct ArcSamples {
  std::array<double, kArcChunk> x;  // unit vector before, place [cells] afterwards
  std::array<double, kArcChunk> y;
  std::array<double, kArcChunk> weight;
  std::array<int, kArcChunk> slice;
  std::array<int, kArcChunk> column;  // of places within the grid
  std::array<int, kArcChunk> row;
};

/// Samples `from` on, counted from the axis; of those within the grid their cells, too.
LUMINAV_VECTOR_CLONES
void sample_arc(const ArcSampling& arc, int from, int count, bool are_inside, ArcSamples& samples) {
  for (int k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    samples.x[i] = arc.apex_x + arc.range * samples.x[i];
    samples.y[i] = arc.apex_y + arc.range * samples.y[i];
    const double offset = arc.half * (from + k) / arc.steps;
    const double beside = std::abs(offset) / arc.half_angle;
    const double share = beside < 1.0 ? beside : 1.0;
    samples.weight[i] = 1.0 - (1.0 - arc.edge_weight) * share * share;
    const int slice = static_cast<int>((offset + arc.half_angle) / (2.0 * arc.half_angle) * kSlices);
    samples.slice[i] = std::min(std::max(slice, 0), kSlices - 1);
  }
  for (int k = 0; are_inside && k < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    samples.column[i] = static_cast<int>(samples.x[i]);
    samples.row[i] = static_cast<int>(samples.y[i]);
  }
}

/// Turns by one step after the other without asking for sines again.
class Direction {
 public:
  Direction(double angle, double step)
      : x_(std::cos(angle)), y_(std::sin(angle)), turn_x_(std::cos(step)), turn_y_(std::sin(step)) {}
  [[nodiscard]] double x() const { return x_; }
  [[nodiscard]] double y() const { return y_; }
  void advance() {
    const double x = x_ * turn_x_ - y_ * turn_y_;
    y_ = x_ * turn_y_ + y_ * turn_x_;
    x_ = x;
  }

 private:
  double x_;
  double y_;
  double turn_x_;
  double turn_y_;
};

}  // namespace

std::int8_t to_evidence(double log_odds) {
  return static_cast<std::int8_t>(std::clamp(std::lround(log_odds * kEvidencePerLogOdds), -127L, 127L));
}

namespace {

using Corners = std::array<Eigen::Vector2d, kArcCorners + 1>;

/// Apex and corners of a sector [cells], counter-clockwise, so that the centre of cell (c, r) is (c, r).
Corners corners_of_sector(const GridGeometry& geometry, const Eigen::Vector2d& apex, double from_angle, double to_angle,
                          double radius) {
  Corners corners;
  const auto to_cells = [&](const Eigen::Vector2d& p) -> Eigen::Vector2d {
    return (p - geometry.origin) / geometry.resolution - Eigen::Vector2d(0.5, 0.5);
  };
  corners[0] = to_cells(apex);
  Direction direction(from_angle, (to_angle - from_angle) / (kArcCorners - 1));
  for (std::size_t i = 1; i <= kArcCorners; ++i) {
    corners[i] = to_cells(apex + radius * Eigen::Vector2d(direction.x(), direction.y()));
    direction.advance();
  }
  return corners;
}

/// Rows that a sector reaches into, clipped to the grid.
struct RowRange {
  int first = 0;
  int last = -1;
};
RowRange rows_of(const Corners& corners, int rows) {
  double bottom = corners[0].y();
  double top = corners[0].y();
  for (const auto& corner : corners) {
    bottom = std::min(bottom, corner.y());
    top = std::max(top, corner.y());
  }
  return {std::max(0, ceil_to_int(std::clamp(bottom, -1.0, 1e6))),
          std::min(rows - 1, floor_to_int(std::clamp(top, -1.0, 1e6)))};
}

void cut_sector(const Corners& corners, const RowRange& rows, int columns, CellSpans& spans) {
  const auto count = static_cast<std::size_t>(std::max(0, rows.last - rows.first + 1));
  spans.first_row = rows.first;
  spans.first.assign(count, columns);
  spans.last.assign(count, -1);
  if (count == 0) {
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
    const int from = std::max(rows.first, ceil_to_int(std::clamp(low.y(), -1.0, 1e6)));
    const int to = std::min(rows.last, floor_to_int(std::clamp(high.y(), -1.0, 1e6)));
    cut_rows({low.x(), low.y(), slope}, from, to, columns, spans.first.data() - rows.first,
             spans.last.data() - rows.first);
  }
}

constexpr int kMostRows = 250;  // of a sector that is cut without a list
constexpr int kRowsAtOnce = 4;
/// Columns where a sector begins and ends in each row; the vectors reach beyond the last one.
struct SectorColumns {
  std::array<int, kMostRows + kRowsAtOnce> first;
  std::array<int, kMostRows + kRowsAtOnce> last;
};

/// The same as `cut_sector` for a sector of so few rows whose corners all lie within the grid, clear of the rows'
/// middles: there one edge begins each row and one ends it, and those are the innermost of all edges, since a sector is
/// convex. Nothing depends on where the corners lie, so that no branch has to be guessed.
LUMINAV_VECTOR_CLONES
void cut_inner_sector(const Corners& corners, const RowRange& rows, SectorColumns& columns) {
  using Doubles = double __attribute__((vector_size(kRowsAtOnce * sizeof(double))));
  using Longs = std::int64_t __attribute__((vector_size(kRowsAtOnce * sizeof(std::int64_t))));
  using Ints = int __attribute__((vector_size(kRowsAtOnce * sizeof(int))));
  constexpr std::size_t kCount = std::tuple_size_v<Corners>;
  constexpr double kFar = std::numeric_limits<double>::infinity();
  struct Line {
    double low_x;
    double low_y;
    double slope;
    double for_first;  // added where it should begin rows, 0 if it does
    double for_last;
  };
  std::array<Line, kCount> lines;
  for (std::size_t i = 0; i < kCount; ++i) {
    const Eigen::Vector2d& a = corners[i];
    const Eigen::Vector2d& b = corners[i + 1 == kCount ? 0 : i + 1];
    const bool is_last = a.y() < b.y();  // counter-clockwise: upwards on the right
    const bool is_first = b.y() < a.y();
    const Eigen::Vector2d& low = is_last ? a : b;
    const Eigen::Vector2d& high = is_last ? b : a;
    lines[i] = {low.x(), low.y(), (high.x() - low.x()) / (high.y() - low.y()), is_first ? 0.0 : -kFar,
                is_last ? 0.0 : kFar};
  }
  for (int row = rows.first; row <= rows.last; row += kRowsAtOnce) {
    const Ints each = Ints{} + row + Ints{0, 1, 2, 3};
    const Doubles y = __builtin_convertvector(each, Doubles);
    Doubles first = Doubles{} - 2.0;
    Doubles last = Doubles{} + 1e9;
    for (const Line& line : lines) {
      const Doubles x = line.low_x + line.slope * (y - line.low_y);
      // a level edge counts on neither side, whatever it gives
      const Doubles begin = x + line.for_first;
      const Doubles end = x + line.for_last;
      first = begin > first ? begin : first;
      last = end < last ? end : last;
    }
    // inside the grid nothing is negative, so that cutting rounds down; -1 where a comparison holds
    const Ints cut = __builtin_convertvector(first, Ints);
    const Longs is_beyond = static_cast<Longs>(first > __builtin_convertvector(cut, Doubles));
    const Ints up = cut - __builtin_convertvector(is_beyond, Ints);
    const Ints down = __builtin_convertvector(last, Ints);
    const auto i = static_cast<std::size_t>(row - rows.first);
    std::memcpy(columns.first.data() + i, &up, sizeof(up));
    std::memcpy(columns.last.data() + i, &down, sizeof(down));
  }
}

/// May `cut_inner_sector` take it?
bool is_plain(const Corners& corners, const RowRange& rows, const GridGeometry& geometry) {
  bool is_plain = rows.last - rows.first < kMostRows;
  for (const auto& corner : corners) {
    const double from_row = corner.y() - static_cast<int>(std::clamp(corner.y(), -1.0, 1e6));
    is_plain = is_plain & (corner.x() >= 0.001) & (corner.y() >= 0.0) & (corner.x() <= geometry.columns - 1.001) &
               (corner.y() <= geometry.rows - 1.0) & (from_row > 1e-6) & (from_row < 1.0 - 1e-6);
  }
  return is_plain;
}

/// A sector to be drawn: in each of its rows the first and the last column.
struct SectorRows {
  const int* first;
  const int* last;
  int first_row;
  int last_row;
};

LUMINAV_VECTOR_CLONES
void lower_rows(std::vector<std::int8_t>& evidence, const GridGeometry& geometry, const SectorRows& rows,
                std::int8_t vote, std::int8_t least) {
  const std::int8_t* const end = evidence.data() + evidence.size();
  for (int row = rows.first_row; row <= rows.last_row; ++row) {
    const int first = rows.first[row - rows.first_row];
    const int count = rows.last[row - rows.first_row] - first + 1;
    if (count > 0) {
      lower(evidence.data() + geometry.index({first, row}), count, vote, least, end);
    }
  }
}

}  // namespace

void fill_sector(const GridGeometry& geometry, const Eigen::Vector2d& apex, double from_angle, double to_angle,
                 double radius, CellSpans& spans) {
  const Corners corners = corners_of_sector(geometry, apex, from_angle, to_angle, radius);
  cut_sector(corners, rows_of(corners, geometry.rows), geometry.columns, spans);
}

FreeSpaceModel::FreeSpaceModel(const SonarModelParams& params) : params_(params) {
  if (!(params.minimum_range >= 0.0 && params.maximum_range > params.minimum_range)) {
    throw std::invalid_argument("sonar model: maximum_range must be above minimum_range");
  }
  if (!(params.half_angle > 0.0 && params.half_angle < 0.5 * kPi)) {
    throw std::invalid_argument("sonar model: half_angle must be between 0 and pi/2");
  }
  // silence takes away what is believed to stand there; it does not prove that nothing does
  echo_ = votes_of(1.0, to_evidence(params_.least_log_odds));
  silence_ = votes_of(params_.no_echo_share, 0);
}

FreeSpaceModel::Votes FreeSpaceModel::votes_of(double share, std::int8_t least) const {
  Votes votes;
  votes.least = least;
  votes.cone = static_cast<std::int8_t>(-to_evidence(share * params_.free_log_odds));
  votes.core = static_cast<std::int8_t>(-to_evidence(share * params_.core_log_odds));
  for (int before = -128; before < 128; ++before) {
    votes.of_line[static_cast<std::uint8_t>(before)] =
        lowered(static_cast<std::int8_t>(before), static_cast<std::int8_t>(votes.cone + votes.core), least);
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
  sector(grid.geometry, reading.world_from_sonar, params_.half_angle, limits, length, votes.cone, votes.least,
         grid.evidence);
  sector(grid.geometry, reading.world_from_sonar, 0.5 * params_.half_angle, limits,
         std::min(length, params_.core_range), votes.core, votes.least, grid.evidence);
}

void FreeSpaceModel::sector(const GridGeometry& geometry, const Pose2& apex, double half_angle,
                            const SliceRanges& ranges, double most, std::int8_t vote, std::int8_t least,
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
    const Corners corners = corners_of_sector(geometry, apex.position(), apex.theta + from, apex.theta + to, range);
    const RowRange rows = rows_of(corners, geometry.rows);
    const int* firsts;
    const int* lasts;
    SectorColumns columns;
    if (is_plain(corners, rows, geometry)) {
      cut_inner_sector(corners, rows, columns);
      firsts = columns.first.data();
      lasts = columns.last.data();
    } else {
      cut_sector(corners, rows, geometry.columns, spans_);
      firsts = spans_.first.data();
      lasts = spans_.last.data();
    }
    lower_rows(evidence, geometry, {firsts, lasts, rows.first, rows.last}, vote, least);
  }
}

void FreeSpaceModel::line(const GridGeometry& geometry, const Pose2& apex, double length,
                          const std::array<std::int8_t, 256>& table, std::vector<std::int8_t>& evidence) {
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
    const double theta = reading.world_from_sonar.theta;
    const Eigen::Vector2d at = apex + in_cells * Eigen::Vector2d(std::cos(theta), std::sin(theta));
    if (is_inside(at)) {
      cells.push_back({{static_cast<int>(at.x()), static_cast<int>(at.y())}, kSlices / 2, 1.0});
    }
    return;
  }
  const double half = params.half_angle + widening;
  const int steps = std::max(1, static_cast<int>(std::ceil(half * range / (0.5 * geometry.resolution))));
  Direction direction(reading.world_from_sonar.theta - half, half / steps);
  const ArcSampling sampling{apex.x(), apex.y(), in_cells, half, params.half_angle, params.edge_weight, steps};
  cells.resize(2 * static_cast<std::size_t>(steps) + 1);
  // the whole circle within the grid: no sample needs to be asked
  const double around = in_cells + 1.0;
  const bool are_inside =
      is_inside(apex - Eigen::Vector2d(around, around)) && is_inside(apex + Eigen::Vector2d(around, around));
  ArcCell* last = cells.data() - 1;
  ArcCell cell{{-1, -1}, 0, 0.0};
  const auto take = [&](const Cell& at, int slice, double weight) {
    // without branches: nobody guesses which sample is the first of its cell
    const bool is_new = ((at.column ^ cell.cell.column) | (at.row ^ cell.cell.row)) != 0;
    const std::array<double, 2> weight_before{cell.weight, -std::numeric_limits<double>::infinity()};
    last += is_new ? 1 : 0;
    cell.cell = at;
    cell.slice = is_new ? slice : cell.slice;
    cell.weight = std::max(weight_before[is_new ? 1 : 0], weight);
    *last = cell;
  };
  ArcSamples samples;
  for (int from = -steps; from <= steps; from += kArcChunk) {
    const int count = std::min(kArcChunk, steps - from + 1);
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k, direction.advance()) {
      samples.x[k] = direction.x();
      samples.y[k] = direction.y();
    }
    sample_arc(sampling, from, count, are_inside, samples);
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
      if (are_inside) {
        take({samples.column[k], samples.row[k]}, samples.slice[k], samples.weight[k]);
      } else if (is_inside({samples.x[k], samples.y[k]})) {
        take({static_cast<int>(samples.x[k]), static_cast<int>(samples.y[k])}, samples.slice[k], samples.weight[k]);
      }
    }
  }
  cells.resize(static_cast<std::size_t>(last + 1 - cells.data()));
}

}  // namespace luminav
