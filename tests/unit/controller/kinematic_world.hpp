#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <random>
#include <string>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/geometry/pose2.hpp"
#include "services/controller/safety/footprint.hpp"

namespace luminav::testing {

/// Somebody who walks to and fro between two points and stops 0.1 m before touching the robot.
struct Walker {
  Eigen::Vector2d from;
  Eigen::Vector2d to;
  double speed = 0.8;         // [m/s]
  double wait_until = 0.0;    // [s] stands at `from` before
  bool stays_at_end = false;  // does not walk back
  Eigen::Vector2d position = from;
  bool is_returning = false;
  double patience = 5.0;  // [s] of waiting for the robot before walking back
  double waiting = 0.0;   // [s]
};

/// A small world to drive a controller in: walls drawn as text ('#' = solid, a character is `cell` metres wide and
/// high, the last line is the south), boxes and people that no map knows, a differential drive with acceleration limits
/// and delay, odometry that drifts, and sonars as cones that lose smooth walls seen at a slant. Far simpler than the
/// simulator; it exists so that control can be tested without it.
class KinematicWorld {
 public:
  static constexpr double kCell = 0.3;           // [m] three of them are a door
  static constexpr double kPersonRadius = 0.25;  // [m]

  KinematicWorld(const RobotDescription& robot, const std::vector<std::string>& rows, unsigned seed = 1)
      : robot_(robot), footprint_(robot.footprint), rows_(rows), random_(seed) {
    std::reverse(rows_.begin(), rows_.end());
    for (int row = 0; row <= row_count(); ++row) {
      for (int column = 0; column <= column_count(); ++column) {
        add_walls_of(column, row);
      }
    }
    wall_segments_ = segments_.size();
  }

  void add_box(const Eigen::Vector2d& centre, double length, double width, double theta = 0.0) {
    const Pose2 world_from_box{centre.x(), centre.y(), theta};
    std::vector<Eigen::Vector2d> corners;
    for (const auto& [x, y] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
      corners.push_back(world_from_box * Eigen::Vector2d(x * length, y * width));
      corners_.push_back(corners.back());
    }
    for (std::size_t i = 0; i < 4; ++i) {
      segments_.push_back({corners[i], corners[(i + 1) % 4]});
    }
    boxes_.push_back({world_from_box, length, width});
  }
  void remove_boxes() {
    segments_.resize(wall_segments_);
    corners_.clear();
    boxes_.clear();
  }
  void add_walker(const Walker& walker) { walkers_.push_back(walker); }
  std::vector<Walker>& walkers() { return walkers_; }

  /// The building's map: walls only, 0.1 m cells.
  [[nodiscard]] OccupancyGrid map() const { return grid_with(false); }
  /// Walls, and the boxes within a distance of the robot as evidence: what a mapper would have seen.
  [[nodiscard]] OccupancyGrid map_with_boxes_seen() const { return grid_with(true); }

  void place_robot(const Pose2& pose) { truth_ = pose; }
  [[nodiscard]] const Pose2& truth() const { return truth_; }
  [[nodiscard]] const Pose2& odometry() const { return odometry_; }
  [[nodiscard]] const DriveTwist& twist() const { return twist_; }
  [[nodiscard]] int contacts() const { return contacts_; }
  [[nodiscard]] double min_clearance() const { return min_clearance_; }
  [[nodiscard]] double time() const { return time_; }
  /// From the true outline to the nearest wall, box or person [m].
  [[nodiscard]] double clearance() const { return std::min(clearance_to_things(truth_), clearance_to_people(truth_)); }

  /// Goes on by `duration` [s] with a command that takes effect after `delay` [s].
  void step(double duration, const DriveTwist& command, double delay = 0.08) {
    time_ += duration;
    pending_.push_back({time_ + delay, command});
    while (!pending_.empty() && pending_.front().due <= time_) {
      in_force_ = pending_.front().command;
      pending_.pop_front();
    }
    drive(duration);
    for (Walker& walker : walkers_) {
      walk(walker, duration);
    }
    min_clearance_ = std::min(min_clearance_, clearance());
  }

  /// One pulse of a disc [m]; the maximum range where nothing echoes.
  double sonar(std::size_t disc) {
    const Pose2 place = truth_ * robot_.sonar.robot_from_sonar[disc];
    double nearest = robot_.sonar.maximum_range;
    constexpr int kRays = 11;
    for (int i = 0; i < kRays; ++i) {
      const double off_axis = robot_.sonar.half_angle * (2.0 * i / (kRays - 1) - 1.0);
      const Eigen::Vector2d direction(std::cos(place.theta + off_axis), std::sin(place.theta + off_axis));
      nearest = std::min(nearest, heard_along(place.position(), direction, off_axis, nearest));
    }
    std::vector<Eigen::Vector2d> corners = wall_corners_;
    corners.insert(corners.end(), corners_.begin(), corners_.end());
    for (const Eigen::Vector2d& corner : corners) {
      const Eigen::Vector2d offset = place.inverse() * corner;
      const double range = offset.norm();
      const double off_axis = std::atan2(offset.y(), offset.x());
      if (range < nearest && std::abs(off_axis) < robot_.sonar.half_angle &&
          0.25 * beam(off_axis, range) > kThreshold &&
          nearest_segment(place.position(), (corner - place.position()) / range).range > range - 0.01) {
        nearest = range;
      }
    }
    std::normal_distribution<double> noise(0.0, 0.005);
    std::uniform_real_distribution<double> chance;
    if (chance(random_) < 0.015 || nearest >= robot_.sonar.maximum_range) {
      return robot_.sonar.maximum_range;
    }
    return std::max(robot_.sonar.minimum_range, nearest + noise(random_));
  }

 private:
  static constexpr double kThreshold = 0.12;  // echoes weaker than this are not heard

  struct Segment {
    Eigen::Vector2d start;
    Eigen::Vector2d end;
  };
  struct Hit {
    double range = 1e9;      // [m]
    double incidence = 0.0;  // [rad]
  };
  struct Box {
    Pose2 pose;
    double length = 0.0;
    double width = 0.0;
  };
  struct Pending {
    double due = 0.0;  // [s]
    DriveTwist command;
  };

  [[nodiscard]] int row_count() const { return static_cast<int>(rows_.size()); }
  [[nodiscard]] int column_count() const { return static_cast<int>(rows_.front().size()); }
  [[nodiscard]] bool is_solid(int column, int row) const {
    if (row < 0 || column < 0 || row >= row_count() || column >= column_count()) {
      return false;
    }
    return rows_[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] == '#';
  }
  void add_walls_of(int column, int row) {
    const Eigen::Vector2d corner(column * kCell, row * kCell);
    if (is_solid(column, row) != is_solid(column, row - 1)) {
      segments_.push_back({corner, corner + Eigen::Vector2d(kCell, 0.0)});
    }
    if (is_solid(column, row) != is_solid(column - 1, row)) {
      segments_.push_back({corner, corner + Eigen::Vector2d(0.0, kCell)});
    }
    const int solid = static_cast<int>(is_solid(column, row)) + static_cast<int>(is_solid(column - 1, row)) +
                      static_cast<int>(is_solid(column, row - 1)) + static_cast<int>(is_solid(column - 1, row - 1));
    if (solid == 1) {
      wall_corners_.push_back(corner);
    }
  }

  [[nodiscard]] OccupancyGrid grid_with(bool boxes) const {
    GridGeometry geometry;
    geometry.resolution = 0.1;
    geometry.columns = 3 * column_count();
    geometry.rows = 3 * row_count();
    OccupancyGrid grid(geometry);
    for (int row = 0; row < geometry.rows; ++row) {
      for (int column = 0; column < geometry.columns; ++column) {
        const std::size_t index = geometry.index({column, row});
        grid.prior[index] = is_solid(column / 3, row / 3) ? Prior::kOccupied : Prior::kFree;
        for (const Box& box : boxes_) {
          const Eigen::Vector2d inside = box.pose.inverse() * geometry.centre_of({column, row});
          const bool in_box =
              std::abs(inside.x()) < 0.5 * box.length + 0.05 && std::abs(inside.y()) < 0.5 * box.width + 0.05;
          if (boxes && in_box && (box.pose.position() - truth_.position()).norm() < 1.6) {
            grid.evidence[index] = 60;
          }
        }
      }
    }
    return grid;
  }

  static double beam(double off_axis, double range) {
    const double angle = off_axis / radians(9.0);
    return std::exp(-0.5 * angle * angle - range / 4.0);
  }
  [[nodiscard]] Hit nearest_segment(const Eigen::Vector2d& origin, const Eigen::Vector2d& direction) const {
    Hit hit;
    for (const Segment& segment : segments_) {
      const Eigen::Vector2d edge = segment.end - segment.start;
      const double determinant = direction.x() * edge.y() - direction.y() * edge.x();
      if (std::abs(determinant) < 1e-12) {
        continue;
      }
      const Eigen::Vector2d offset = segment.start - origin;
      const double range = (offset.x() * edge.y() - offset.y() * edge.x()) / determinant;
      const double share = (offset.x() * direction.y() - offset.y() * direction.x()) / determinant;
      if (range > 0.0 && range < hit.range && share >= 0.0 && share <= 1.0) {
        const Eigen::Vector2d normal = Eigen::Vector2d(edge.y(), -edge.x()).normalized();
        hit = {range, std::acos(std::min(1.0, std::abs(direction.dot(normal))))};
      }
    }
    return hit;
  }
  [[nodiscard]] double heard_along(const Eigen::Vector2d& origin, const Eigen::Vector2d& direction, double off_axis,
                                   double nearest) const {
    const Hit wall = nearest_segment(origin, direction);
    const double mirror = std::clamp((radians(27.0) - wall.incidence) / radians(12.0), 0.0, 1.0);
    double heard = wall.range < nearest && beam(off_axis, wall.range) * mirror > kThreshold ? wall.range : nearest;
    for (const Walker& walker : walkers_) {
      const Eigen::Vector2d offset = walker.position - origin;
      const double along = offset.dot(direction);
      const double across = std::abs(offset.x() * direction.y() - offset.y() * direction.x());
      if (along > 0.0 && across < kPersonRadius) {
        const double range = along - std::sqrt(kPersonRadius * kPersonRadius - across * across);
        if (range < std::min(heard, wall.range) && 0.5 * beam(off_axis, range) > kThreshold) {
          heard = std::max(0.0, range);
        }
      }
    }
    return heard;
  }

  [[nodiscard]] double clearance_to_people(const Pose2& robot) const {
    double nearest = 10.0;
    for (const Walker& walker : walkers_) {
      nearest = std::min(nearest, footprint_.distance(robot.inverse() * walker.position) - kPersonRadius);
    }
    return nearest;
  }
  [[nodiscard]] double clearance_to_things(const Pose2& robot) const {
    double nearest = 10.0;
    const Pose2 robot_from_world = robot.inverse();
    for (const Segment& segment : segments_) {
      if ((segment.start - robot.position()).norm() > 2.0 && (segment.end - robot.position()).norm() > 2.0) {
        continue;
      }
      constexpr int kPoints = 8;
      for (int i = 0; i <= kPoints; ++i) {
        const Eigen::Vector2d point = segment.start + (segment.end - segment.start) * i / kPoints;
        nearest = std::min(nearest, footprint_.distance(robot_from_world * point));
      }
    }
    return nearest;
  }

  void drive(double duration) {
    const auto slew = [duration](double now, double wanted, double up, double down) {
      const bool faster = std::abs(wanted) > std::abs(now) && wanted * now >= 0.0;
      const double max = (faster ? up : down) * duration;
      return now + std::clamp(wanted - now, -max, max);
    };
    const MotionLimits& limits = robot_.limits;
    twist_.linear = slew(twist_.linear, in_force_.linear, limits.linear_acceleration, limits.linear_deceleration);
    twist_.angular = slew(twist_.angular, in_force_.angular, limits.angular_acceleration, limits.angular_acceleration);
    const bool moves = std::abs(twist_.linear) > 0.02 || std::abs(twist_.angular) > 0.02;
    if (moves) {
      standing_since_ = time_;
    }
    const Pose2 next = truth_ * drive_arc(twist_, duration);
    const double before = std::min(clearance_to_things(truth_), clearance_to_people(truth_));
    const double after = std::min(clearance_to_things(next), clearance_to_people(next));
    if (after <= 0.0 && after < before) {
      contacts_ += is_touching_ ? 0 : 1;
      is_touching_ = true;
      twist_ = {};
      return;
    }
    is_touching_ = is_touching_ && after <= 0.02;
    truth_ = next;
    std::normal_distribution<double> normal;
    const double distance = std::abs(twist_.linear) * duration;
    const double angle = radians(0.5) * std::sqrt(distance) * normal(random_);
    odometry_ = odometry_ * drive_arc({1.01 * twist_.linear, 0.99 * twist_.angular}, duration) * Pose2{0.0, 0.0, angle};
  }
  void walk(Walker& walker, double duration) {
    if (time_ < walker.wait_until) {
      return;
    }
    const Eigen::Vector2d target = walker.is_returning ? walker.from : walker.to;
    const Eigen::Vector2d offset = target - walker.position;
    if (offset.norm() < 0.05) {
      walker.is_returning = walker.stays_at_end ? walker.is_returning : !walker.is_returning;
      return;
    }
    const Eigen::Vector2d next = walker.position + offset.normalized() * walker.speed * duration;
    const double now_apart = footprint_.distance(truth_.inverse() * walker.position) - kPersonRadius;
    const double then_apart = footprint_.distance(truth_.inverse() * next) - kPersonRadius;
    if (then_apart < 0.1 && then_apart < now_apart) {
      walker.waiting += duration;
      if (walker.waiting > walker.patience) {
        walker.waiting = 0.0;
        walker.is_returning = !walker.is_returning;
      }
      return;
    }
    walker.waiting = 0.0;
    walker.position = next;
  }

  RobotDescription robot_;
  Footprint footprint_;
  std::vector<std::string> rows_;  // from the south
  std::mt19937 random_;
  std::vector<Segment> segments_;
  std::size_t wall_segments_ = 0;
  std::vector<Eigen::Vector2d> wall_corners_;
  std::vector<Eigen::Vector2d> corners_;
  std::vector<Box> boxes_;
  std::vector<Walker> walkers_;
  std::deque<Pending> pending_;
  DriveTwist in_force_;
  DriveTwist twist_;
  Pose2 truth_;
  Pose2 odometry_;
  double time_ = 0.0;            // [s]
  double standing_since_ = 0.0;  // [s]
  double min_clearance_ = 10.0;  // [m]
  int contacts_ = 0;
  bool is_touching_ = false;
};

}  // namespace luminav::testing
