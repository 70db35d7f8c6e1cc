#include "tests/evaluation/judge/map_score.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <queue>

#include "tests/evaluation/report/trail_point.hpp"

namespace luminav {
namespace {

constexpr int kOccupiedEvidence = 17;  // log-odds 0.85, probability 0.7
constexpr double kNear = 3.0;          // [m]
constexpr double kCosOblique = 0.5;    // cosine of 60 degrees
constexpr double kViewSpacing = 0.25;  // [m] between the points of a trail that are looked from
constexpr int kMinCells = 50;
constexpr double kRobotRadius = 0.3;  // [m] of what the robot's middle can get to

/// 255 where nothing is, 0 on true surfaces: walls of the map and the obstacles the map doesn't know.
cv::Mat free_image(const WorldTruth& world) {
  const GridGeometry& g = world.walls.geometry;
  cv::Mat image(g.rows, g.columns, CV_8U, cv::Scalar(255));
  for (int row = 0; row < g.rows; ++row) {
    for (int column = 0; column < g.columns; ++column) {
      if (world.walls.cells[g.index({column, row})] == Prior::kOccupied) {
        image.at<std::uint8_t>(row, column) = 0;
      }
    }
  }
  for (const Obstacle& obstacle : world.obstacles) {
    if (!obstacle.world_from_obstacle) {
      continue;
    }
    std::vector<cv::Point> corners;
    for (const auto& [a, b] : {std::pair{0.5, 0.5}, {-0.5, 0.5}, {-0.5, -0.5}, {0.5, -0.5}}) {
      const Cell cell =
          g.cell_at(*obstacle.world_from_obstacle * Eigen::Vector2d(a * obstacle.length, b * obstacle.width));
      corners.emplace_back(cell.column, cell.row);
    }
    cv::fillConvexPoly(image, corners, cv::Scalar(0));
  }
  return image;
}

/// Distance [m] of a place to the nearest face of a wall or box, from either side: the walls of a map are thicker than
/// a cell, and inside of them is not on them. Between the centres of cells it is interpolated.
class FaceDistance {
 public:
  FaceDistance(const cv::Mat& free, const GridGeometry& geometry) : geometry_(geometry) {
    cv::Mat outside;
    cv::Mat inside;
    cv::distanceTransform(free, outside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    cv::distanceTransform(255 - free, inside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    // from a cell's centre to the centre of the first cell on the other side; the face lies half a cell before that
    cv::Mat to_face = outside - inside;
    to_face.forEach<float>([](float& value, const int*) { value += value > 0.0F ? -0.5F : 0.5F; });
    signed_cells_ = to_face;
  }

  [[nodiscard]] double at(const Eigen::Vector2d& place) const {
    const Eigen::Vector2d cell = (place - geometry_.origin) / geometry_.resolution - Eigen::Vector2d(0.5, 0.5);
    const int column = std::clamp(static_cast<int>(std::floor(cell.x())), 0, std::max(0, signed_cells_.cols - 2));
    const int row = std::clamp(static_cast<int>(std::floor(cell.y())), 0, std::max(0, signed_cells_.rows - 2));
    const double fx = std::clamp(cell.x() - column, 0.0, 1.0);
    const double fy = std::clamp(cell.y() - row, 0.0, 1.0);
    const auto value = [&](int r, int c) {
      return static_cast<double>(
          signed_cells_.at<float>(std::min(r, signed_cells_.rows - 1), std::min(c, signed_cells_.cols - 1)));
    };
    const double low = (1.0 - fx) * value(row, column) + fx * value(row, column + 1);
    const double high = (1.0 - fx) * value(row + 1, column) + fx * value(row + 1, column + 1);
    return std::abs((1.0 - fy) * low + fy * high) * geometry_.resolution;
  }

 private:
  GridGeometry geometry_;
  cv::Mat signed_cells_;  // [cells] float, negative inside
};

bool in_sight(const cv::Mat& free, const Cell& from, const Cell& to) {
  const int steps = std::max(std::abs(to.column - from.column), std::abs(to.row - from.row));
  for (int i = 1; i < steps; ++i) {
    const double f = static_cast<double>(i) / steps;
    const int column = static_cast<int>(std::lround(from.column + f * (to.column - from.column)));
    const int row = static_cast<int>(std::lround(from.row + f * (to.row - from.row)));
    if (free.at<std::uint8_t>(row, column) == 0 && std::max(std::abs(column - to.column), std::abs(row - to.row)) > 1) {
      return false;
    }
  }
  return true;
}

/// Whether a surface cell shows a face to what looks at it along `offset` [cells] no more than kOblique off the face's
/// normal: beyond that the sound goes elsewhere.
bool shows_face(const cv::Mat& free, int row, int column, const Eigen::Vector2d& offset) {
  const auto shows = [&](int dr, int dc) {
    return free.at<std::uint8_t>(row + dr, column + dc) != 0 &&
           -offset.dot(Eigen::Vector2d(dc, dr)) >= kCosOblique * offset.norm();
  };
  return shows(-1, 0) || shows(1, 0) || shows(0, -1) || shows(0, 1);
}

/// Marks surface cells of which some point of the trail saw a face from within 3 m and 60 degrees.
cv::Mat faces_passed(const cv::Mat& free, const GridGeometry& g, const std::vector<TrailPoint>& trail) {
  cv::Mat passed(free.size(), CV_8U, cv::Scalar(0));
  const int reach = static_cast<int>(kNear / g.resolution);
  Pose2 last{1e9, 1e9, 0.0};
  for (const TrailPoint& point : trail) {
    if (distance(point.truth, last) < kViewSpacing) {
      continue;
    }
    last = point.truth;
    const Cell here = g.cell_at(point.truth.position());
    for (int row = std::max(1, here.row - reach); row <= std::min(g.rows - 2, here.row + reach); ++row) {
      for (int column = std::max(1, here.column - reach); column <= std::min(g.columns - 2, here.column + reach);
           ++column) {
        const Eigen::Vector2d offset(column - here.column, row - here.row);
        if (free.at<std::uint8_t>(row, column) == 0 && passed.at<std::uint8_t>(row, column) == 0 &&
            offset.norm() <= reach && shows_face(free, row, column, offset) && in_sight(free, here, {column, row})) {
          passed.at<std::uint8_t>(row, column) = 255;
        }
      }
    }
  }
  return passed;
}

double explored_share(const OccupancyGrid& grid, const WorldTruth& world) {
  PriorMap furnished = world.walls;
  const GridGeometry& g = furnished.geometry;
  const cv::Mat free = free_image(world);
  for (std::size_t i = 0; i < furnished.cells.size(); ++i) {
    if (free.data[i] == 0) {
      furnished.cells[i] = Prior::kOccupied;
    }
  }
  const std::vector<bool> reachable = reachable_cells(furnished, world.start.position(), kRobotRadius);
  std::int64_t cells = 0;
  std::int64_t known = 0;
  for (int row = 0; row < g.rows; ++row) {
    for (int column = 0; column < g.columns; ++column) {
      if (reachable[g.index({column, row})]) {
        ++cells;
        const Cell cell = grid.geometry.cell_at(g.centre_of({column, row}));
        known += grid.geometry.contains(cell) && grid.evidence[grid.geometry.index(cell)] <= -kOccupiedEvidence;
      }
    }
  }
  return cells > 0 ? static_cast<double>(known) / static_cast<double>(cells) : 0.0;
}

}  // namespace

MapResult score_map(const OccupancyGrid& grid, const WorldTruth& world, const std::vector<TrailPoint>& trail) {
  const GridGeometry& fine = world.walls.geometry;
  const cv::Mat free = free_image(world);
  const FaceDistance to_face(free, fine);
  std::vector<double> distances;
  std::int64_t free_cells = 0;
  std::int64_t free_right = 0;
  cv::Mat evidence(fine.rows, fine.columns, CV_8U, cv::Scalar(255));  // 0 on occupied evidence
  for (int row = 0; row < grid.geometry.rows; ++row) {
    for (int column = 0; column < grid.geometry.columns; ++column) {
      const int value = grid.evidence[grid.geometry.index({column, row})];
      const Eigen::Vector2d centre = grid.geometry.centre_of({column, row});
      const Cell cell = fine.cell_at(centre);
      if (std::abs(value) < kOccupiedEvidence || !fine.contains(cell)) {
        continue;
      }
      if (value > 0) {
        distances.push_back(to_face.at(centre));
        evidence.at<std::uint8_t>(cell.row, cell.column) = 0;
      } else {
        ++free_cells;
        free_right += free.at<std::uint8_t>(cell.row, cell.column) != 0 ? 1 : 0;
      }
    }
  }
  MapResult result;
  if (static_cast<int>(distances.size()) < kMinCells || free_cells < kMinCells) {
    return result;
  }
  result.measured = true;
  std::nth_element(distances.begin(), distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2),
                   distances.end());
  result.wall_median_m = distances[distances.size() / 2];
  result.free_precision = static_cast<double>(free_right) / static_cast<double>(free_cells);
  result.explored = explored_share(grid, world);
  cv::Mat to_evidence;
  cv::distanceTransform(evidence, to_evidence, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  const cv::Mat passed = faces_passed(free, fine, trail);
  std::int64_t faces = 0;
  std::int64_t found = 0;
  for (int row = 0; row < fine.rows; ++row) {
    for (int column = 0; column < fine.columns; ++column) {
      if (passed.at<std::uint8_t>(row, column) != 0) {
        ++faces;
        // within one cell of the live grid, measured between centres
        found +=
            static_cast<double>(to_evidence.at<float>(row, column)) * fine.resolution <= 1.5 * grid.geometry.resolution
                ? 1
                : 0;
      }
    }
  }
  result.wall_recall = faces > 0 ? static_cast<double>(found) / static_cast<double>(faces) : 0.0;
  return result;
}

namespace {

/// [cells] to the nearest cell that is not free.
cv::Mat clearance_of(const PriorMap& walls) {
  const GridGeometry& g = walls.geometry;
  cv::Mat is_free(g.rows, g.columns, CV_8U);
  for (int row = 0; row < g.rows; ++row) {
    for (int column = 0; column < g.columns; ++column) {
      is_free.at<std::uint8_t>(row, column) = walls.cells[g.index({column, row})] == Prior::kFree ? 255 : 0;
    }
  }
  cv::Mat clearance;
  cv::distanceTransform(is_free, clearance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  return clearance;
}

}  // namespace

double octile_length(const PriorMap& walls, const Eigen::Vector2d& from, const Eigen::Vector2d& to, double radius,
                     const LaneMap& lanes) {
  const GridGeometry& g = walls.geometry;
  const Cell start = g.cell_at(from);
  const Cell goal = g.cell_at(to);
  if (!g.contains(start) || !g.contains(goal)) {
    return -1.0;
  }
  // A*: on a bare floor there is no shorter way to the goal
  const auto at_least = [&goal](const Cell& cell) {
    const int columns = std::abs(cell.column - goal.column);
    const int rows = std::abs(cell.row - goal.row);
    const int shorter = std::min(columns, rows);
    return static_cast<float>(std::max(columns, rows) - shorter) + std::sqrt(2.0F) * static_cast<float>(shorter);
  };
  struct Entry {
    float estimate;
    float reached;
    Cell cell;
    bool operator>(const Entry& other) const { return estimate > other.estimate; }
  };
  const cv::Mat clearance = clearance_of(walls);
  const float min = static_cast<float>(radius / g.resolution);
  std::vector<float> cost(g.size(), std::numeric_limits<float>::infinity());
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  cost[g.index(start)] = 0.0F;
  queue.push({at_least(start), 0.0F, start});
  while (!queue.empty()) {
    const auto [estimate, reached, here] = queue.top();
    queue.pop();
    if (here == goal) {
      return static_cast<double>(reached) * g.resolution;
    }
    const std::size_t index = g.index(here);
    if (reached > cost[index]) {
      continue;
    }
    for (std::size_t i = 0; i < kLaneSteps.size(); ++i) {
      const auto [dc, dr] = kLaneSteps[i];
      const Cell next{here.column + dc, here.row + dr};
      if (!g.contains(next) || (clearance.at<float>(next.row, next.column) < min && !(next == goal)) ||
          !lanes.allows(index, g.index(next), i)) {
        continue;
      }
      const float step = reached + (dr != 0 && dc != 0 ? std::sqrt(2.0F) : 1.0F);
      if (step < cost[g.index(next)]) {
        cost[g.index(next)] = step;
        queue.push({step + at_least(next), step, next});
      }
    }
  }
  return -1.0;
}

std::vector<bool> reachable_cells(const PriorMap& walls, const Eigen::Vector2d& from, double radius,
                                  const LaneMap& lanes) {
  const GridGeometry& g = walls.geometry;
  std::vector<bool> reachable(g.size());
  const Cell start = g.cell_at(from);
  const cv::Mat fits = clearance_of(walls) >= radius / g.resolution;
  if (!g.contains(start) || fits.at<std::uint8_t>(start.row, start.column) == 0) {
    return reachable;
  }
  std::vector<Cell> open{start};
  reachable[g.index(start)] = true;
  while (!open.empty()) {
    const Cell here = open.back();
    open.pop_back();
    for (std::size_t i = 0; i < kLaneSteps.size(); ++i) {
      const Cell next{here.column + kLaneSteps[i].column, here.row + kLaneSteps[i].row};
      if (g.contains(next) && !reachable[g.index(next)] && fits.at<std::uint8_t>(next.row, next.column) != 0 &&
          lanes.allows(g.index(here), g.index(next), i)) {
        reachable[g.index(next)] = true;
        open.push_back(next);
      }
    }
  }
  return reachable;
}

}  // namespace luminav
