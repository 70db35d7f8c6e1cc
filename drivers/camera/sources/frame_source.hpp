#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "services/common/image/grey_image.hpp"

namespace luminav {

/// One grey picture and how it was taken.
struct Frame {
  GreyImage image;
  std::int64_t utime = 0;    // [us] mid-exposure of the middle row, by the clock of the source
  double exposure_us = 0.0;  // [us] in effect for this frame; 0 = unknown, and then not to be controlled
  double gain = 1.0;         // in effect for this frame; 1 = none
  double row_time_us = 0.0;  // [us] from one row to the next; 0 = global shutter or unknown
};

/// Where frames come from: a device, files or the simulated ceiling. Not one of them blocks.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  /// Becomes readable when a frame is ready; -1 = there is none now. It may change between calls.
  [[nodiscard]] virtual int descriptor() const { return -1; }
  /// [us] when `take` is worth calling next, for sources that go by the clock; nothing = by descriptor or by messages.
  [[nodiscard]] virtual std::optional<std::int64_t> due() const { return std::nullopt; }

  /// Moves the newest frame into `frame` (reusing its memory). False when there is none yet. `now` [us] is the
  /// driver's clock.
  [[nodiscard]] virtual bool take(std::int64_t now, Frame& frame) = 0;

  /// Asks for an exposure [us] and a gain; frames say what came of it, often some frames later. False when this source
  /// cannot be told.
  virtual bool set_exposure(double exposure_us, double gain) = 0;

  /// "" or why no frames come, in one plain sentence.
  [[nodiscard]] virtual std::string fault() const { return {}; }
  /// "" or what is not as it should be although frames come, in one plain sentence.
  [[nodiscard]] virtual std::string shortcoming() const { return {}; }
  /// One sentence on what it is, for the start of the log.
  [[nodiscard]] virtual std::string description() const = 0;
};

}  // namespace luminav
