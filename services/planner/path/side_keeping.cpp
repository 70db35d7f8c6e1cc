#include "services/planner/path/side_keeping.hpp"

#include <algorithm>
#include <cmath>

#include "services/planner/path/path_shaping.hpp"

namespace luminav {
namespace {

constexpr double kNarrowest = 0.7;    // [m] of room for the middle of the robot: from here on a little to the side,
constexpr double kForTwo = 1.0;       // [m] and from here on wholly: two of 0.45 m pass each other
constexpr double kWidest = 3.6;       // [m] what is wider is a hall, where nobody expects a side to be kept
constexpr double kShare = 1.0 / 6.0;  // of that room to the near side, the other one's to the far side
constexpr double kAlong = 1.5;        // [m] before and behind: a door that stands open there is no end of the corridor
constexpr double kSlope = 0.2;        // of the way to the side: 2 % longer
constexpr double kLonger = 1.05;      // round corners, where the outer side is the one to keep to
constexpr int kTries = 6;             // each with half of what failed

/// Room for the middle of the robot, from a point of a path to both sides [m].
struct Room {
  double near = 0.0;
  double far = 0.0;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Free length [m] from a point in a direction, at most kSideReach.
double room_along(const ConfigurationSpace& space, const Eigen::Vector2d& from, const Eigen::Vector2d& direction) {
  const double step = 0.5 * space.geometry().resolution;
  double length = 0.0;
  while (length < kSideReach && !space.is_blocked(space.geometry().cell_at(from + (length + step) * direction))) {
    length += step;
  }
  return length;
}

/// Towards the side, at each point of a path.
std::vector<Eigen::Vector2d> normals_of(const Polyline& path, KeepSide side) {
  std::vector<Eigen::Vector2d> normals;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Eigen::Vector2d along = path[std::min(i + 2, path.size() - 1)] - path[i < 2 ? 0 : i - 2];
    const Eigen::Vector2d left = Eigen::Vector2d(-along.y(), along.x()) / std::max(along.norm(), 1e-9);
    normals.push_back(side == KeepSide::kLeft ? left : Eigen::Vector2d(-left));
  }
  return normals;
}

/// How far [m] each point would go to the side were it alone.
std::vector<double> wishes_of(const std::vector<Room>& rooms, std::size_t window) {
  std::vector<double> wishes(rooms.size(), 0.0);
  for (std::size_t i = 0; i < rooms.size(); ++i) {
    std::vector<double> near, width;
    for (std::size_t k = i < window ? 0 : i - window; k <= std::min(i + window, rooms.size() - 1); ++k) {
      near.push_back(rooms[k].near);
      width.push_back(rooms[k].near + rooms[k].far);
    }
    const double corridor = median(width);
    const double share =
        corridor <= kWidest ? std::clamp((corridor - kNarrowest) / (kForTwo - kNarrowest), 0.0, 1.0) : 0.0;
    wishes[i] = share * std::max(0.0, std::min(rooms[i].near, median(near)) - kShare * corridor);
  }
  return wishes;
}

/// The most of the wishes that a path can follow at a gentle angle, nothing at its ends.
std::vector<double> gentle(std::vector<double> wishes, const Polyline& path) {
  wishes.front() = wishes.back() = 0.0;
  for (std::size_t i = 1; i < wishes.size(); ++i) {
    wishes[i] = std::min(wishes[i], wishes[i - 1] + kSlope * (path[i] - path[i - 1]).norm());
  }
  for (std::size_t i = wishes.size() - 1; i > 0; --i) {
    wishes[i - 1] = std::min(wishes[i - 1], wishes[i] + kSlope * (path[i] - path[i - 1]).norm());
  }
  return wishes;
}

Polyline moved_by(const std::vector<double>& offsets, const std::vector<Eigen::Vector2d>& normals, Polyline path) {
  for (std::size_t i = 0; i < path.size(); ++i) {
    path[i] += offsets[i] * normals[i];
  }
  return path;
}

/// Halves the wishes at pieces that are not clear; false where all are.
bool lessen_where_blocked(const ConfigurationSpace& space, const Polyline& moved, std::vector<double>& wishes) {
  bool is_blocked = false;
  for (std::size_t i = 1; i < moved.size(); ++i) {
    if (!is_clear(space, moved[i - 1], moved[i])) {
      is_blocked = true;
      wishes[i - 1] *= 0.5;
      wishes[i] *= 0.5;
    }
  }
  return is_blocked;
}

}  // namespace

Polyline keep_to_side(const ConfigurationSpace& space, KeepSide side, const Polyline& path) {
  if (side == KeepSide::kNone || path.size() < 3) {
    return path;
  }
  const std::vector<Eigen::Vector2d> normals = normals_of(path, side);
  std::vector<Room> rooms;
  for (std::size_t i = 0; i < path.size(); ++i) {
    rooms.push_back({room_along(space, path[i], normals[i]), room_along(space, path[i], -normals[i])});
  }
  const double length = polyline_length(path);
  const double spacing = length / static_cast<double>(path.size() - 1);
  std::vector<double> wishes = wishes_of(rooms, static_cast<std::size_t>(kAlong / std::max(spacing, 0.01)));
  for (int i = 0; i < kTries; ++i) {
    const Polyline moved = moved_by(gentle(wishes, path), normals, path);
    if (lessen_where_blocked(space, moved, wishes)) {
      continue;
    }
    const Polyline even = resampled(moved, spacing);
    if (is_clear(space, even) && polyline_length(even) <= kLonger * length) {
      return even;
    }
    std::transform(wishes.begin(), wishes.end(), wishes.begin(), [](double wish) { return 0.5 * wish; });
  }
  return path;
}

}  // namespace luminav
