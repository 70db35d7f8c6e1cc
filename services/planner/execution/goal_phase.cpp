#include "services/planner/execution/goal_phase.hpp"

namespace luminav {

bool may_follow(GoalPhase before, GoalPhase after) {
  using enum GoalPhase;
  if (after == before || after == kNone || after == kLocalizing) {
    return true;  // the pose may get lost wherever the robot drives, and a new goal begins with it
  }
  if (after == kPaused) {
    return before != kNone;
  }
  switch (before) {
    case kNone:
    case kPaused:
      return false;
    case kLocalizing:
    case kDwelling:
    case kRetrying:
      return after == kPlanning;
    case kSuspectingPlace:
    case kHolding:
      return after == kPlanning || after == kFollowing || after == kHolding || after == kRetrying;
    case kPlanning:  // a robot that stands at its stop already dwells at once
    case kFollowing:
      return true;
  }
  return false;
}

}  // namespace luminav
