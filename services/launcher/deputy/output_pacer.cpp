#include "services/launcher/deputy/output_pacer.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace luminav::launcher {

void OutputPacer::refill(Stream& stream, std::int64_t steady_now) const {
  if (!stream.known) {
    stream.allowance = params_.command_burst;
    stream.known = true;
  } else {
    const double elapsed = static_cast<double>(std::max<std::int64_t>(0, steady_now - stream.filled)) * 1e-6;
    stream.allowance = std::min(params_.command_burst, stream.allowance + elapsed * params_.command_rate);
  }
  stream.filled = steady_now;
}

void OutputPacer::add(const std::string& command_id, std::string_view text, std::int64_t steady_now) {
  Stream& stream = streams_[command_id];
  refill(stream, steady_now);
  const auto accepted = std::min(text.size(), static_cast<std::size_t>(std::max(0.0, stream.allowance)));
  const std::size_t start = stream.text.size();
  stream.text.append(text.substr(0, accepted));
  // A zero byte would end the string for a reader written in C.
  std::replace(stream.text.begin() + static_cast<std::ptrdiff_t>(start), stream.text.end(), '\0', '?');
  stream.allowance -= static_cast<double>(accepted);
  stream.left_out += static_cast<std::int64_t>(text.size() - accepted);
}

std::vector<luminav_procman::procman_output_t> OutputPacer::take(std::int64_t steady_now) {
  constexpr std::size_t kOverheadPerEntry = 10;  // two lengths and two terminators on the wire
  std::vector<luminav_procman::procman_output_t> messages;
  std::size_t room = 0;
  const auto pack = [&](const std::string& id, std::string_view text) {
    while (!text.empty()) {
      const std::size_t overhead = id.size() + kOverheadPerEntry;
      if (room <= overhead) {
        messages.emplace_back();
        room = params_.largest;
      }
      const std::size_t piece = std::min(text.size(), room - overhead);
      luminav_procman::procman_output_t& message = messages.back();
      message.command_ids.push_back(id);
      message.text.emplace_back(text.substr(0, piece));
      message.num_commands = static_cast<std::int16_t>(message.text.size());
      room -= overhead + piece;
      text.remove_prefix(piece);
    }
  };
  for (auto& [id, stream] : streams_) {
    refill(stream, steady_now);
    pack(id, stream.text);
    stream.text.clear();
    // Said once per pause of the flood, not with every message.
    if (stream.left_out > 0 && stream.allowance >= params_.command_burst / 4) {
      pack(id, fmt::format("\n[{} bytes left out here; the log file has them]\n", stream.left_out));
      stream.left_out = 0;
    }
  }
  return messages;
}

}  // namespace luminav::launcher
