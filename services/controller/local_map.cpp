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

/// The same of up to 64 cells of a row; outside the grid there is no wall. Bits beyond `count` mean nothing.
std::uint64_t wall_bits(const OccupancyGrid& grid, int row, int first_column, int count) {
  const GridGeometry& geometry = grid.geometry;
  if (row < 0 || row >= geometry.rows) {
    return 0;
  }
  const int groups = (count + kGroup - 1) / kGroup;
  const Prior* cells = grid.prior.data() + geometry.index({0, row});
  std::array<Prior, 64> clipped{};
  if (first_column < 0 || first_column + kGroup * groups > geometry.columns) {
    const int from = std::max(0, first_column);
    const int to = std::min(geometry.columns, first_column + count);
    std::copy(cells + from, cells + std::max(from, to), clipped.data() + (from - first_column));
    cells = clipped.data();
  } else {
    cells += first_column;
  }
  std::uint64_t bits = 0;
  for (int i = 0; i < groups; ++i) {
    bits |= wall_bits_of_group(cells + kGroup * i) << (kGroup * i);
  }
  return bits;
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
  const PointTransform robot_from_world(world_from_robot.inverse());
  const double half_cell = 0.5 * grid.geometry.resolution;
  // squares this near to the radius's are left to the square root
  const double surely_inside = (1.0 - 1e-12) * params.radius * params.radius;
  const double surely_outside = (1.0 + 1e-12) * params.radius * params.radius;
  // the wall's face may be anywhere in the cell: take the side towards the robot
  const auto towards = [&](double robot_at, double centre) {
    return std::min(std::max(robot_at, centre - half_cell), centre + half_cell);
  };
  const auto add_cells = [&](std::uint64_t cells, int row, int column) {
    const double face_y = towards(robot.y(), grid.geometry.origin.y() + (row + 0.5) * grid.geometry.resolution);
    const double away_y = face_y - robot.y();
    for (; cells != 0; cells &= cells - 1) {
      const double centre_x =
          grid.geometry.origin.x() + (column + std::countr_zero(cells) + 0.5) * grid.geometry.resolution;
      const double face_x = towards(robot.x(), centre_x);
      const double away_x = face_x - robot.x();
      const double squared = away_x * away_x + away_y * away_y;
      if (squared < surely_inside || (squared <= surely_outside && std::sqrt(squared) <= params.radius)) {
        obstacles.push_back({robot_from_world * Eigen::Vector2d(face_x, face_y), 0.0, 0.0, true});
      }
    }
  };
  // words of 64 cells, of which the first and the last belong to the words beside
  constexpr int kInner = 62;
  const auto words = static_cast<std::size_t>((last_column - first_column) / kInner + 1);
  std::vector<std::uint64_t> walls(3 * words);
  std::uint64_t* below = walls.data();
  std::uint64_t* here = below + words;
  std::uint64_t* above = here + words;
  const auto read = [&](int row, std::uint64_t* bits) {
    for (std::size_t i = 0; i < words; ++i) {
      const int column = first_column - 1 + kInner * static_cast<int>(i);
      bits[i] = wall_bits(grid, row, column, std::min(64, last_column + 2 - column));
    }
  };
  read(first_row - 1, below);
  read(first_row, here);
  for (int row = first_row; row <= last_row; ++row) {
    read(row + 1, above);
    for (std::size_t i = 0; i < words; ++i) {
      // the inside of a thick wall is behind its face
      const std::uint64_t inside = here[i] << 1 & here[i] >> 1 & below[i] & above[i];
      const int column = first_column - 1 + kInner * static_cast<int>(i);
      const int count = std::min(kInner, last_column - column);
      const std::uint64_t asked = ((std::uint64_t{1} << count) - 1) << 1;
      const std::uint64_t faces = here[i] & ~inside & asked;
      if (faces != 0) {
        add_cells(faces, row, column);
      }
    }
    std::uint64_t* const free = below;
    below = here;
    here = above;
    above = free;
  }
}

std::vector<ObstaclePoint> known_walls(const OccupancyGrid& grid, const Pose2& world_from_robot,
                                       const LocalMapParams& params) {
  std::vector<ObstaclePoint> walls;
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
