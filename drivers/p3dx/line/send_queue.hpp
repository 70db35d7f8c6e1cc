#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "drivers/base/line/byte_stream.hpp"

namespace luminav {

/// Frames that wait for the line and leave at a pace that the robot can follow. A frame that has left in part must go
/// on, or the robot would take the next one for its rest. `line` may be null: nothing leaves.
class SendQueue {
 public:
  /// Of too many frames the newest is lost.
  void push(std::vector<std::uint8_t> frame);
  /// Writes what may leave at `now` [us].
  void flush(ByteStream* line, std::int64_t now);
  /// Writes the rest of a frame that has left in part, whatever the pace.
  void finish_frame(ByteStream& line) const;
  /// Drops all but that rest, and that too where the line is no longer open.
  void drop_waiting(const ByteStream* line);

  [[nodiscard]] std::size_t size() const { return waiting_.size(); }
  /// When the last frame had left [us].
  [[nodiscard]] std::int64_t last_sent() const { return last_sent_; }

 private:
  void count_as_written(std::size_t bytes, std::int64_t now);

  std::deque<std::vector<std::uint8_t>> waiting_;
  std::size_t written_ = 0;        // of the first waiting frame
  double allowance_ = 4.0;         // frames that may leave now
  std::int64_t allowance_at_ = 0;  // [us]
  std::int64_t last_sent_ = 0;
};

}  // namespace luminav
