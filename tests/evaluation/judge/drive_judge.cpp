#include "tests/evaluation/judge/drive_judge.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "drivers/simulator/geometry/shapes.hpp"
#include "drivers/simulator/world/scene.hpp"
#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr double kTouching = 0.03;                         // [m] what is this near was touched
constexpr std::int64_t kCorridorEvery = 200'000;           // [us]
constexpr double kMinSpeed = 0.1;                          // [m/s] slower is waiting or turning
constexpr double kSwing = 0.03;                            // [rad/s] below it the command has no direction
constexpr std::int64_t kSwingWindow = 2'000'000;           // [us]
constexpr std::size_t kMaxTurnabouts = 6;                  // in the window: three a second
constexpr double kNarrowest = 1.2;                         // [m]
constexpr double kWidest = 3.0;                            // [m]
constexpr std::array kAlong{-0.5, -0.25, 0.0, 0.25, 0.5};  // [m]

/// From a point to the first wall [m]; nothing within `reach`.
std::optional<double> distance_to_wall(const PriorMap& walls, const Eigen::Vector2d& from,
                                       const Eigen::Vector2d& direction, double reach) {
  const double step = 0.25 * walls.geometry.resolution;
  for (double distance = 0.0; distance <= reach; distance += step) {
    if (walls.at(from + distance * direction) == Prior::kOccupied) {
      return distance;
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<CorridorGap> corridor_gap(const PriorMap& walls, const Pose2& world_from_robot, double half_width) {
  std::array<double, 2> beside{};
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    double min = kWidest;
    double max = 0.0;
    for (const double along : kAlong) {
      const Eigen::Vector2d from = world_from_robot * Eigen::Vector2d(along, 0.0);
      const double turn = world_from_robot.theta + (side == 0 ? 0.5 : -0.5) * kPi;
      const auto distance = distance_to_wall(walls, from, {std::cos(turn), std::sin(turn)}, kWidest);
      if (!distance) {
        return std::nullopt;
      }
      min = std::min(min, *distance);
      max = std::max(max, *distance);
    }
    if (max - min > 0.2) {
      return std::nullopt;
    }
    beside[side] = min;
  }
  const double width = beside[0] + beside[1];
  if (width < kNarrowest || width > kWidest) {
    return std::nullopt;
  }
  return CorridorGap{std::min(beside[0], beside[1]) - half_width, 0.5 * width - half_width};
}

DriveJudge::DriveJudge(lcm::LCM& lcm, const WorldTruth& world) : world_(world), subscriber_(lcm) {
  for (const Eigen::Vector2d& corner : world_.robot.footprint) {
    half_width_ = std::max(half_width_, std::abs(corner.y()));
  }
  subscriber_.on(channels::kSimTruth, &DriveJudge::on_truth, this);
  subscriber_.on(channels::kControlStatus, &DriveJudge::on_control, this);
  subscriber_.on(channels::kVelocityCommand, &DriveJudge::on_command, this);
}

ContactEvent DriveJudge::contact(const sim_truth_t& truth, bool is_hard) const {
  ContactEvent event;
  event.at_s = 1e-6 * static_cast<double>(truth.utime - first_utime_);
  event.x = truth.x;
  event.y = truth.y;
  event.theta_deg = degrees(truth.theta);
  event.linear = control_ ? control_->linear : 0.0;
  event.angular = control_ ? control_->angular : 0.0;
  event.control_state = control_ ? control_->state : 0;
  const Polygon outline = transform({truth.x, truth.y, truth.theta}, world_.robot.footprint);
  event.with = is_hard ? "hard" : "wall";
  if (is_hard) {
    return event;
  }
  for (const Obstacle& obstacle : world_.obstacles) {
    if (obstacle.kind == ObstacleKind::kBox && obstacle.world_from_obstacle &&
        distance(outline, rectangle(*obstacle.world_from_obstacle, obstacle.length, obstacle.width)) < kTouching) {
      event.with = "box";
    }
  }
  for (std::size_t i = 0; i < truth.person_x.size(); ++i) {
    const Eigen::Vector2d person(truth.person_x[i], truth.person_y[i]);
    if (distance(outline, person) - kPersonRadius < kTouching) {
      event.with = "person";
    }
  }
  return event;
}

void DriveJudge::on_truth(const sim_truth_t& truth) {
  if (first_utime_ == 0) {
    first_utime_ = truth.utime;
  }
  for (; count_ < truth.contacts; ++count_) {
    contacts_.push_back(contact(truth, false));
  }
  for (; hard_count_ < truth.hard_contacts; ++hard_count_) {
    contacts_.push_back(contact(truth, true));
  }
  if (truth.carried || truth.linear < kMinSpeed || truth.utime - last_corridor_ < kCorridorEvery ||
      world_.walls.cells.empty()) {
    return;
  }
  last_corridor_ = truth.utime;
  if (const auto gap = corridor_gap(world_.walls, {truth.x, truth.y, truth.theta}, half_width_)) {
    corridor_shares_.push_back(std::max(0.0, gap->nearer) / gap->middle);
  }
}

void DriveJudge::on_command(const velocity_command_t& command) {
  const double passed = last_command_ == 0 ? 0.0 : 1e-6 * static_cast<double>(command.utime - last_command_);
  last_command_ = command.utime;
  if (std::abs(command.angular_z) > kSwing) {
    if (command.angular_z * last_turn_ < 0.0) {
      turnabouts_.push_back(command.utime);
    }
    last_turn_ = command.angular_z;
  }
  while (!turnabouts_.empty() && command.utime - turnabouts_.front() > kSwingWindow) {
    turnabouts_.pop_front();
  }
  if (turnabouts_.size() > kMaxTurnabouts) {
    oscillation_ += std::clamp(passed, 0.0, 0.2);
  }
}

DriveResult DriveJudge::result() const {
  DriveResult result;
  result.contacts = contacts_;
  result.oscillation_s = oscillation_;
  if (!corridor_shares_.empty()) {
    std::vector<double> shares = corridor_shares_;
    const auto middle = shares.begin() + static_cast<std::ptrdiff_t>(shares.size() / 2);
    std::nth_element(shares.begin(), middle, shares.end());
    result.corridor_share = *middle;
  }
  return result;
}

}  // namespace luminav
