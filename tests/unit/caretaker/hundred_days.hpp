#pragma once

#include <cstdint>
#include <set>

namespace luminav {

/// What the lamps' report said in a hundred days in which lamps failed.
struct HundredDays {
  int failures = 0;             // lamps that failed
  int late = 0;                 // of these, not reported after three passes in light that shows it, or never
  int latest = 0;               // most passes in such light until a failure was reported
  std::set<int> false_reports;  // ids
  int changes = 0;              // proposed, of a ceiling that stayed as it was
};

/// A robot that passes all lamps of five rooms three times a day, for a hundred days in which drawn lamps die, burn in
/// half or flicker. Visits are drawn as a detector that errs now and then would have them.
HundredDays simulate_hundred_days(std::uint64_t seed);

}  // namespace luminav
