#include "drivers/simulator/world/obstacle_placement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr int kTries = 5000;
constexpr double kFromPoints = 1.0;                  // [m] to the start and to goals
constexpr double kFromLines = 0.35;                  // [m] to the line that a person's centre walks along
constexpr double kGap = 0.9;                         // [m] beside an obstacle that stands free
constexpr double kTouch = 1e-6;                      // [m]
constexpr double kAgainstWall = 0.10;                // [m] at most, of an obstacle that stands against a wall
constexpr double kWindow = 1.5;                      // [m] round an inflated obstacle in which passages are checked
constexpr double kSliver = 0.2;                      // [m^2] of configuration space that may be cut off in a corner
constexpr double kRadii[] = {kPassage, 0.40, 0.45};  // [m] of robots that must still get through

/// True when all of a convex polygon, border and inside, is at least `gap` [m] from what is not free, within a cell.
bool keeps_distance(const DistanceField& walls, const Polygon& outline, double gap) {
  Vector2d centre = Vector2d::Zero();
  for (const Vector2d& corner : outline) {
    centre += corner / static_cast<double>(outline.size());
  }
  const double spacing = walls.geometry().resolution;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vector2d edge = outline[(i + 1) % outline.size()] - outline[i];
    const int along = 1 + static_cast<int>(edge.norm() / spacing);
    for (int j = 0; j < along; ++j) {
      const Vector2d border = outline[i] + edge * (static_cast<double>(j) / along);
      const int inward = 1 + static_cast<int>((centre - border).norm() / spacing);
      for (int k = 0; k < inward; ++k) {
        if (walls.at(Vector2d(border + (centre - border) * (static_cast<double>(k) / inward))) < gap) {
          return false;
        }
      }
    }
  }
  return true;
}

/// Direction away from the nearest wall; nothing in the open or on a ridge.
std::optional<double> direction_from_wall(const DistanceField& walls, const Vector2d& point) {
  constexpr double kStep = 0.1;  // [m]
  const Vector2d gradient(walls.at(point + Vector2d(kStep, 0.0)) - walls.at(point - Vector2d(kStep, 0.0)),
                          walls.at(point + Vector2d(0.0, kStep)) - walls.at(point - Vector2d(0.0, kStep)));
  if (gradient.norm() < kStep) {
    return std::nullopt;
  }
  return std::atan2(gradient.y(), gradient.x());
}

/// The pose moved towards the wall until the obstacle nearly touches it; nothing when that does not end at a wall.
std::optional<Pose2> against_wall(const DistanceField& walls, const Vector2d& point, const Obstacle& obstacle,
                                  bool turned) {
  const std::optional<double> away = direction_from_wall(walls, point);
  if (!away) {
    return std::nullopt;
  }
  const double theta = wrap_angle(*away + (turned ? 0.0 : 0.5 * kPi));
  const double depth = 0.5 * (turned ? obstacle.length : obstacle.width);
  const double step = 0.5 * walls.geometry().resolution;
  std::optional<Pose2> last;
  for (double moved = 0.0; moved < 3.0; moved += step) {
    const Vector2d centre = point - moved * Vector2d(std::cos(*away), std::sin(*away));
    const Pose2 pose{centre.x(), centre.y(), theta};
    if (!keeps_distance(walls, rectangle(pose, obstacle.length, obstacle.width), kTouch)) {
      break;
    }
    last = pose;
  }
  if (!last) {
    return std::nullopt;
  }
  const Vector2d wall_side = last->position() - depth * Vector2d(std::cos(*away), std::sin(*away));
  return walls.at(wall_side) <= kAgainstWall ? last : std::nullopt;
}

/// True when cells that hung together before do so no more, slivers apart.
bool falls_apart(const std::vector<int>& before, const std::vector<int>& after, std::size_t sliver) {
  std::vector<std::size_t> sizes(after.size());
  std::vector<int> origin(after.size(), -1);
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (after[i] >= 0) {
      ++sizes[static_cast<std::size_t>(after[i])];
      origin[static_cast<std::size_t>(after[i])] = before[i];
    }
  }
  std::vector<bool> has_part(before.size());
  for (std::size_t part = 0; part < sizes.size(); ++part) {
    if (sizes[part] <= sliver) {
      continue;
    }
    const auto whole = static_cast<std::size_t>(origin[part]);
    if (has_part[whole]) {
      return true;
    }
    has_part[whole] = true;
  }
  return false;
}

struct Window {
  GridGeometry geometry;
  std::vector<float> before;  // [m] per cell
  std::vector<float> after;   // [m] per cell
};

std::vector<int> label_window(const GridGeometry& geometry, const std::vector<float>& distances, double radius) {
  std::vector<bool> passes(distances.size());
  std::transform(distances.begin(), distances.end(), passes.begin(), [radius](float d) { return d >= radius; });
  return label_regions(geometry, passes);
}

/// Calls back with each cell within `reach` [m] of the polygon's bounding box and inside the grid.
template <typename Visit>
void visit_cells_around(const GridGeometry& geometry, const Polygon& outline, double reach, Visit visit) {
  Vector2d min = outline.front();
  Vector2d max = outline.front();
  for (const Vector2d& corner : outline) {
    min = min.cwiseMin(corner);
    max = max.cwiseMax(corner);
  }
  const Cell first = geometry.cell_at(min - Vector2d::Constant(reach));
  const Cell last = geometry.cell_at(max + Vector2d::Constant(reach));
  for (int row = std::max(first.row, 0); row <= std::min(last.row, geometry.rows - 1); ++row) {
    for (int column = std::max(first.column, 0); column <= std::min(last.column, geometry.columns - 1); ++column) {
      visit(Cell{column, row});
    }
  }
}

}  // namespace

ObstaclePlacement::ObstaclePlacement(const FreeSpace& space) : space_(space) {
  const GridGeometry& geometry = space.distances().geometry();
  distances_.reserve(geometry.size());
  for (int row = 0; row < geometry.rows; ++row) {
    for (int column = 0; column < geometry.columns; ++column) {
      distances_.push_back(static_cast<float>(space.distances().at(Cell{column, row})));
    }
  }
}

void ObstaclePlacement::add(const Polygon& outline) {
  others_.push_back(outline);
  const GridGeometry& geometry = space_.distances().geometry();
  constexpr double kReach = 1.0;  // [m] more than any radius that is asked for
  visit_cells_around(geometry, outline, kReach, [&](const Cell& cell) {
    float& value = distances_[geometry.index(cell)];
    value = std::min(value, static_cast<float>(distance(outline, geometry.centre_of(cell))));
  });
}

bool ObstaclePlacement::is_clear_of_others(const Polygon& outline) const {
  const auto is_near_point = [&](const Vector2d& point) { return distance(outline, point) < kFromPoints; };
  const auto is_near_other = [&](const Polygon& other) { return distance(outline, other) < kGap; };
  const auto is_near_line = [&](const auto& line) {
    return distance(outline, Polygon{line.first, line.second}) < kFromLines;
  };
  return std::none_of(points_.begin(), points_.end(), is_near_point) &&
         std::none_of(others_.begin(), others_.end(), is_near_other) &&
         std::none_of(lines_.begin(), lines_.end(), is_near_line);
}

bool ObstaclePlacement::cuts_a_passage(const Polygon& outline) const {
  const GridGeometry& geometry = space_.distances().geometry();
  Window window;
  Cell first{std::numeric_limits<int>::max(), std::numeric_limits<int>::max()};
  Cell last{-1, -1};
  visit_cells_around(geometry, outline, kWindow, [&](const Cell& cell) {
    first = {std::min(first.column, cell.column), std::min(first.row, cell.row)};
    last = {std::max(last.column, cell.column), std::max(last.row, cell.row)};
    const float before = distances_[geometry.index(cell)];
    window.before.push_back(before);
    window.after.push_back(std::min(before, static_cast<float>(distance(outline, geometry.centre_of(cell)))));
  });
  window.geometry = geometry;
  window.geometry.columns = last.column - first.column + 1;
  window.geometry.rows = last.row - first.row + 1;
  const auto sliver = static_cast<std::size_t>(kSliver / (geometry.resolution * geometry.resolution));
  return std::any_of(std::begin(kRadii), std::end(kRadii), [&](double radius) {
    return falls_apart(label_window(window.geometry, window.before, radius),
                       label_window(window.geometry, window.after, radius), sliver);
  });
}

Pose2 ObstaclePlacement::draw(const Obstacle& obstacle, RandomStream& random) {
  const DistanceField& walls = space_.distances();
  for (int i = 0; i < kTries; ++i) {
    const Vector2d point = space_.draw_point(kPassage, random.generator());
    const double theta = random.uniform(-kPi, kPi);
    const bool turned = random.happens(0.5);
    std::optional<Pose2> pose;
    if (random.happens(0.5)) {
      pose = against_wall(walls, point, obstacle, turned);
    } else if (keeps_distance(walls, rectangle({point.x(), point.y(), theta}, obstacle.length, obstacle.width), kGap)) {
      pose = Pose2{point.x(), point.y(), theta};
    }
    if (!pose) {
      continue;
    }
    const Polygon outline = rectangle(*pose, obstacle.length, obstacle.width);
    if (is_clear_of_others(outline) && !cuts_a_passage(outline)) {
      add(outline);
      return *pose;
    }
  }
  throw ConfigurationError(fmt::format("no room for an obstacle of {} x {} m that leaves {} m beside it",
                                       obstacle.length, obstacle.width, kGap));
}

}  // namespace luminav
