#include "services/controller/safety/escape.hpp"

#include <algorithm>
#include <cmath>

#include "services/controller/safety/free_heading.hpp"

namespace luminav {
namespace {

using Moves = std::vector<EscapeMove>;

constexpr double kTurnRate = 0.7;  // [rad/s]

// Openness of a side [m]; the wish decides between equals.
double openness(double sign, double wish, const Obstacles& obstacles) {
  const FreeHeadingParams strip;
  const std::vector<ObstaclePoint>& points = obstacles.points();
  const double beside = free_distance(sign * radians(60.0), 2.0, points, strip) +
                        free_distance(sign * radians(110.0), 2.0, points, strip);
  return beside + (sign * wish > 0.0 ? 0.3 : 0.0);
}

std::string to_side(double sign, const char* what) {
  return std::string(what) + (sign > 0.0 ? " left" : " right");
}

// Turning the nose to one side while backing brings the whole robot to the other.
Moves sidesteps(double side) {
  Moves moves;
  for (const double sign : {side, -side}) {
    for (const double back : {3.5, 2.0}) {
      moves.push_back({{{{-0.12, -0.40 * sign}, 2.0}, {{-0.16, 0.0}, back}}, to_side(sign, "stepping aside to the")});
    }
  }
  return moves;
}

Moves backings(double side) {
  return {{{{{-0.15, 0.0}, 2.5}}, "backing"},
          {{{{-0.12, -0.35 * side}, 2.0}}, "backing in an arc"},
          {{{{-0.12, 0.35 * side}, 2.0}}, "backing in an arc"},
          {{{{-0.10, 0.0}, 1.2}}, "backing a little"}};
}

Moves turns(double side) {
  Moves moves;
  for (const double duration : {2.0, 0.9}) {
    for (const double sign : {side, -side}) {
      moves.push_back({{{{0.0, kTurnRate * sign}, duration}}, to_side(sign, "turning")});
    }
  }
  return moves;
}

Moves inchings(double side) {
  return {{{{{0.12, 0.4 * side}, 2.0}}, "inching ahead in an arc"},
          {{{{0.12, -0.4 * side}, 2.0}}, "inching ahead in an arc"},
          {{{{0.10, 0.0}, 1.2}}, "inching ahead"}};
}

// To where it can turn, the nearest place first.
Moves places_to_turn(double side) {
  Moves moves;
  for (const double duration : {0.8, 1.6, 2.8}) {
    for (const double linear : {-0.12, 0.12}) {
      for (const double angular : {0.0, 0.35 * side, -0.35 * side}) {
        moves.push_back({{{{linear, angular}, duration}}, "making room to turn", true});
      }
    }
  }
  return moves;
}

/// What is around at the end of a course; nothing where the course is not free.
std::optional<Obstacles> seen_after(const EscapeMove& move, bool may_back, const Obstacles& obstacles,
                                    const StopLogic& stop_logic) {
  Obstacles seen = obstacles;
  for (const EscapeMove::Arc& arc : move.arcs) {
    if ((arc.twist.linear < 0.0 && !may_back) || !stop_logic.is_free(arc.twist, arc.duration + 0.2, seen)) {
      return std::nullopt;
    }
    seen = seen.seen_from(drive_arc(arc.twist, arc.duration).inverse());
  }
  return seen;
}

bool is_turn_free(double angle, const Obstacles& obstacles, const StopLogic& stop_logic) {
  return stop_logic.is_free({0.0, std::copysign(kTurnRate, angle)}, std::abs(angle) / kTurnRate, obstacles);
}

/// A manoeuvre to a place where the turn to the same heading is free.
std::optional<EscapeMove> make_room_to_turn(const EscapeSituation& situation, const Obstacles& obstacles,
                                            const StopLogic& stop_logic) {
  // people who are in the way of a turn may be gone before there is room; a wall of the map will not
  const bool waits = situation.by_unknown && situation.people_about;
  if (situation.turn == 0.0 || waits || is_turn_free(situation.turn, obstacles, stop_logic)) {
    return std::nullopt;
  }
  for (const EscapeMove& move : places_to_turn(situation.turn > 0.0 ? 1.0 : -1.0)) {
    const DriveTwist& twist = move.arcs.front().twist;
    const double left = wrap_angle(situation.turn - twist.angular * move.arcs.front().duration);
    const std::optional<Obstacles> there = seen_after(move, situation.may_back, obstacles, stop_logic);
    if (there && is_turn_free(left, *there, stop_logic)) {
      return move;
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<EscapeMove> choose_escape(const EscapeSituation& situation, const Obstacles& obstacles,
                                        const StopLogic& stop_logic) {
  const double side =
      openness(1.0, situation.wish, obstacles) >= openness(-1.0, situation.wish, obstacles) ? 1.0 : -1.0;
  if (const auto move = make_room_to_turn(situation, obstacles, stop_logic)) {
    return move;
  }
  std::vector<Moves> order;
  switch (situation.attempt % 3) {
    case 0:
      order = {backings(side), turns(side), inchings(side)};
      break;
    case 1:
      order = {turns(side), backings(side), inchings(side)};
      break;
    default:
      order = {inchings(side), backings(side), turns(side)};
      break;
  }
  if (situation.by_unknown) {
    order.insert(order.begin(), sidesteps(situation.attempt % 2 == 0 ? side : -side));
  }
  for (const Moves& moves : order) {
    for (const EscapeMove& move : moves) {
      if (seen_after(move, situation.may_back, obstacles, stop_logic)) {
        return move;
      }
    }
  }
  return std::nullopt;
}

}  // namespace luminav
