#include "services/planner/goals/suspected_obstacles.hpp"

namespace luminav {

bool SuspectedObstacles::expire(std::int64_t now) {
  return std::erase_if(suspects_, [&](const Suspect& suspect) { return suspect.until <= now; }) > 0;
}

void SuspectedObstacles::restart_clock(std::int64_t now) {
  for (Suspect& suspect : suspects_) {
    suspect.until = now;
  }
}

std::vector<SuspectedObstacle> SuspectedObstacles::all() const {
  std::vector<SuspectedObstacle> obstacles;
  for (const Suspect& suspect : suspects_) {
    obstacles.push_back(suspect.obstacle);
  }
  return obstacles;
}

}  // namespace luminav
