#pragma once

namespace luminav {

/// The states of the goal executor.
enum class GoalPhase {
  kNone,             // no goal; the last one ended with a state and a cause
  kLocalizing,       // the pose is unknown: the controller searches
  kPlanning,         // waits for the map or a plan
  kSuspectingPlace,  // the building's map leaves no room where the robot seems to be
  kFollowing,        // drives along a path
  kHolding,          // waits before a blockage, or looks at a gap
  kDwelling,         // stays at a stop
  kRetrying,         // a stop failed and is tried again later
  kPaused
};

/// True if the executor may go from one state to the other. A goal may begin, be cancelled or end in any state.
bool may_follow(GoalPhase before, GoalPhase after);

}  // namespace luminav
