#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "services/common/ceiling/fixture_sighting.hpp"

namespace luminav {

/// Interpolates between two readings of one session; `utime` [us] lies between theirs.
[[nodiscard]] OdometryReading interpolate(const OdometryReading& before, const OdometryReading& after,
                                          std::int64_t utime);

/// The odometry of the last seconds, so that images and echoes which arrive late can be placed at their own time.
class OdometryHistory {
 public:
  /// Appends a reading newer than all before; a new session drops what came before it.
  void add(const OdometryReading& reading);
  void clear() { readings_.clear(); }

  [[nodiscard]] bool is_empty() const { return readings_.empty(); }
  [[nodiscard]] const OdometryReading& newest() const { return readings_.back(); }

  /// The reading at a time [us] between two kept ones, interpolated; nothing outside of them.
  [[nodiscard]] std::optional<OdometryReading> at(std::int64_t utime) const;

 private:
  static constexpr std::int64_t kSpan = 5'000'000;  // [us] how far back readings are kept
  std::deque<OdometryReading> readings_;
};

}  // namespace luminav
