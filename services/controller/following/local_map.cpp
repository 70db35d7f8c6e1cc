#include "services/controller/following/local_map.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "services/common/geometry/vector_clones.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace luminav {
namespace {

constexpr int kGroup = 16;  // cells that are read at once

static_assert(static_cast<int>(Prior::kOccupied) == 2 && static_cast<int>(Prior::kDisputed) == 3);

/// Which of a group of cells are walls of the building's map, a bit each.
inline std::uint64_t wall_bits_of_group(const Prior* cells) {
#if defined(__x86_64__)
  const __m128i bytes = _mm_loadu_si128(reinterpret_cast<const __m128i*>(cells));
  return static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_cmpeq_epi8(bytes, _mm_set1_epi8(2))));
#else
  std::uint64_t bits = 0;
  for (int half = 0; half < kGroup / 8; ++half) {
    std::uint64_t bytes = 0;
    std::memcpy(&bytes, cells + 8 * half, 8);
    const std::uint64_t is_wall = bytes >> 1 & ~bytes & 0x0101010101010101ULL;
    bits |=
        is_wall * 0x0102040810204080ULL >> 56 << (8 * half);  // the bytes' lowest bits, gathered in the highest byte
  }
  return bits;
#endif
}

/// The same of some groups.
struct PlainRead {
  template <int kGroups>
  static std::uint64_t bits_of(const Prior* cells) {
    std::uint64_t bits = 0;
    for (int i = 0; i < kGroups; ++i) {
      bits |= wall_bits_of_group(cells + kGroup * i) << (kGroup * i);
    }
    return bits;
  }
};

#if defined(__x86_64__)
/// Two groups at once.
struct WideRead {
  template <int kGroups>
  __attribute__((target("avx2"))) static std::uint64_t bits_of(const Prior* cells) {
    const __m256i wall = _mm256_set1_epi8(2);
    std::uint64_t bits = 0;
    for (int i = 0; i + 1 < kGroups; i += 2) {
      const __m256i bytes = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(cells + kGroup * i));
      const int is_wall = _mm256_movemask_epi8(_mm256_cmpeq_epi8(bytes, wall));
      bits |= std::uint64_t{static_cast<std::uint32_t>(is_wall)} << (kGroup * i);
    }
    return kGroups % 2 == 0 ? bits
                            : bits | wall_bits_of_group(cells + kGroup * (kGroups - 1)) << (kGroup * (kGroups - 1));
  }
};
#endif

/// A column of words: up to 64 cells of each row, whose first and last belong to the words beside.
constexpr int kInner = 62;
struct WordColumn {
  int first_column;  // of the cells it is asked for; bit 1
  int count;         // of them
};

/// Where faces of walls are looked for: a column of words in some rows of a grid. By value: for all the compiler knows,
/// what is written may be part of the grid.
struct FaceSearch {
  const Prior* cells;
  int columns;  // of the grid
  int rows;
  WordColumn word;
  int first_row;
  int last_row;
};

/// Faces of the walls in one row of a column of words.
struct RowFaces {
  std::uint64_t bits;
  int row;
};

/// Walls of a word in one row; outside the grid there is none. Bits beyond those of the next word's first cell mean
/// nothing.
template <typename Read, int kGroups>
[[gnu::always_inline]] inline std::uint64_t wall_bits(const FaceSearch& search, int row, bool is_clipped) {
  if (row < 0 || row >= search.rows) {
    return 0;
  }
  const int first = search.word.first_column - 1;
  const Prior* const cells = search.cells + static_cast<std::ptrdiff_t>(row) * search.columns;
  if (!is_clipped) {
    return Read::template bits_of<kGroups>(cells + first);
  }
  std::array<Prior, 64> clipped{};
  const int from = std::max(0, first);
  const int to = std::min(search.columns, first + search.word.count + 2);
  std::copy(cells + from, cells + std::max(from, to), clipped.data() + (from - first));
  return Read::template bits_of<kGroups>(clipped.data());
}

/// Faces of the walls in the rows that have any; returns how many these are. The inside of a thick wall is behind.
template <typename Read, int kGroups>
[[gnu::always_inline]] inline std::size_t find_faces_by(const FaceSearch search, RowFaces* faces) {
  const int first = search.word.first_column - 1;
  const bool is_clipped = first < 0 || first + kGroup * kGroups > search.columns;
  const std::uint64_t asked = ((std::uint64_t{1} << search.word.count) - 1) << 1;
  std::uint64_t below = wall_bits<Read, kGroups>(search, search.first_row - 1, is_clipped);
  std::uint64_t here = wall_bits<Read, kGroups>(search, search.first_row, is_clipped);
  RowFaces* next = faces;
  for (int row = search.first_row; row <= search.last_row; ++row) {
    const std::uint64_t above = wall_bits<Read, kGroups>(search, row + 1, is_clipped);
    const std::uint64_t bits = here & ~(here << 1 & here >> 1 & below & above) & asked;
    *next = {bits, row};
    next += bits != 0 ? 1 : 0;
    below = here;
    here = above;
  }
  return static_cast<std::size_t>(next - faces);
}

template <int kGroups>
std::size_t find_faces_plain(const FaceSearch& search, RowFaces* faces) {
  return find_faces_by<PlainRead, kGroups>(search, faces);
}

#if defined(__x86_64__)
template <int kGroups>
__attribute__((target("avx2"))) std::size_t find_faces_wide(const FaceSearch& search, RowFaces* faces) {
  return find_faces_by<WideRead, kGroups>(search, faces);
}
#endif

using FindFaces = std::size_t (*)(const FaceSearch&, RowFaces*);

template <int kGroups>
FindFaces fastest_find_faces() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) {
    return find_faces_wide<kGroups>;
  }
#endif
  return find_faces_plain<kGroups>;
}

/// `faces` has room for all rows.
std::size_t find_faces(const FaceSearch& search, RowFaces* faces) {
  static const FindFaces kOfThree = fastest_find_faces<3>();
  static const FindFaces kOfFour = fastest_find_faces<4>();
  return (search.word.count + 2 <= 3 * kGroup ? kOfThree : kOfFour)(search, faces);
}

/// The side of a cell that is turned to the robot: the wall's face may be anywhere in it.
double towards(double robot_at, double centre, double half_cell) {
  return std::min(std::max(robot_at, centre - half_cell), centre + half_cell);
}

/// The largest number whose square root is at most this: distances are compared without roots.
double largest_square(double root) {
  // roots round up from half a last digit beyond; its square is this, but for the square of the half
  const double square = root * std::nextafter(root, std::numeric_limits<double>::infinity());
  return std::sqrt(square) > root ? std::nextafter(square, 0.0) : square;
}

/// Walls in a column of words as the robot sees them, without what depends on the row.
struct FaceColumns {
  std::array<double, 64> square;              // [m^2] of the way along x, by bit; least beside the robot
  std::array<double, 64 + kLanes> x_by_face;  // [m] robot frame; a run is read in whole lanes
  std::array<double, 64 + kLanes> y_by_face;  // [m]
};

LUMINAV_VECTOR_CLONES
void look_along(const GridGeometry& geometry, const WordColumn& word, double robot_x,
                const PointTransform& robot_from_world, FaceColumns& columns) {
  for (int k = 0; k < word.count; ++k) {
    const double centre_x = geometry.origin.x() + (word.first_column + k + 0.5) * geometry.resolution;
    const double face_x = towards(robot_x, centre_x, 0.5 * geometry.resolution);
    const double away_x = face_x - robot_x;
    const auto bit = static_cast<std::size_t>(k + 1);
    columns.square[bit] = away_x * away_x;
    const Eigen::Vector2d by_face = robot_from_world * Eigen::Vector2d(face_x, 0.0);
    columns.x_by_face[bit] = by_face.x();
    columns.y_by_face[bit] = by_face.y();
  }
  // a run at the border is read beyond it
  std::fill_n(columns.x_by_face.begin() + word.count + 1, kLanes, 0.0);
  std::fill_n(columns.y_by_face.begin() + word.count + 1, kLanes, 0.0);
}

/// Adds the walls of a row whose bits are set, a run of them at once.
LUMINAV_VECTOR_CLONES
void add_row(const FaceColumns& columns, std::uint64_t bits, const Eigen::Vector2d& by_row, PlanePoints& walls) {
  while (bits != 0) {
    const int start = std::countr_zero(bits);
    const int length = std::countr_one(bits >> start);
    walls.add_shifted(columns.x_by_face.data() + start, columns.y_by_face.data() + start,
                      static_cast<std::size_t>(length), by_row);
    bits &= bits + (std::uint64_t{1} << start);
  }
}

/// The columns within the radius, row by row: a run about the robot that hardly changes from one row to the next.
class ColumnsWithin {
 public:
  /// `nearest` is the bit of the column beside the robot.
  ColumnsWithin(const FaceColumns& columns, int count, int nearest)
      : columns_(columns), count_(count), nearest_(nearest), last_(count) {}

  /// Bits of the columns whose square and another together are at most so much.
  std::uint64_t of_row(double other_square, double max) {
    const auto is_within = [&](int bit) {
      return columns_.square[static_cast<std::size_t>(bit)] + other_square <= max;
    };
    if (!is_within(nearest_)) {
      return 0;
    }
    for (; !is_within(first_); ++first_) {
    }
    for (; first_ > 1 && is_within(first_ - 1); --first_) {
    }
    for (; !is_within(last_); --last_) {
    }
    for (; last_ < count_ && is_within(last_ + 1); ++last_) {
    }
    return (std::uint64_t{2} << last_) - (std::uint64_t{1} << first_);
  }

 private:
  const FaceColumns& columns_;
  int count_;
  int nearest_;
  int first_ = 1;
  int last_;
};

/// Is there nothing in the cells between two points, both included, as far as the grid goes?
bool is_box_free(const OccupancyGrid& grid, const Eigen::Vector2d& low_in_world, const Eigen::Vector2d& high_in_world,
                 int max_evidence) {
#if defined(__x86_64__)
  const GridGeometry& geometry = grid.geometry;
  const Cell low = geometry.cell_at(low_in_world);
  const Cell high = geometry.cell_at(high_in_world);
  if (low.column < 0 || low.row < 0 || high.row >= geometry.rows || high.column - low.column >= kGroup ||
      low.column + kGroup > geometry.columns || high.column < low.column) {
    return false;  // perhaps it is
  }
  const __m128i max = _mm_set1_epi8(static_cast<char>(max_evidence));
  __m128i occupied = _mm_setzero_si128();
  for (int row = low.row; row <= high.row; ++row) {
    const std::size_t start = geometry.index({low.column, row});
    const __m128i prior = _mm_loadu_si128(reinterpret_cast<const __m128i*>(grid.prior.data() + start));
    const __m128i evidence = _mm_loadu_si128(reinterpret_cast<const __m128i*>(grid.evidence.data() + start));
    const __m128i is_occupied = _mm_or_si128(_mm_cmpeq_epi8(prior, _mm_set1_epi8(2)), _mm_cmpgt_epi8(evidence, max));
    occupied = _mm_or_si128(occupied, is_occupied);
  }
  const auto bits = static_cast<std::uint32_t>(_mm_movemask_epi8(occupied));
  return (bits & ((2U << (high.column - low.column)) - 1)) == 0;
#else
  (void)grid, (void)low_in_world, (void)high_in_world, (void)max_evidence;
  return false;  // perhaps it is
#endif
}

}  // namespace

bool is_prior_wall(const OccupancyGrid& grid, const Cell& cell) {
  return grid.geometry.contains(cell) && grid.prior[grid.geometry.index(cell)] == Prior::kOccupied;
}

bool is_occupied(const OccupancyGrid& grid, const Cell& cell, const LocalMapParams& params) {
  if (!grid.geometry.contains(cell)) {
    return false;
  }
  const std::size_t index = grid.geometry.index(cell);
  return grid.prior[index] == Prior::kOccupied || grid.evidence[index] > params.occupied * kEvidencePerLogOdds;
}

bool has_wall_near(const OccupancyGrid& grid, const Eigen::Vector2d& point_in_world, double distance) {
  const Eigen::Vector2d reach(distance, distance);
  const Cell low = grid.geometry.cell_at(point_in_world - reach);
  const Cell high = grid.geometry.cell_at(point_in_world + reach);
  const double half = 0.5 * grid.geometry.resolution;
  for (int row = low.row; row <= high.row; ++row) {
    for (int column = low.column; column <= high.column; ++column) {
      if (!is_prior_wall(grid, {column, row})) {
        continue;
      }
      // to the cell's square, not its centre
      const Eigen::Vector2d offset =
          (grid.geometry.centre_of({column, row}) - point_in_world).cwiseAbs() - Eigen::Vector2d(half, half);
      if (offset.cwiseMax(0.0).norm() <= distance) {
        return true;
      }
    }
  }
  return false;
}

void find_known_walls(const OccupancyGrid& grid, const Pose2& world_from_robot, const LocalMapParams& params,
                      PlanePoints& walls) {
  const GridGeometry& geometry = grid.geometry;
  const Eigen::Vector2d robot = world_from_robot.position();
  const Eigen::Vector2d reach(params.radius, params.radius);
  const Cell low = geometry.cell_at(robot - reach);
  const Cell high = geometry.cell_at(robot + reach);
  const int first_row = std::max(0, low.row);
  const int last_row = std::min(geometry.rows - 1, high.row);
  const int first_column = std::max(0, low.column);
  const int last_column = std::min(geometry.columns - 1, high.column);
  if (first_row > last_row || first_column > last_column) {
    return;
  }
  const auto rows = static_cast<std::size_t>(last_row - first_row + 1);
  walls.reserve(walls.size() + rows * static_cast<std::size_t>(last_column - first_column + 1));
  std::array<RowFaces, 128> few_faces;
  std::vector<RowFaces> many_faces(rows > few_faces.size() ? rows : 0);
  RowFaces* const faces = many_faces.empty() ? few_faces.data() : many_faces.data();
  const PointTransform robot_from_world = PointTransform::inverse_of(world_from_robot);
  const double max = largest_square(params.radius);
  for (int column = first_column; column <= last_column; column += kInner) {
    const WordColumn word{column, std::min(kInner, last_column + 1 - column)};
    const std::size_t rows_with_faces =
        find_faces({grid.prior.data(), geometry.columns, geometry.rows, word, first_row, last_row}, faces);
    FaceColumns columns;
    look_along(geometry, word, robot.x(), robot_from_world, columns);
    ColumnsWithin within(columns, word.count, std::clamp(geometry.cell_at(robot).column - column + 1, 1, word.count));
    for (std::size_t i = 0; i < rows_with_faces; ++i) {
      const double centre_y = geometry.origin.y() + (faces[i].row + 0.5) * geometry.resolution;
      const double face_y = towards(robot.y(), centre_y, 0.5 * geometry.resolution);
      const double away_y = face_y - robot.y();
      add_row(columns, faces[i].bits & within.of_row(away_y * away_y, max), robot_from_world.turned({0.0, face_y}),
              walls);
    }
  }
}

bool is_line_free(const OccupancyGrid& grid, const Eigen::Vector2d& from_in_world, const Eigen::Vector2d& to_in_world,
                  const LocalMapParams& params) {
  const Eigen::Vector2d step = to_in_world - from_in_world;
  const double length = step.norm();
  if (length < 1e-6) {
    return true;
  }
  const double threshold = params.occupied * kEvidencePerLogOdds;
  const Eigen::Vector2d around = Eigen::Vector2d::Constant(params.half_width + 1e-6);
  if (threshold >= -128.0 &&
      is_box_free(grid, from_in_world.cwiseMin(to_in_world) - around, from_in_world.cwiseMax(to_in_world) + around,
                  static_cast<int>(std::min(127.0, std::floor(threshold))))) {
    return true;  // mostly: nothing stands anywhere near
  }
  const Eigen::Vector2d along = step / length;
  const Eigen::Vector2d across(-along.y(), along.x());
  for (double distance = 0.0; distance <= length; distance += 0.5 * grid.geometry.resolution) {
    for (const double side : std::array{-params.half_width, 0.0, params.half_width}) {
      const Eigen::Vector2d point = from_in_world + distance * along + side * across;
      // beside the robot itself the line does not ask: it stands there already
      if ((side == 0.0 || distance > 0.2) && is_occupied(grid, grid.geometry.cell_at(point), params)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace luminav
