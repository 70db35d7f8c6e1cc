#include "services/controller/safety/zones.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace luminav {
namespace {

constexpr double kSpacing = 0.05;  // [m] between points of an edge: the margin before a wall is as wide

constexpr double kAhead = 0.3;  // [s] for which a twist is looked at

/// Whether the robot's middle gets away from a zone. Beside a corner the outline may reach in a little deeper
/// meanwhile.
bool leads_away(const Zone& zone, const Pose2& world_from_robot, const DriveTwist& twist) {
  constexpr double kSteepest = 0.3;  // of what is driven
  const double gained = distance_to_edge(zone.polygon, (world_from_robot * drive_arc(twist, kAhead)).position()) -
                        distance_to_edge(zone.polygon, world_from_robot.position());
  return gained > kSteepest * kAhead * std::abs(twist.linear) && twist.linear != 0.0;
}

/// How far [m] a zone is ahead, where `sign` is 1, or behind; nothing where it is farther than anybody brakes.
std::optional<double> distance_ahead(const Zone& zone, const Pose2& world_from_robot, double sign) {
  constexpr int kSteps = 20;
  for (int i = 0; i <= kSteps; ++i) {
    if (contains(zone.polygon, world_from_robot * Eigen::Vector2d(sign * kSpacing * i, 0.0))) {
      return kSpacing * i;
    }
  }
  return std::nullopt;
}

}  // namespace

Zones::Zones(const std::vector<Zone>& zones, Polygon outline) : outline_(std::move(outline)) {
  for (const Eigen::Vector2d& corner : outline_) {
    reach_ = std::max(reach_, corner.norm());
  }
  for (const Zone& zone : zones) {
    if (zone.kind == ZoneKind::kKeepOut) {
      keep_out_.push_back({zone, edge_points(zone.polygon, kSpacing)});
    } else if (zone.kind == ZoneKind::kOneWay) {
      lanes_.push_back({zone, std::nullopt});
    } else {
      others_.push_back(zone);
    }
  }
}

std::size_t Zones::add_edges(const Pose2& world_from_robot, double radius, std::vector<Eigen::Vector2d>& points) const {
  const Eigen::Vector2d robot = world_from_robot.position();
  const Pose2 robot_from_world = world_from_robot.inverse();
  const std::size_t before = points.size();
  for (const KeepOut& area : keep_out_) {
    if (contains(area.zone.polygon, robot) || depth_inside(area.zone, world_from_robot) > 0.0) {
      continue;
    }
    for (const Eigen::Vector2d& point : area.edge) {
      if ((point - robot).squaredNorm() <= radius * radius) {
        points.push_back(robot_from_world * point);
      }
    }
  }
  return points.size() - before;
}

double Zones::depth_inside(const Zone& zone, const Pose2& world_from_robot) const {
  if (distance_to_edge(zone.polygon, world_from_robot.position()) > reach_) {
    return 0.0;  // of a zone whose edge is far the robot is wholly inside or outside: `contains` knows
  }
  Polygon outline;
  for (const Eigen::Vector2d& corner : outline_) {
    outline.push_back(world_from_robot * corner);
  }
  return overlap_depth(outline, zone.polygon, kSpacing);
}

double Zones::depth_of_edge(const Zone& zone, const Pose2& world_from_robot) const {
  return contains(zone.polygon, world_from_robot.position()) ? 0.0 : depth_inside(zone, world_from_robot);
}

DriveTwist Zones::no_deeper(const Pose2& world_from_robot, const DriveTwist& twist) const {
  constexpr double kAsDeep = 1e-4;  // [m] rounding: what is let through adds up, step by step
  DriveTwist kept = twist;
  for (const KeepOut& area : keep_out_) {
    const double depth = depth_of_edge(area.zone, world_from_robot);
    if (depth == 0.0) {
      continue;
    }
    const std::array<DriveTwist, 4> parts = {{kept, {kept.linear, 0.0}, {0.0, kept.angular}, {}}};
    kept = *std::find_if(parts.begin(), parts.end(), [&](const DriveTwist& part) {
      return depth_inside(area.zone, world_from_robot * drive_arc(part, kAhead)) <= depth + kAsDeep ||
             leads_away(area.zone, world_from_robot, part);
    });
  }
  return kept;
}

std::string Zones::keep_out_at(const Pose2& world_from_robot) const {
  const auto inside = std::find_if(keep_out_.begin(), keep_out_.end(), [&](const KeepOut& area) {
    return contains(area.zone.polygon, world_from_robot.position());
  });
  return inside == keep_out_.end() ? "" : inside->zone.name;
}

bool Zones::is_line_free(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double distance) const {
  const Eigen::Vector2d along = to - from;
  const double length = std::max(along.norm(), 1e-6);
  return std::none_of(keep_out_.begin(), keep_out_.end(), [&](const KeepOut& area) {
    return !contains(area.zone.polygon, from) &&
           std::any_of(area.edge.begin(), area.edge.end(), [&](const Eigen::Vector2d& point) {
             const double part = std::clamp((point - from).dot(along) / (length * length), 0.0, 1.0);
             return (point - from - part * along).norm() < distance;
           });
  });
}

void Zones::note_progress(const Eigen::Vector2d& robot) {
  for (Lane& lane : lanes_) {
    if (!contains(lane.zone.polygon, robot)) {
      lane.farthest.reset();
      continue;
    }
    const double along = robot.dot(direction_of(lane.zone));
    lane.farthest = std::max(lane.farthest.value_or(along), along);
  }
}

std::optional<Zones::LaneRoom> Zones::room_against(const Pose2& world_from_robot, double linear) const {
  // no path leads against: this is room to steer by, round a post or back to a door that it passed
  constexpr double kSteepest = 0.5;  // sine of 30 degrees
  constexpr double kRoom = 0.06;     // [m]
  const double sign = linear < 0.0 ? -1.0 : 1.0;
  std::optional<LaneRoom> least;
  for (const Lane& lane : lanes_) {
    const double back = -sign * std::cos(world_from_robot.theta - lane.zone.direction);
    const std::optional<double> entry =
        back > kLaneAcross ? distance_ahead(lane.zone, world_from_robot, sign) : std::nullopt;
    if (!entry) {
      continue;
    }
    const double along = world_from_robot.position().dot(direction_of(lane.zone));
    const double room =
        lane.farthest && back > kSteepest ? 0.0 : std::max(0.0, kRoom - lane.farthest.value_or(along) + along);
    const double distance = *entry + room / back;
    if (!least || distance < least->distance) {
      least = {&lane.zone, distance};
    }
  }
  return least;
}

std::optional<double> Zones::lane_at(const Eigen::Vector2d& robot) const {
  const auto lane = std::find_if(lanes_.begin(), lanes_.end(),
                                 [&](const Lane& candidate) { return contains(candidate.zone.polygon, robot); });
  return lane == lanes_.end() ? std::nullopt : std::optional(lane->zone.direction);
}

const Zone* Zones::quiet_at(const Pose2& world_from_robot) const {
  return find_zone(others_, ZoneKind::kQuiet, world_from_robot.position());
}

const Zone* Zones::slow_at(const Pose2& world_from_robot, double ahead) const {
  constexpr double kStep = 0.1;       // [m]
  constexpr double kPoseError = 0.1;  // [m] who drives along the edge may be inside
  const int steps = static_cast<int>(std::ceil(std::abs(ahead) / kStep));
  const Zone* slowest = nullptr;
  for (const Zone& zone : others_) {
    for (int i = 0; i <= steps && zone.kind == ZoneKind::kSlow; ++i) {
      const double along = steps == 0 ? 0.0 : ahead * i / steps;
      const Eigen::Vector2d point = world_from_robot * Eigen::Vector2d(along, 0.0);
      const bool is_there = contains(zone.polygon, point) || distance_to_edge(zone.polygon, point) < kPoseError;
      if (is_there && (slowest == nullptr || zone.speed < slowest->speed)) {
        slowest = &zone;
      }
    }
  }
  return slowest;
}

}  // namespace luminav
