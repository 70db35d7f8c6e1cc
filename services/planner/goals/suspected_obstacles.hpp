#pragma once

#include <cstdint>
#include <vector>

#include "services/planner/space/configuration_space.hpp"

namespace luminav {

/// Obstacles that no sonar shows, each until a time of its own.
class SuspectedObstacles {
 public:
  /// `until` [us].
  void add(const SuspectedObstacle& obstacle, std::int64_t until) { suspects_.push_back({obstacle, until}); }
  void clear() { suspects_.clear(); }
  /// Drops those whose time is over. True if there were any.
  bool expire(std::int64_t now);
  /// The clock started anew: the time of each ends now.
  void restart_clock(std::int64_t now);

  [[nodiscard]] bool empty() const { return suspects_.empty(); }
  [[nodiscard]] std::vector<SuspectedObstacle> all() const;

 private:
  struct Suspect {
    SuspectedObstacle obstacle;
    std::int64_t until = 0;  // [us]
  };
  std::vector<Suspect> suspects_;
};

}  // namespace luminav
