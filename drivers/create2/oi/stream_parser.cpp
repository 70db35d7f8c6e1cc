#include "drivers/create2/oi/stream_parser.hpp"

#include <algorithm>
#include <numeric>

namespace luminav {
namespace {

constexpr std::uint8_t kHeader = 19;

}  // namespace

std::vector<std::uint8_t> encode_stream_frame(std::span<const std::uint8_t> payload) {
  std::vector<std::uint8_t> frame(payload.size() + 3);
  frame[0] = kHeader;
  frame[1] = static_cast<std::uint8_t>(payload.size());
  std::copy(payload.begin(), payload.end(), frame.begin() + 2);
  frame.back() = static_cast<std::uint8_t>(-std::accumulate(frame.begin(), frame.end(), 0) & 0xFF);
  return frame;
}

std::optional<std::vector<std::uint8_t>> StreamParser::next(std::size_t expected_length) {
  const std::size_t frame_size = expected_length + 3;
  while (waiting_.size() >= 2) {
    if (waiting_[0] != kHeader || waiting_[1] != expected_length) {
      waiting_.pop_front();
      continue;
    }
    if (waiting_.size() < frame_size) {
      return std::nullopt;
    }
    const auto end = waiting_.begin() + static_cast<std::ptrdiff_t>(frame_size);
    if ((std::accumulate(waiting_.begin(), end, 0) & 0xFF) != 0) {
      ++bad_frames_;
      waiting_.pop_front();
      continue;
    }
    std::vector<std::uint8_t> payload(waiting_.begin() + 2, end - 1);
    waiting_.erase(waiting_.begin(), end);
    return payload;
  }
  return std::nullopt;
}

}  // namespace luminav
