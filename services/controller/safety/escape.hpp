#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/controller/safety/stop_logic.hpp"

namespace luminav {

/// A short manoeuvre out of a place where following the path does not lead on: arcs driven one after another.
struct EscapeMove {
  struct Arc {
    DriveTwist twist;
    double duration = 0.0;  // [s]
  };
  std::vector<Arc> arcs;
  std::string name;           // for people: "backing", "turning left", ...
  bool frees_a_turn = false;  // that was not free before
};

struct EscapeSituation {
  int attempt = 0;            // changes the order, so that the same failure is not repeated
  double wish = 0.0;          // [rad] where it wants to go, robot frame
  bool may_back = false;      // rear sonars see
  bool by_unknown = false;    // what is in the way is on no map: somebody who may want to pass
  bool people_about = false;  // met lately
  double turn = 0.0;          // [rad] it is to turn where it stands, and a swinging corner forbids it; 0 = it is not
};

/// The first manoeuvre whose whole course is free: make room for a turn that has none, sideways for people, back the
/// way it came, turn towards the more open side, inch ahead in an arc. Nothing where nothing is free.
std::optional<EscapeMove> choose_escape(const EscapeSituation& situation, const Obstacles& obstacles,
                                        const StopLogic& stop_logic);

}  // namespace luminav
