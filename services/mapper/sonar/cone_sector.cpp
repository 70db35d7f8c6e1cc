#include "services/mapper/sonar/cone_sector.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

#include "services/common/geometry/rounding.hpp"
#include "services/common/geometry/vector_clones.hpp"
#include "services/mapper/sonar/turning_direction.hpp"

namespace luminav {
namespace {

constexpr int kArcCorners = 5;  // the chord stays within 0.2 % of the arc

constexpr std::size_t kLanes = 16;  // cells at a time
using Lanes = std::int8_t __attribute__((vector_size(kLanes)));

/// Takes a vote from `count` cells. `end` is where the grid ends. The vote is a copy: for all the compiler knows, cells
/// that are written may be part of anything that is referred to.
inline void lower(std::int8_t* cells, std::ptrdiff_t count, EvidenceVote vote, const std::int8_t* end) {
  constexpr Lanes kLane = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  const auto lanes = static_cast<std::ptrdiff_t>(kLanes);
  const Lanes votes = Lanes{} + vote.change;
  const Lanes floor = Lanes{} + vote.min;
  const Lanes room = Lanes{} + static_cast<std::int8_t>(vote.min - vote.change);  // the sum fits from here on
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
    cells[i] = vote.of(cells[i]);
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

/// Apex and corners of a sector [cells], counter-clockwise and back to the apex, so that the centre of cell (c, r) is
/// (c, r).
struct Corners {
  static constexpr std::size_t kCount = kArcCorners + 1;
  std::array<double, kCount + 1> x;
  std::array<double, kCount + 1> y;
};

inline Corners corners_of_sector(const GridGeometry& geometry, const Eigen::Vector2d& apex, double from_angle,
                                 double to_angle, double radius) {
  Corners corners;
  corners.x[0] = apex.x();
  corners.y[0] = apex.y();
  TurningDirection direction(from_angle, (to_angle - from_angle) / (kArcCorners - 1));
  for (std::size_t i = 1; i < Corners::kCount; ++i) {
    corners.x[i] = apex.x() + radius * direction.x();
    corners.y[i] = apex.y() + radius * direction.y();
    direction.advance();
  }
  for (std::size_t i = 0; i < Corners::kCount; ++i) {
    corners.x[i] = (corners.x[i] - geometry.origin.x()) / geometry.resolution - 0.5;
    corners.y[i] = (corners.y[i] - geometry.origin.y()) / geometry.resolution - 0.5;
  }
  corners.x.back() = corners.x.front();
  corners.y.back() = corners.y.front();
  return corners;
}

/// Rows that a sector reaches into, clipped to the grid.
struct RowRange {
  int first = 0;
  int last = -1;
};
inline RowRange rows_of(const Corners& corners, int rows) {
  double bottom = corners.y[0];
  double top = corners.y[0];
  for (const double y : corners.y) {
    bottom = std::min(bottom, y);
    top = std::max(top, y);
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
  for (std::size_t i = 0; i < Corners::kCount; ++i) {
    const std::size_t low = corners.y[i] < corners.y[i + 1] ? i : i + 1;
    const std::size_t high = 2 * i + 1 - low;
    const double rise = corners.y[high] - corners.y[low];
    if (rise <= 0.0) {
      continue;
    }
    const double slope = (corners.x[high] - corners.x[low]) / rise;
    const int from = std::max(rows.first, ceil_to_int(std::clamp(corners.y[low], -1.0, 1e6)));
    const int to = std::min(rows.last, floor_to_int(std::clamp(corners.y[high], -1.0, 1e6)));
    cut_rows({corners.x[low], corners.y[low], slope}, from, to, columns, spans.first.data() - rows.first,
             spans.last.data() - rows.first);
  }
}

constexpr int kMaxRows = 250;  // of a sector that is cut without a list
constexpr int kRowsAtOnce = 4;
/// Columns where a sector begins and ends in each row; the vectors reach beyond the last one.
struct SectorColumns {
  std::array<int, kMaxRows + kRowsAtOnce> first;
  std::array<int, kMaxRows + kRowsAtOnce> last;
};

/// The same as `cut_sector` for a sector of so few rows whose corners all lie within the grid, clear of the rows'
/// middles: there one edge begins each row and one ends it, and those are the innermost of all edges, since a sector is
/// convex. Nothing depends on where the corners lie, so that no branch has to be guessed.
inline void cut_inner_sector(const Corners& corners, const RowRange& rows, SectorColumns& columns) {
  using Doubles = double __attribute__((vector_size(kRowsAtOnce * sizeof(double))));
  using Longs = std::int64_t __attribute__((vector_size(kRowsAtOnce * sizeof(std::int64_t))));
  using Ints = int __attribute__((vector_size(kRowsAtOnce * sizeof(int))));
  constexpr double kFar = std::numeric_limits<double>::infinity();
  struct Line {
    double low_y;
    double slope;
    double first_x;  // at low_y where it begins rows, else beyond all
    double last_x;   // where it ends them
  };
  std::array<Line, Corners::kCount> lines;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double from_x = corners.x[i];
    const double from_y = corners.y[i];
    const double to_x = corners.x[i + 1];
    const double to_y = corners.y[i + 1];
    const bool is_last = from_y < to_y;  // counter-clockwise: upwards on the right
    const bool is_first = to_y < from_y;
    const double low_x = is_last ? from_x : to_x;
    const double low_y = is_last ? from_y : to_y;
    const double high_x = is_last ? to_x : from_x;
    const double high_y = is_last ? to_y : from_y;
    lines[i] = {low_y, (high_x - low_x) / (high_y - low_y), is_first ? low_x : -kFar, is_last ? low_x : kFar};
  }
  for (int row = rows.first; row <= rows.last; row += kRowsAtOnce) {
    const Ints each = Ints{} + row + Ints{0, 1, 2, 3};
    const Doubles y = __builtin_convertvector(each, Doubles);
    Doubles first = Doubles{} - 2.0;
    Doubles last = Doubles{} + 1e9;
    for (const Line& line : lines) {
      // a level edge counts on neither side, whatever it gives
      const Doubles away = line.slope * (y - line.low_y);
      const Doubles begin = line.first_x + away;
      const Doubles end = line.last_x + away;
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
inline bool is_plain(const Corners& corners, const RowRange& rows, const GridGeometry& geometry) {
  const double max_x = geometry.columns - 1.001;
  const double max_y = geometry.rows - 1.0;
  bool is_plain = rows.last - rows.first < kMaxRows;
  for (std::size_t i = 0; i < Corners::kCount; ++i) {
    const double x = corners.x[i];
    const double y = corners.y[i];
    const double from_row = y - static_cast<int>(std::clamp(y, -1.0, 1e6));
    is_plain = is_plain & (x >= 0.001) & (y >= 0.0) & (x <= max_x) & (y <= max_y) & (from_row > 1e-6) &
               (from_row < 1.0 - 1e-6);
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

inline void lower_rows(std::vector<std::int8_t>& evidence, int columns, SectorRows rows, EvidenceVote vote) {
  const std::int8_t* const end = evidence.data() + evidence.size();
  std::int8_t* cells = evidence.data() + static_cast<std::ptrdiff_t>(rows.first_row) * columns;
  for (int i = 0; i <= rows.last_row - rows.first_row; ++i, cells += columns) {
    const int first = rows.first[i];
    const int count = rows.last[i] - first + 1;
    if (count > 0) {
      lower(cells + first, count, vote, end);
    }
  }
}

}  // namespace

void fill_sector(const GridGeometry& geometry, const Eigen::Vector2d& apex, double from_angle, double to_angle,
                 double radius, CellSpans& spans) {
  const Corners corners = corners_of_sector(geometry, apex, from_angle, to_angle, radius);
  cut_sector(corners, rows_of(corners, geometry.rows), geometry.columns, spans);
}

LUMINAV_VECTOR_CLONES
void lower_sector(const GridGeometry& geometry, const Eigen::Vector2d& apex, double from_angle, double to_angle,
                  double radius, const EvidenceVote& vote, CellSpans& spans, std::vector<std::int8_t>& evidence) {
  const Corners corners = corners_of_sector(geometry, apex, from_angle, to_angle, radius);
  const RowRange rows = rows_of(corners, geometry.rows);
  SectorColumns columns;
  SectorRows drawn{columns.first.data(), columns.last.data(), rows.first, rows.last};
  if (is_plain(corners, rows, geometry)) {
    cut_inner_sector(corners, rows, columns);
  } else {
    cut_sector(corners, rows, geometry.columns, spans);
    drawn.first = spans.first.data();
    drawn.last = spans.last.data();
  }
  lower_rows(evidence, geometry.columns, drawn, vote);
}

}  // namespace luminav
