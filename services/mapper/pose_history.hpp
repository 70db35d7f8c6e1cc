#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// The last poses by their stamps, so that a reading can be placed at its own instant.
class PoseHistory {
 public:
  struct Entry {
    std::int64_t utime = 0;  // [us]
    Pose2 world_from_robot;
    double speed = 0.0;    // [m/s] how fast the base can have moved to get here
    bool trusted = false;  // good enough to draw a map from
  };

  /// Stamps must grow; older ones are forgotten after `kMemory`.
  void add(const Entry& entry);
  void clear() { entries_.clear(); }

  [[nodiscard]] std::int64_t newest() const { return entries_.empty() ? 0 : entries_.back().utime; }
  /// The pose at an instant between two entries that are both trusted and not a jump of the estimate apart.
  [[nodiscard]] std::optional<Pose2> trusted_at(std::int64_t utime) const;

 private:
  static constexpr std::int64_t kMemory = 2'000'000;  // [us]
  std::deque<Entry> entries_;
};

}  // namespace luminav
