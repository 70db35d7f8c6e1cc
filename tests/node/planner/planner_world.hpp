#pragma once

#include <algorithm>
#include <cmath>
#include <lcm/lcm-cpp.hpp>
#include <luminav/control_status_t.hpp>
#include <luminav/goal_t.hpp>
#include <luminav/grid_tile_t.hpp>
#include <luminav/navigation_status_t.hpp>
#include <luminav/path_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/tile_request_t.hpp>
#include <string>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/subscriber.hpp"
#include "services/common/tiles/tile_codec.hpp"
#include "services/planner/planner_node.hpp"

namespace luminav {

/// Everything round the planner, in a hundred lines: a mapper that knows all, a localizer that is always right, and a
/// controller that walks from point to point of the newest path at 0.5 m/s.
class PlannerWorld {
 public:
  explicit PlannerWorld(const PlannerConfig& config = {}) : node(lcm, config), inbox_(lcm) {
    inbox_.on(channels::kPath, &PlannerWorld::on_path, this);
    inbox_.on(channels::kNavigationStatus, &PlannerWorld::on_status, this);
    inbox_.on(channels::kTileRequest, &PlannerWorld::on_request, this);
    // two rooms of 6 x 6 m side by side with a door of 0.9 m at (6.2, 3.2)
    grid = OccupancyGrid({0.1, {0.0, 0.0}, 124, 64});
    std::fill(grid.prior.begin(), grid.prior.end(), Prior::kFree);
    wall(0, 0, 124, 2);
    wall(0, 62, 124, 64);
    wall(0, 0, 2, 64);
    wall(122, 0, 124, 64);
    wall(61, 0, 63, 28);
    wall(61, 37, 63, 64);
  }

  void wall(int column, int row, int to_column, int to_row, Prior value = Prior::kOccupied) {
    for (int r = row; r < to_row; ++r) {
      for (int c = column; c < to_column; ++c) {
        grid.prior[grid.geometry.index({c, r})] = value;
      }
    }
  }

  /// Something that the sonars see, or no longer see, in a rectangle [m].
  void obstacle(double x, double y, double to_x, double to_y, bool there = true) {
    for (int r = static_cast<int>(std::lround(y * 10)); r < static_cast<int>(std::lround(to_y * 10)); ++r) {
      for (int c = static_cast<int>(std::lround(x * 10)); c < static_cast<int>(std::lround(to_x * 10)); ++c) {
        grid.evidence[grid.geometry.index({c, r})] = there ? 50 : -40;
      }
    }
    ++revision_;
    if (map_sent_) {
      send_tiles();
    }
  }

  /// One stop per pair of coordinates.
  goal_t goal(std::int64_t id, const std::vector<Eigen::Vector2d>& stops) {
    goal_t message{};
    message.id = id;
    message.utime = utime;
    message.action = goal_t::ACTION_GO;
    message.policy = goal_t::POLICY_STOP;
    for (const Eigen::Vector2d& stop : stops) {
      goal_pose_t pose{};
      pose.x = stop.x();
      pose.y = stop.y();
      message.poses.push_back(pose);
    }
    message.count = static_cast<std::int32_t>(message.poses.size());
    return message;
  }
  void send(const goal_t& message) {
    lcm.publish(channels::kGoal, &message);
    deliver();
  }
  void go(std::int64_t id, double x, double y) { send(goal(id, {{x, y}})); }
  void act(std::int64_t id, std::int8_t action) {
    goal_t message{};
    message.utime = utime;
    message.id = id;
    message.action = action;
    send(message);
  }

  /// Lets time pass in steps of 0.1 s; ends early once the predicate holds and says so.
  template <typename Predicate>
  bool run_until(double seconds, Predicate predicate) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds * 10)); ++i) {
      step();
      if (predicate()) {
        return true;
      }
    }
    return false;
  }
  void run(double seconds) {
    (void)run_until(seconds, [] { return false; });
  }
  bool run_until_state(double seconds, std::int8_t state) {
    return run_until(seconds, [&] { return status.state == state; });
  }

  lcm::LCM lcm{"memq://"};
  PlannerNode node;
  OccupancyGrid grid;
  std::int64_t utime = 1'000'000'000;  // [us]
  Pose2 robot{2.0, 3.0, 0.0};
  bool tracking = true;
  bool pose_flows = true;
  bool mapper_runs = true;
  bool base_speaks = true;
  bool wheels_blocked = false;
  bool stalled = false;  // what blocks the wheels, they feel
  bool yields = false;   // the controller says that it waits for somebody
  bool controller_runs = true;
  bool motors = true;

  navigation_status_t status{};
  path_t path{};
  int statuses = 0;
  int paths = 0;  // with a new sequence
  int requests = 0;
  std::vector<std::int8_t> states;  // each change

 private:
  void on_path(const path_t& message) {
    paths += message.sequence != path.sequence ? 1 : 0;
    if (message.sequence != path.sequence) {
      next_point_ = 0;
    }
    path = message;
  }
  void on_status(const navigation_status_t& message) {
    status = message;
    ++statuses;
    if (states.empty() || states.back() != message.state) {
      states.push_back(message.state);
    }
  }
  void on_request(const tile_request_t&) {
    ++requests;
    if (mapper_runs) {
      send_tiles();
    }
  }
  void send_tiles() {
    map_sent_ = true;
    for (int row = 0; row < grid.tile_rows(); ++row) {
      for (int column = 0; column < grid.tile_columns(); ++column) {
        grid_tile_t tile = encode_tile(grid, column, row);
        tile.utime = utime;
        tile.map_session = 77;
        tile.revision = revision_;
        lcm.publish(channels::kGridTile, &tile);
      }
    }
  }
  void deliver() {
    while (lcm.handleTimeout(0) > 0) {
    }
  }
  void step() {
    utime += 100'000;
    walk();
    robot_status_t base{};
    base.utime = utime - 1;
    base.connected = 1;
    base.motors_enabled = motors;
    base.stall_left = base.stall_right = stalled;
    if (base_speaks) {
      lcm.publish(channels::kRobotStatus, &base);
    }
    if (pose_flows) {
      pose_t pose{};
      pose.utime = utime;
      pose.x = robot.x;
      pose.y = robot.y;
      pose.theta = robot.theta;
      pose.state = tracking ? pose_t::STATE_TRACKING : pose_t::STATE_LOST;
      pose.reason = tracking ? "" : "no fixture seen yet";
      lcm.publish(channels::kPose, &pose);
    }
    if (controller_runs) {
      control_status_t control{};
      control.utime = utime;
      control.sequence = ++control_sequence_;
      control.path_sequence = path.sequence;
      control.goal_id = path.goal_id;
      control.seconds_without_progress = standing_;
      control.state = path.count == 0             ? control_status_t::STATE_IDLE
                      : next_point_ >= path.count ? control_status_t::STATE_AT_GOAL
                      : yields                    ? control_status_t::STATE_YIELDING
                                                  : control_status_t::STATE_FOLLOWING;
      lcm.publish(channels::kControlStatus, &control);
    }
    deliver();
  }
  void walk() {
    double left = 0.05;
    const bool moves = tracking && controller_runs && motors && !wheels_blocked && next_point_ < path.count;
    standing_ = moves ? 0.0 : standing_ + 0.1;
    while (moves && left > 0.0 && next_point_ < path.count) {
      const auto i = static_cast<std::size_t>(next_point_);
      const Eigen::Vector2d target(static_cast<double>(path.x[i]), static_cast<double>(path.y[i]));
      const Eigen::Vector2d offset = target - robot.position();
      const double length = std::min(left, offset.norm());
      if (offset.norm() > 1e-9) {
        robot.x += offset.x() / offset.norm() * length;
        robot.y += offset.y() / offset.norm() * length;
        robot.theta = std::atan2(offset.y(), offset.x());
      }
      left -= length + 1e-9;
      next_point_ += (target - robot.position()).norm() < 1e-3 ? 1 : 0;
    }
    if (path.has_theta && next_point_ >= path.count && path.count > 0) {
      robot.theta = path.theta;
    }
  }

  Subscriber inbox_;
  std::int32_t revision_ = 1;
  std::int32_t control_sequence_ = 0;
  std::int32_t next_point_ = 0;
  double standing_ = 0.0;
  bool map_sent_ = false;
};

}  // namespace luminav
