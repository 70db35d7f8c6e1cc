#include "services/jobs/watches/drive_watch.hpp"

#include <algorithm>

namespace luminav {

void DriveWatch::ask(DriveAction action, std::int64_t utime) {
  request_.id = std::max({utime, heard_id_ + 1, request_.id + 1});
  request_.action = action;
  is_echoed_ = false;
}

void DriveWatch::begin(const DriveTarget& target, std::int64_t utime) {
  request_.target = target;
  ask(DriveAction::kGo, utime);
  is_taken_over_ = false;
  state_ = Drive::kUnderWay;
  cause_.clear();
  distance_left_ = 0.0;
}

void DriveWatch::take_over(const DriveTarget& target, std::int64_t goal_id) {
  request_ = {goal_id, DriveAction::kGo, target};
  is_echoed_ = false;
  is_taken_over_ = true;
  state_ = Drive::kUnderWay;
}

void DriveWatch::cancel(std::int64_t utime) {
  ask(DriveAction::kCancel, utime);
}

void DriveWatch::pause(std::int64_t utime) {
  ask(DriveAction::kPause, utime);
}

void DriveWatch::forget() {
  state_ = Drive::kNone;
  is_echoed_ = true;
}

bool DriveWatch::is_open() const {
  return state_ == Drive::kUnderWay || state_ == Drive::kPaused;
}

std::optional<DriveRequest> DriveWatch::request() const {
  return is_open() && !is_echoed_ ? std::optional(request_) : std::nullopt;
}

// The wire and the table keep all digits.
bool DriveWatch::is_ours(const Navigation& navigation) const {
  const DriveTarget& ours = request_.target;
  return navigation.state == Drive::kCancelled ||
         (navigation.target && navigation.target->pose.x == ours.pose.x && navigation.target->pose.y == ours.pose.y &&
          navigation.target->has_theta == ours.has_theta);
}

void DriveWatch::hear(const Navigation& navigation) {
  heard_id_ = navigation.goal_id;
  if (!is_open()) {
    return;
  }
  if (navigation.goal_id != request_.id) {
    if (!is_echoed_ && navigation.goal_id < request_.id) {
      return;  // not taken up yet
    }
    const bool is_new_goal = request_.action == DriveAction::kGo && !is_taken_over_;
    if (!is_echoed_ && (is_new_goal || (is_ours(navigation) && request_.action != DriveAction::kGo))) {
      request_.id = navigation.goal_id + 1;  // the planner takes only ids that grow
      return;
    }
    if (!is_ours(navigation)) {  // also before a cancellation was heard: nobody else's goal is cancelled
      state_ = navigation.state == Drive::kNone ? Drive::kForgotten : Drive::kReplaced;
      return;
    }
    request_.id = navigation.goal_id;
  } else if (is_taken_over_ && !is_ours(navigation)) {
    state_ = Drive::kForgotten;  // the process before drove elsewhere by this id, back for a visitor
    return;
  }
  is_echoed_ = true;
  cause_ = navigation.cause;
  distance_left_ = navigation.distance_left;
  state_ = request_.action == DriveAction::kCancel ? Drive::kCancelled
           : navigation.state == Drive::kNone      ? Drive::kForgotten
                                                   : navigation.state;
}

}  // namespace luminav
