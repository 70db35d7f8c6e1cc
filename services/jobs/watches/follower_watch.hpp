#pragma once

#include <Eigen/Core>
#include <deque>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

struct FollowerParams {
  double reach = 1.5;       // [m] within which somebody follows the robot
  double lost_after = 2.0;  // [m] of driving without anybody near, then he is lost
};

/// One pulse of a disc that came back.
struct Echo {
  Pose2 world_from_sonar{};  // when it was heard; x along the disc's axis
  double half_angle = 0.0;   // [rad] of the cone: it may come from anywhere within
  double range = 0.0;        // [m]
};

/// How long the robot has driven alone. Who follows it walks where it has driven, and no wall stands there: an echo
/// that can come from the robot's own trail, and not from a wall of the map, is somebody. It looks all round, so he is
/// also heard round a corner, and from the front when the robot comes back for him. Whom it has heard twice it believes
/// in: discs hear each other's pulses. Who steps off the trail is not heard.
class FollowerWatch {
 public:
  /// `walls` may be null: then no echo is a wall's.
  FollowerWatch(const FollowerParams& params, std::shared_ptr<const PriorMap> walls)
      : params_(params), walls_(std::move(walls)) {}

  /// Somebody stands near the robot and is about to follow.
  void begin() { *this = FollowerWatch(params_, walls_); }

  /// `echoes` and what was driven forward [m] since the last time, `seconds` ago; true when they come from somebody
  /// near. Without a pose nothing is judged.
  bool update(const std::vector<Echo>& echoes, double seconds, double driven,
              const std::optional<Pose2>& world_from_robot);
  /// The person himself says that he is there.
  void see() { alone_ = 0.0; }

  /// [m] driven since somebody was near.
  [[nodiscard]] double alone() const { return alone_; }

 private:
  void remember(const Eigen::Vector2d& point);
  /// The point of the trail that an echo can come from [m, world].
  [[nodiscard]] std::optional<Eigen::Vector2d> find_on_trail(const Echo& echo) const;
  [[nodiscard]] bool is_wall(const Echo& echo) const;

  FollowerParams params_;
  std::shared_ptr<const PriorMap> walls_;
  std::deque<Eigen::Vector2d> trail_;     // [m] world, where the robot was
  std::optional<Eigen::Vector2d> heard_;  // [m] world, where somebody was heard last
  double since_heard_ = 0.0;              // [s]
  double alone_ = 0.0;                    // [m]
};

}  // namespace luminav
