#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "services/common/ceiling/odometry_history.hpp"

namespace luminav {

/// Holds images until odometry reaches both sides of their time, and refuses those that are older than the last one
/// used or than the odometry kept, and those that lie so far ahead of it that their clock must be another one.
class FrameQueue {
 public:
  void add_odometry(const OdometryReading& reading) { history_.add(reading); }
  void add_frame(const SightingFrame& frame);
  /// Forgets the waiting images and the odometry: relative motion across now is unknown.
  void restart();

  struct TimedFrame {
    SightingFrame frame;
    OdometryReading odometry;  // at the image's time
  };
  /// The next image whose time odometry has reached.
  [[nodiscard]] std::optional<TimedFrame> next();

  /// Images whose time odometry has not reached yet, oldest first.
  [[nodiscard]] const std::deque<SightingFrame>& waiting() const { return waiting_; }
  [[nodiscard]] const OdometryHistory& history() const { return history_; }
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }
  /// Stamp [us] of the last image handed out; 0 = none since the start.
  [[nodiscard]] std::int64_t last_used() const { return last_used_; }

 private:
  static constexpr std::size_t kMaxWaiting = 60;      // 4 s of images without odometry
  static constexpr std::int64_t kMaxAhead = 500'000;  // [us] an image may be that much faster than odometry

  OdometryHistory history_;
  std::deque<SightingFrame> waiting_;
  std::int64_t last_used_ = 0;  // [us]
  std::int64_t dropped_ = 0;
};

}  // namespace luminav
