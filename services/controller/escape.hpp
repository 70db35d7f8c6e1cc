#pragma once

#include <optional>
#include <span>
#include <string>

#include "services/controller/stop_logic.hpp"

namespace luminav {

/// A short manoeuvre out of a place where following the path does not lead on.
struct EscapeMove {
  DriveTwist twist;
  double duration = 0.0;  // [s]
  std::string name;       // for people: "backing", "turning left", ...
};

/// The first manoeuvre whose whole arc is free, in an order that changes with the attempt so that the same failure is
/// not repeated: back the way it came, turn towards the more open side, inch ahead in an arc. `wish` [rad] is where it
/// wants to go, robot frame. Nothing where nothing is free.
std::optional<EscapeMove> choose_escape(int attempt, double wish, bool may_back,
                                        std::span<const ObstaclePoint> obstacles, const StopLogic& stop_logic);

}  // namespace luminav
