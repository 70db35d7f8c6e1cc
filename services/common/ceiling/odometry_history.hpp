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
  /// `span` [s] is how far back readings are kept.
  explicit OdometryHistory(double span = 5.0) : span_us_(static_cast<std::int64_t>(span * 1e6)) {}

  /// Appends a reading newer than all before; a new session drops what came before it.
  void add(const OdometryReading& reading);
  void clear() { readings_.clear(); }

  [[nodiscard]] bool is_empty() const { return readings_.empty(); }
  [[nodiscard]] const OdometryReading& newest() const { return readings_.back(); }
  [[nodiscard]] std::int64_t oldest_utime() const { return readings_.front().utime; }

  /// The reading at a time [us] between two kept ones, interpolated; nothing outside of them.
  [[nodiscard]] std::optional<OdometryReading> at(std::int64_t utime) const;
  /// Length of the way [m] and sum of the turns [rad] between two times; turns there and back do not cancel.
  struct Travel {
    double distance = 0.0;
    double turn = 0.0;
  };
  [[nodiscard]] Travel travel(std::int64_t from_utime, std::int64_t to_utime) const;

 private:
  std::deque<OdometryReading> readings_;
  std::int64_t span_us_;
};

}  // namespace luminav
