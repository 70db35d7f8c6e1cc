#pragma once

#include <luminav/hypotheses_t.hpp>
#include <luminav/odometry_t.hpp>
#include <luminav/pose_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "services/common/geometry/pose2.hpp"
#include "services/common/process/stamp_guard.hpp"
#include "services/controller/inputs/recent_odometry.hpp"
#include "services/controller/search/disambiguation.hpp"

namespace luminav {

/// Where the robot is, by the newest ODOMETRY, POSE and HYPOTHESES. A pose is trusted while the localizer says TRACKING
/// and goes on saying so.
class PoseInput {
 public:
  enum class Verdict {
    kRefused,  // and `why` says why
    kTaken,
    kNews,       // of POSE: another state, or a picture has corrected it
    kNewSession  // of ODOMETRY: nothing that is remembered in its frame has a place any more
  };
  Verdict take(const odometry_t& message, std::string& why);
  Verdict take(const pose_t& message, std::string& why);
  Verdict take(const hypotheses_t& message, std::string& why);

  [[nodiscard]] const RecentOdometry& odometry() const { return odometry_; }
  /// Why the robot does not know where it is, a sentence; nothing while it does.
  [[nodiscard]] std::optional<std::string> reason_not_to_trust() const;
  /// Nothing while it is not to be trusted.
  [[nodiscard]] std::optional<Pose2> world_from_odom() const;
  [[nodiscard]] bool is_on_another_floor(const std::string& floor) const;

  /// The robot was seen there last.
  void remember(const Pose2& world_from_odom) { known_world_from_odom_ = world_from_odom; }
  /// Where the robot may be, while its pose is not known. A localizer that falls silent does not take the zones away
  /// with it: the last pose goes on by odometry.
  [[nodiscard]] std::vector<PoseAlternative> possible() const;

 private:
  void restart(const odometry_t& first);
  [[nodiscard]] bool is_tracking() const { return pose_ && pose_->state == pose_t::STATE_TRACKING; }

  StampGuard stamps_;  // of ODOMETRY
  RecentOdometry odometry_;
  std::optional<pose_t> pose_;
  std::vector<PoseAlternative> alternatives_;   // of the newest HYPOTHESES
  std::optional<Pose2> known_world_from_odom_;  // when it was known last
};

}  // namespace luminav
