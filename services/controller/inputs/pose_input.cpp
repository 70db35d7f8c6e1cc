#include "services/controller/inputs/pose_input.hpp"

#include <fmt/format.h>

#include <utility>

#include "services/common/geometry/seconds.hpp"
#include "services/common/process/lcm_conversions.hpp"
#include "services/controller/controller_messages.hpp"

namespace luminav {
namespace {

constexpr double kPoseStaleAfter = 0.25;  // [s] against the newest odometry: two poses missing of ten a second

}  // namespace

PoseInput::Verdict PoseInput::take(const odometry_t& message, std::string& why) {
  if (!is_possible(message)) {
    why = "ODOMETRY: what no robot measures";
    return Verdict::kRefused;
  }
  const StampGuard::Verdict verdict = stamps_.check(message.utime);
  if (verdict == StampGuard::Verdict::kOld) {
    why = "ODOMETRY: older than the last";
    return Verdict::kRefused;
  }
  if (verdict == StampGuard::Verdict::kNewSession ||
      (!odometry_.empty() && odometry_.newest().session != message.session)) {
    restart(message);
    return Verdict::kNewSession;
  }
  odometry_.add(message);
  return Verdict::kTaken;
}

void PoseInput::restart(const odometry_t& first) {
  alternatives_.clear();
  known_world_from_odom_.reset();
  odometry_.clear();
  odometry_.add(first);
  if (pose_ && (pose_->session != first.session || odometry_.is_too_far_ahead(pose_->utime))) {
    pose_.reset();
  }
}

PoseInput::Verdict PoseInput::take(const pose_t& message, std::string& why) {
  if (!is_possible(message)) {
    why = "POSE: not a pose";
    return Verdict::kRefused;
  }
  if (!odometry_.empty() && odometry_.is_too_far_ahead(message.utime)) {
    why = "POSE: ahead of the odometry";  // it would never grow old
    return Verdict::kRefused;
  }
  const bool is_news = !pose_ || message.fixture_utime != pose_->fixture_utime || message.state != pose_->state;
  pose_ = message;
  return is_news ? Verdict::kNews : Verdict::kTaken;
}

PoseInput::Verdict PoseInput::take(const hypotheses_t& message, std::string& why) {
  const std::optional<Pose2> place = odometry_.odom_from_robot_at(message.utime);
  std::optional<std::vector<PoseAlternative>> alternatives = alternatives_of(message, place.value_or(Pose2{}), why);
  if (!alternatives) {
    return Verdict::kRefused;
  }
  alternatives_ = place ? std::move(*alternatives) : std::vector<PoseAlternative>{};
  return Verdict::kTaken;
}

std::optional<std::string> PoseInput::reason_not_to_trust() const {
  if (!pose_ || odometry_.empty() || pose_->session != odometry_.newest().session) {
    return "the localizer has not spoken yet";
  }
  if (!is_tracking()) {
    return "the pose is not known: " + pose_->reason;
  }
  if (odometry_.is_too_far_ahead(pose_->utime)) {  // it came before any odometry
    return "the pose is ahead of the odometry";
  }
  const double age = seconds_between(pose_->utime, odometry_.newest().utime);
  return age > kPoseStaleAfter ? std::optional(fmt::format("the pose is {:.1f} s old", age)) : std::nullopt;
}

std::optional<Pose2> PoseInput::world_from_odom() const {
  if (reason_not_to_trust()) {
    return std::nullopt;
  }
  const std::optional<Pose2> then = odometry_.odom_from_robot_at(pose_->utime);
  return then ? std::optional(world_from_robot(*pose_) * then->inverse()) : std::nullopt;
}

bool PoseInput::is_on_another_floor(const std::string& floor) const {
  return is_tracking() && pose_->floor != floor;
}

std::vector<PoseAlternative> PoseInput::possible() const {
  const bool was_known = is_tracking() && known_world_from_odom_;
  return was_known ? std::vector<PoseAlternative>{{*known_world_from_odom_, 1.0}} : alternatives_;
}

}  // namespace luminav
