#include "services/controller/local_map.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace luminav {
namespace {

constexpr int kGroup = 16;  // cells that are read at once

/// Which of a group of cells are walls of the building's map, a bit each.
std::uint64_t wall_bits_of_group(const Prior* cells) {
  static_assert(static_cast<int>(Prior::kOccupied) == 2 && static_cast<int>(Prior::kDisputed) == 3);
#if defined(__SSE2__)
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

/// A column of words: up to 64 cells of each row, whose first and last belong to the words beside.
constexpr int kInner = 62;
struct WordColumn {
  int first_column;  // of the cells it is asked for; bit 1
  int count;         // of them
};

/// Walls of a word in one row; outside the grid there is none. Bits beyond those of the next word's first cell mean
/// nothing.
template <int kGroups>
std::uint64_t wall_bits(const OccupancyGrid& grid, const WordColumn& word, int row, bool is_clipped) {
  const GridGeometry& geometry = grid.geometry;
  if (row < 0 || row >= geometry.rows) {
    return 0;
  }
  const int first = word.first_column - 1;
  const Prior* cells = grid.prior.data() + geometry.index({0, row});
  std::array<Prior, 64> clipped{};
  if (is_clipped) {
    const int from = std::max(0, first);
    const int to = std::min(geometry.columns, first + word.count + 2);
    std::copy(cells + from, cells + std::max(from, to), clipped.data() + (from - first));
    cells = clipped.data();
  } else {
    cells += first;
  }
  std::uint64_t bits = 0;
  for (int i = 0; i < kGroups; ++i) {
    bits |= wall_bits_of_group(cells + kGroup * i) << (kGroup * i);
  }
  return bits;
}

/// Faces of the walls in a column of words, a word per row, `stride` words apart: the inside of a thick wall is behind.
template <int kGroups>
void find_faces(const OccupancyGrid& grid, const WordColumn& word, int first_row, int last_row, std::size_t stride,
                std::uint64_t* faces) {
  const int first = word.first_column - 1;
  const bool is_clipped = first < 0 || first + kGroup * kGroups > grid.geometry.columns;
  const std::uint64_t asked = ((std::uint64_t{1} << word.count) - 1) << 1;
  std::uint64_t below = wall_bits<kGroups>(grid, word, first_row - 1, is_clipped);
  std::uint64_t here = wall_bits<kGroups>(grid, word, first_row, is_clipped);
  for (int row = first_row; row <= last_row; ++row, faces += stride) {
    const std::uint64_t above = wall_bits<kGroups>(grid, word, row + 1, is_clipped);
    *faces = here & ~(here << 1 & here >> 1 & below & above) & asked;
    below = here;
    here = above;
  }
}

/// Walls of up to 62 columns as the robot sees them, without what depends on the row.
struct FaceColumns {
  std::array<double, 64> square;     // [m^2] of the way along x
  std::array<double, 64> x_by_face;  // [m] robot frame
  std::array<double, 64> y_by_face;  // [m]
};

/// The side of a cell that is turned to the robot: the wall's face may be anywhere in it.
double towards(double robot_at, double centre, double half_cell) {
  return std::min(std::max(robot_at, centre - half_cell), centre + half_cell);
}

/// Is there nothing in the cells between two points, both included, as far as the grid goes?
bool is_box_free(const OccupancyGrid& grid, const Eigen::Vector2d& low_in_world, const Eigen::Vector2d& high_in_world,
                 int most_evidence) {
#if defined(__SSE2__)
  const GridGeometry& geometry = grid.geometry;
  const Cell low = geometry.cell_at(low_in_world);
  const Cell high = geometry.cell_at(high_in_world);
  if (low.column < 0 || low.row < 0 || high.row >= geometry.rows || high.column - low.column >= kGroup ||
      low.column + kGroup > geometry.columns || high.column < low.column) {
    return false;  // perhaps it is
  }
  const __m128i most = _mm_set1_epi8(static_cast<char>(most_evidence));
  __m128i occupied = _mm_setzero_si128();
  for (int row = low.row; row <= high.row; ++row) {
    const std::size_t start = geometry.index({low.column, row});
    const __m128i prior = _mm_loadu_si128(reinterpret_cast<const __m128i*>(grid.prior.data() + start));
    const __m128i evidence = _mm_loadu_si128(reinterpret_cast<const __m128i*>(grid.evidence.data() + start));
    const __m128i is_occupied = _mm_or_si128(_mm_cmpeq_epi8(prior, _mm_set1_epi8(2)), _mm_cmpgt_epi8(evidence, most));
    occupied = _mm_or_si128(occupied, is_occupied);
  }
  const auto bits = static_cast<std::uint32_t>(_mm_movemask_epi8(occupied));
  return (bits & ((2U << (high.column - low.column)) - 1)) == 0;
#else
  (void)grid, (void)low_in_world, (void)high_in_world, (void)most_evidence;
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

void add_known_walls(const OccupancyGrid& grid, const Pose2& world_from_robot, const LocalMapParams& params,
                     std::vector<ObstaclePoint>& obstacles) {
  const Eigen::Vector2d robot = world_from_robot.position();
  const Eigen::Vector2d reach(params.radius, params.radius);
  const Cell low = grid.geometry.cell_at(robot - reach);
  const Cell high = grid.geometry.cell_at(robot + reach);
  const int first_row = std::max(0, low.row);
  const int last_row = std::min(grid.geometry.rows - 1, high.row);
  const int first_column = std::max(0, low.column);
  const int last_column = std::min(grid.geometry.columns - 1, high.column);
  if (first_row > last_row || first_column > last_column) {
    return;
  }
  const auto rows = static_cast<std::size_t>(last_row - first_row + 1);
  const auto words = static_cast<std::size_t>((last_column - first_column) / kInner + 1);
  std::array<std::uint64_t, 128> few_faces;
  std::vector<std::uint64_t> many_faces(rows * words > few_faces.size() ? rows * words : 0);
  std::uint64_t* const faces = many_faces.empty() ? few_faces.data() : many_faces.data();
  const auto word_at = [&](std::size_t i) {
    const int column = first_column + kInner * static_cast<int>(i);
    return WordColumn{column, std::min(kInner, last_column + 1 - column)};
  };
  for (std::size_t i = 0; i < words; ++i) {
    const WordColumn word = word_at(i);
    const bool is_narrow = word.count + 2 <= 3 * kGroup;
    (is_narrow ? find_faces<3> : find_faces<4>)(grid, word, first_row, last_row, words, faces + i);
  }
  const Pose2 robot_from_world = world_from_robot.inverse();
  const double c = std::cos(robot_from_world.theta);
  const double s = std::sin(robot_from_world.theta);
  const double half_cell = 0.5 * grid.geometry.resolution;
  // squares this near to the radius's are left to the square root
  const double surely_inside = (1.0 - 1e-12) * params.radius * params.radius;
  const double surely_outside = (1.0 + 1e-12) * params.radius * params.radius;
  FaceColumns columns;
  const auto look_along = [&](const WordColumn& word) {
    for (int k = 0; k < word.count; ++k) {
      const double centre_x = grid.geometry.origin.x() + (word.first_column + k + 0.5) * grid.geometry.resolution;
      const double face_x = towards(robot.x(), centre_x, half_cell);
      const double away_x = face_x - robot.x();
      const auto bit = static_cast<std::size_t>(k + 1);
      columns.square[bit] = away_x * away_x;
      columns.x_by_face[bit] = robot_from_world.x + c * face_x;
      columns.y_by_face[bit] = robot_from_world.y + s * face_x;
    }
  };
  const auto add_faces = [&](std::uint64_t bits, int row) {
    const double centre_y = grid.geometry.origin.y() + (row + 0.5) * grid.geometry.resolution;
    const double face_y = towards(robot.y(), centre_y, half_cell);
    const double away_y = face_y - robot.y();
    const double square_y = away_y * away_y;
    const double x_by_row = s * face_y;
    const double y_by_row = c * face_y;
    for (; bits != 0; bits &= bits - 1) {
      const auto bit = static_cast<std::size_t>(std::countr_zero(bits));
      const double squared = columns.square[bit] + square_y;
      if (squared < surely_inside || (squared <= surely_outside && std::sqrt(squared) <= params.radius)) {
        ObstaclePoint& wall = obstacles.emplace_back();  // in its place: a copy would wait for its parts
        wall.position = {columns.x_by_face[bit] - x_by_row, columns.y_by_face[bit] + y_by_row};
        wall.is_known = true;
      }
    }
  };
  if (words == 1) {
    look_along(word_at(0));
  }
  for (std::size_t k = 0; k < rows * words; ++k) {
    if (faces[k] != 0) {
      if (words > 1) {
        look_along(word_at(k % words));
      }
      add_faces(faces[k], first_row + static_cast<int>(k / words));
    }
  }
}

std::vector<ObstaclePoint> known_walls(const OccupancyGrid& grid, const Pose2& world_from_robot,
                                       const LocalMapParams& params) {
  std::vector<ObstaclePoint> walls;
  walls.reserve(256);
  add_known_walls(grid, world_from_robot, params, walls);
  return walls;
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
  for (double way = 0.0; way <= length; way += 0.5 * grid.geometry.resolution) {
    for (const double side : std::array{-params.half_width, 0.0, params.half_width}) {
      const Eigen::Vector2d point = from_in_world + way * along + side * across;
      // beside the robot itself the line does not ask: it stands there already
      if ((side == 0.0 || way > 0.2) && is_occupied(grid, grid.geometry.cell_at(point), params)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace luminav
