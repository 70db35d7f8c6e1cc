#include "services/mapper/standing_cells.hpp"

#include "services/common/geometry/seconds.hpp"

namespace luminav {

StandingCells::StandingCells(double duration, double gap)
    : duration_(microseconds_of(duration)), gap_(microseconds_of(gap)) {}

bool StandingCells::hear(std::size_t cell, std::int64_t utime, bool is_new) {
  const auto [entry, inserted] = runs_.try_emplace(cell, Run{utime, utime});
  Run& run = entry->second;
  if (!inserted && (is_new || utime < run.last || utime - run.last > gap_)) {
    run.first = utime;
  }
  run.last = utime;
  return run.last - run.first >= duration_;
}

}  // namespace luminav
