#include "services/controller/escape.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "services/controller/free_heading.hpp"

namespace luminav {

std::optional<EscapeMove> choose_escape(int attempt, double wish, bool may_back,
                                        std::span<const ObstaclePoint> obstacles, const StopLogic& stop_logic) {
  const FreeHeadingParams strip;
  // openness of each side; the wish decides between equals
  const double left = free_way(radians(60.0), 2.0, obstacles, strip) + free_way(radians(110.0), 2.0, obstacles, strip) +
                      (wish > 0.0 ? 0.3 : 0.0);
  const double right = free_way(radians(-60.0), 2.0, obstacles, strip) +
                       free_way(radians(-110.0), 2.0, obstacles, strip) + (wish < 0.0 ? 0.3 : 0.0);
  const double side = left >= right ? 1.0 : -1.0;
  const auto name = [](double sign, const char* to_left, const char* to_right) {
    return sign > 0.0 ? to_left : to_right;
  };
  const std::vector<EscapeMove> backing{
      {{-0.15, 0.0}, 2.5, "backing"},
      {{-0.12, -0.35 * side}, 2.0, "backing in an arc"},
      {{-0.12, 0.35 * side}, 2.0, "backing in an arc"},
      {{-0.10, 0.0}, 1.2, "backing a little"},
  };
  const std::vector<EscapeMove> turning{
      {{0.0, 0.7 * side}, 2.0, name(side, "turning left", "turning right")},
      {{0.0, -0.7 * side}, 2.0, name(-side, "turning left", "turning right")},
      {{0.0, 0.5 * side}, 0.9, name(side, "turning left", "turning right")},
      {{0.0, -0.5 * side}, 0.9, name(-side, "turning left", "turning right")},
  };
  const std::vector<EscapeMove> inching{
      {{0.12, 0.4 * side}, 2.0, "inching ahead in an arc"},
      {{0.12, -0.4 * side}, 2.0, "inching ahead in an arc"},
      {{0.10, 0.0}, 1.2, "inching ahead"},
  };
  std::vector<std::vector<EscapeMove>> order;
  switch (attempt % 3) {
    case 0:
      order = {backing, turning, inching};
      break;
    case 1:
      order = {turning, backing, inching};
      break;
    default:
      order = {inching, backing, turning};
      break;
  }
  for (const std::vector<EscapeMove>& moves : order) {
    for (const EscapeMove& move : moves) {
      if ((move.twist.linear >= 0.0 || may_back) && stop_logic.is_free(move.twist, move.duration + 0.3, obstacles)) {
        return move;
      }
    }
  }
  return std::nullopt;
}

}  // namespace luminav
