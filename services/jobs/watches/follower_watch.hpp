#pragma once

#include <deque>
#include <optional>

#include "services/common/geometry/pose2.hpp"

namespace luminav {

struct FollowerParams {
  double reach = 1.5;       // [m] within which somebody behind the robot follows it
  double lost_after = 2.0;  // [m] of driving without anybody behind, then he is lost
};

/// Whether somebody follows, by what the sonars hear straight behind. No wall stands where the robot itself has just
/// driven: an echo from there is somebody. Who stays falls out of reach, and is heard again when he comes after.
class FollowerWatch {
 public:
  explicit FollowerWatch(const FollowerParams& params) : params_(params) {}

  /// Somebody stands near it, before it perhaps, and is about to follow.
  void begin() { *this = FollowerWatch(params_); }

  /// `range` [m] of the nearest echo behind, nothing = none; `driven` [m] forward since the last time. Without a pose
  /// nothing is judged.
  void update(std::optional<double> range, double driven, const std::optional<Pose2>& world_from_robot) {
    if (!world_from_robot) {
      return;
    }
    unseen_ += driven;
    remember(world_from_robot->position());
    if (range && *range <= params_.reach && was_driven(*world_from_robot * Eigen::Vector2d(-kDiscs - *range, 0.0))) {
      unseen_ = 0.0;
    }
  }

  /// The person himself says that he is there.
  void see() { unseen_ = 0.0; }
  [[nodiscard]] bool is_lost() const { return unseen_ > params_.lost_after; }
  /// He was seen a moment ago.
  [[nodiscard]] bool is_near() const { return unseen_ <= kMoment; }

 private:
  static constexpr double kDiscs = 0.25;  // [m] from the robot's middle to the discs behind
  static constexpr double kCrumb = 0.1;   // [m] between two points of its way
  static constexpr double kBeside = 0.3;  // [m] that an echo may be off its way
  static constexpr double kMoment = 0.3;  // [m]
  static constexpr double kPassed = 1.0;  // [m] until who stands before it is behind it
  static constexpr std::size_t kCrumbs = 40;

  void remember(const Eigen::Vector2d& point) {
    if (trail_.empty() || (trail_.back() - point).norm() > kCrumb) {
      trail_.push_back(point);
    }
    if (trail_.size() > kCrumbs) {
      trail_.pop_front();
    }
  }
  [[nodiscard]] bool was_driven(const Eigen::Vector2d& point) const {
    for (const Eigen::Vector2d& crumb : trail_) {
      if ((crumb - point).norm() < kBeside) {
        return true;
      }
    }
    return false;
  }

  FollowerParams params_;
  std::deque<Eigen::Vector2d> trail_;  // [m] world, where the robot was
  double unseen_ = -kPassed;           // [m] driven since he was seen last
};

}  // namespace luminav
