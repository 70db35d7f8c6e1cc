#pragma once

#include <lcm/lcm-cpp.hpp>
#include <luminav/control_status_t.hpp>
#include <luminav/navigation_status_t.hpp>
#include <luminav/path_t.hpp>
#include <luminav/velocity_command_t.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "services/common/process/channels.hpp"
#include "services/common/tiles/tile_codec.hpp"
#include "services/controller/controller_node.hpp"
#include "tests/unit/controller/grid_planner.hpp"
#include "tests/unit/controller/kinematic_world.hpp"

namespace luminav::testing {

/// What the robot is told to do by the planner that the loop plays.
struct Mission {
  Eigen::Vector2d goal = Eigen::Vector2d::Zero();
  bool has_theta = false;
  double theta = 0.0;
  double tolerance = 0.1;
  double replan_every = 1.0;  // [s]; 0 = never
  bool sees_boxes = true;     // the played mapper puts boxes into the map when they are near
};

/// The controller's node, the kinematic world and a played driver, localizer, mapper and planner on one memq:// handle,
/// in simulated time.
class ClosedLoop {
 public:
  ClosedLoop(KinematicWorld& world, const ControllerConfig& config)
      : world_(world), config_(config), lcm_("memq://"), node_(lcm_, config) {
    lcm_.subscribe(channels::kVelocityCommand, &ClosedLoop::on_command, this);
    lcm_.subscribe(channels::kControlStatus, &ClosedLoop::on_status, this);
  }

  void start(const Mission& mission) {
    mission_ = mission;
    is_localizing_ = false;
    ++goal_id_;
    next_plan_ = 0;
    publish_tiles();
  }
  void localize() {
    is_localizing_ = true;
    ++goal_id_;
  }

  /// Goes on by 20 ms.
  void tick() {
    for (int i = 0; i < 2; ++i) {
      world_.step(0.01, command_);
      utime_ += 10'000;
    }
    if (utime_ % 40'000 == 0) {
      fire();
    }
    if (utime_ % 100'000 == 0) {
      publish_odometry();
      publish_sonar();
      publish_pose();
    }
    if (utime_ % 200'000 == 0) {
      plan();
    }
    publish_robot_status();
    drain();
    record();
  }
  /// Until arrived or the time [s] is over; true when arrived.
  bool run(double seconds) {
    const std::int64_t end = utime_ + static_cast<std::int64_t>(1e6 * seconds);
    while (utime_ < end) {
      tick();
      if (!is_localizing_ && status_.state == control_status_t::STATE_AT_GOAL &&
          status_.path_sequence == path_sequence_ && status_.goal_id == goal_id_) {
        return true;
      }
    }
    return false;
  }

  /// The robot's clock jumps by so much [s].
  void step_clock(double seconds) {
    utime_ += static_cast<std::int64_t>(1e6 * seconds);
    next_plan_ = 0;
  }

  [[nodiscard]] double seconds() const { return 1e-6 * static_cast<double>(utime_ - kStart); }
  [[nodiscard]] const control_status_t& status() const { return status_; }
  [[nodiscard]] const velocity_command_t& command_message() const { return command_message_; }
  [[nodiscard]] double driven() const { return driven_; }
  /// Largest number of sign changes of the turning command (beyond 0.05 rad/s) within any 2 s.
  [[nodiscard]] int worst_sign_changes() const { return worst_sign_changes_; }
  /// Time [s] spent in a state of CONTROL_STATUS.
  [[nodiscard]] double time_in(int state) const { return time_in_[static_cast<std::size_t>(state)]; }
  [[nodiscard]] const std::vector<Eigen::Vector2d>& track() const { return track_; }
  [[nodiscard]] std::int64_t utime() const { return utime_; }
  [[nodiscard]] lcm::LCM& lcm() { return lcm_; }
  ControllerNode& node() { return node_; }
  bool trace = false;
  bool is_tracking = true;
  bool motors = true;
  bool drops_pose = false;
  bool drops_sonar = false;
  bool drops_plan = false;         // NAVIGATION_STATUS and PATH
  std::set<std::size_t> deaf;      // discs that hear nothing, on time
  std::optional<double> stuck_at;  // [m] all discs say this

 private:
  static constexpr std::int64_t kStart = 1'000'000'000'000;  // [us]

  void on_command(const lcm::ReceiveBuffer* buffer, const std::string&) {
    command_message_.decode(buffer->data, 0, static_cast<int>(buffer->data_size));
    command_ = {command_message_.linear_x, command_message_.angular_z};
  }
  void on_status(const lcm::ReceiveBuffer* buffer, const std::string&) {
    control_status_t fresh{};
    fresh.decode(buffer->data, 0, static_cast<int>(buffer->data_size));
    status_ = fresh;
  }
  void drain() {
    while (lcm_.handleTimeout(0) > 0) {
    }
  }

  void fire() {
    for (std::size_t array = 0; array < 2; ++array) {
      const std::size_t disc = 8 * array + next_disc_;
      const double heard = world_.sonar(disc);
      const double range = deaf.contains(disc) ? config_.robot.sonar.maximum_range : stuck_at.value_or(heard);
      sonar_.range[disc] = static_cast<float>(range);
      sonar_.has_echo[disc] = range < config_.robot.sonar.maximum_range;
      sonar_.fresh[disc] = true;
      sonar_.range_utime[disc] = utime_;
    }
    next_disc_ = (next_disc_ + 1) % 8;
  }
  void publish_odometry() {
    odometry_t message{};
    message.utime = utime_;
    message.session = 7;
    message.sequence = sequence_++;
    message.x = world_.odometry().x;
    message.y = world_.odometry().y;
    message.theta = world_.odometry().theta;
    message.linear = world_.twist().linear;
    message.angular = world_.twist().angular;
    lcm_.publish(channels::kOdometry, &message);
  }
  void publish_sonar() {
    if (drops_sonar) {
      return;
    }
    sonar_.utime = utime_;
    sonar_.session = 7;
    sonar_.sequence = sequence_;
    lcm_.publish(channels::kSonar, &sonar_);
    std::fill(sonar_.fresh.begin(), sonar_.fresh.end(), 0);
  }
  void publish_pose() {
    if (drops_pose) {
      return;
    }
    std::normal_distribution<double> normal;
    // an error that wanders slowly, as a filter's does
    error_.x() += 0.1 * (0.015 * normal(random_) - error_.x()) * 3.0;
    error_.y() += 0.1 * (0.015 * normal(random_) - error_.y()) * 3.0;
    pose_t message{};
    message.utime = utime_;
    message.session = 7;
    message.state = is_tracking && !is_localizing_ ? pose_t::STATE_TRACKING : pose_t::STATE_LOST;
    message.x = world_.truth().x + error_.x();
    message.y = world_.truth().y + error_.y();
    message.theta = wrap_angle(world_.truth().theta + radians(0.3) * normal(random_));
    lcm_.publish(channels::kPose, &message);
  }
  void publish_tiles() {
    const OccupancyGrid grid = world_.map();
    for (int row = 0; row < grid.tile_rows(); ++row) {
      for (int column = 0; column < grid.tile_columns(); ++column) {
        grid_tile_t tile = encode_tile(grid, column, row);
        tile.utime = utime_;
        tile.map_session = 1;
        lcm_.publish(channels::kGridTile, &tile);
      }
    }
  }
  void plan() {
    if (goal_id_ == 0 || drops_plan) {
      return;
    }
    if (!is_localizing_ && (next_plan_ == 0 || (mission_.replan_every > 0.0 && utime_ >= next_plan_))) {
      next_plan_ = utime_ + static_cast<std::int64_t>(1e6 * mission_.replan_every);
      const OccupancyGrid grid = mission_.sees_boxes ? world_.map_with_boxes_seen() : world_.map();
      const std::vector<Eigen::Vector2d> points = plan_path(grid, world_.truth().position(), mission_.goal);
      path_t path{};
      path.utime = utime_;
      path.goal_id = goal_id_;
      path.sequence = ++path_sequence_;
      path.tolerance = mission_.tolerance;
      path.has_theta = mission_.has_theta;
      path.theta = mission_.theta;
      path.heading_tolerance = radians(5.0);
      path.count = static_cast<int>(points.size());
      for (const Eigen::Vector2d& point : points) {
        path.x.push_back(static_cast<float>(point.x()));
        path.y.push_back(static_cast<float>(point.y()));
      }
      lcm_.publish(channels::kPath, &path);
    }
    navigation_status_t status{};
    status.utime = utime_;
    status.goal_id = goal_id_;
    status.state = is_localizing_ ? navigation_status_t::STATE_LOCALIZING : navigation_status_t::STATE_FOLLOWING;
    status.path_sequence = path_sequence_;
    lcm_.publish(channels::kNavigationStatus, &status);
  }
  void publish_robot_status() {
    robot_status_t message{};
    message.utime = utime_;
    message.session = 7;
    message.connected = true;
    message.motors_enabled = motors;
    message.maximum_linear = 0.5;
    message.deceleration = 1.0;
    lcm_.publish(channels::kRobotStatus, &message);
  }
  void record() {
    const Eigen::Vector2d place = world_.truth().position();
    if (!track_.empty()) {
      driven_ += (place - track_.back()).norm();
    }
    track_.push_back(place);
    time_in_[static_cast<std::size_t>(status_.state)] += 0.02;
    const int sign = command_.angular > 0.05 ? 1 : command_.angular < -0.05 ? -1 : 0;
    if (sign != 0) {
      if (last_sign_ == -sign) {
        sign_changes_.push_back(utime_);
      }
      last_sign_ = sign;
    }
    while (!sign_changes_.empty() && sign_changes_.front() < utime_ - 2'000'000) {
      sign_changes_.pop_front();
    }
    worst_sign_changes_ = std::max(worst_sign_changes_, static_cast<int>(sign_changes_.size()));
    if (trace && utime_ % 200'000 == 0) {
      std::printf("%6.1f x %5.2f y %5.2f th %4.0f  v %5.2f w %5.2f  st %d cl %.2f true %.2f left %.2f stuck %.1f  %s\n",
                  seconds(), place.x(), place.y(), degrees(world_.truth().theta), command_.linear, command_.angular,
                  status_.state, status_.clearance, world_.clearance(), status_.distance_left,
                  status_.seconds_without_progress, status_.reason.c_str());
    }
  }

  KinematicWorld& world_;
  ControllerConfig config_;
  lcm::LCM lcm_;
  ControllerNode node_;
  Mission mission_;
  bool is_localizing_ = false;
  std::int64_t goal_id_ = 0;
  std::int32_t path_sequence_ = 0;
  std::int64_t next_plan_ = 0;  // [us]
  std::int64_t utime_ = kStart;
  std::int32_t sequence_ = 0;
  std::size_t next_disc_ = 0;
  sonar_t sonar_ = empty_sonar();
  DriveTwist command_;
  velocity_command_t command_message_{};
  control_status_t status_{};
  std::mt19937 random_{3};
  Eigen::Vector2d error_ = Eigen::Vector2d::Zero();
  std::vector<Eigen::Vector2d> track_;
  double driven_ = 0.0;
  std::array<double, 10> time_in_{};
  std::deque<std::int64_t> sign_changes_;
  int last_sign_ = 0;
  int worst_sign_changes_ = 0;

  static sonar_t empty_sonar() {
    sonar_t sonar{};
    sonar.count = 16;
    sonar.range.assign(16, 5.0F);
    sonar.has_echo.assign(16, 0);
    sonar.fresh.assign(16, 0);
    sonar.range_utime.assign(16, 0);
    return sonar;
  }
};

}  // namespace luminav::testing
