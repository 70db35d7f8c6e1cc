#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// What became of a drive.
enum class Drive {
  kNone,
  kUnderWay,
  kPaused,
  kArrived,
  kNoPath,
  kBlocked,
  kStuck,
  kLost,
  kCancelled,
  kReplaced,   // somebody else sent another goal
  kForgotten,  // the planner was started anew and knows no goal
};

struct DriveTarget {
  std::string place{};  // "" = a point
  Pose2 pose{};         // world
  bool has_theta = false;
};

/// What the planner says of its goal.
struct Navigation {
  std::int64_t goal_id = 0;
  Drive state = Drive::kNone;  // kNone = idle
  std::string cause{};
  std::optional<DriveTarget> target{};
  double distance_left = 0.0;  // [m]
};

enum class DriveAction { kGo, kCancel, kPause };
struct DriveRequest {
  std::int64_t id = 0;
  DriveAction action = DriveAction::kGo;
  DriveTarget target{};
};

/// One drive by GOAL: what is to be sent until the planner echoes it, and how the drive ends. Pausing, resuming and
/// cancelling have ids of their own, by whomever: the goal is the same as long as its target is.
class DriveWatch {
 public:
  /// `utime` [us], a stamp, makes the id; it is above all that were heard.
  void begin(const DriveTarget& target, std::int64_t utime);
  /// The drive was begun by a process that is gone.
  void take_over(const DriveTarget& target, std::int64_t goal_id);
  void cancel(std::int64_t utime);
  void pause(std::int64_t utime);
  /// Nothing drives any more, or it is no business of ours.
  void forget();

  void hear(const Navigation& navigation);

  /// To be sent again and again; nothing once it was echoed.
  [[nodiscard]] std::optional<DriveRequest> request() const;
  [[nodiscard]] Drive state() const { return state_; }
  [[nodiscard]] const std::string& cause() const { return cause_; }
  [[nodiscard]] double distance_left() const { return distance_left_; }
  [[nodiscard]] std::int64_t goal_id() const { return request_.id; }
  /// The robot may still be moved by this drive.
  [[nodiscard]] bool is_open() const;

 private:
  void ask(DriveAction action, std::int64_t utime);
  [[nodiscard]] bool is_ours(const Navigation& navigation) const;

  DriveRequest request_;
  bool is_echoed_ = false;
  bool is_taken_over_ = false;
  Drive state_ = Drive::kNone;
  std::string cause_;
  double distance_left_ = 0.0;
  std::int64_t heard_id_ = 0;
};

}  // namespace luminav
