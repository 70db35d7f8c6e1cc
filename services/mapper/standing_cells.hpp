#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>

namespace luminav {

/// Tells what stands from what walks past: a box goes on answering from the same cell, a person's cell falls silent
/// within a second or two. Times in [us].
class StandingCells {
 public:
  /// Echoes further apart than `gap` [s] are not of the same thing; what answers for `duration` [s] stands.
  StandingCells(double duration, double gap);

  /// An echo came from a cell; `is_new` where nothing was known to be before. Whether it stands by now.
  bool hear(std::size_t cell, std::int64_t utime, bool is_new);
  void clear() { runs_.clear(); }

 private:
  struct Run {
    std::int64_t first = 0;
    std::int64_t last = 0;
  };
  std::int64_t duration_;
  std::int64_t gap_;
  std::unordered_map<std::size_t, Run> runs_;  // never iterated
};

}  // namespace luminav
