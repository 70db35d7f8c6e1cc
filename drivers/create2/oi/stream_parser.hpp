#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace luminav {

/// [19][length][payload][checksum]: the sum of all of it is 0 modulo 256.
std::vector<std::uint8_t> encode_stream_frame(std::span<const std::uint8_t> payload);

/// Finds the frames of the sensor stream among whatever else is on the line, such as the text that a robot prints when
/// it starts. After a broken frame it looks for the next header behind that frame's header: nothing whole is lost.
class StreamParser {
 public:
  void push(std::span<const std::uint8_t> bytes) { waiting_.insert(waiting_.end(), bytes.begin(), bytes.end()); }
  /// The payload of the next whole frame of the length that is expected; nothing while there is none.
  std::optional<std::vector<std::uint8_t>> next(std::size_t expected_length);
  void clear() { waiting_.clear(); }
  /// Frames of the right length with a wrong checksum.
  [[nodiscard]] std::int64_t bad_frames() const { return bad_frames_; }

 private:
  std::deque<std::uint8_t> waiting_;
  std::int64_t bad_frames_ = 0;
};

}  // namespace luminav
