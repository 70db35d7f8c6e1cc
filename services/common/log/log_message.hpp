#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace luminav {

/// The bytes of an event of a log as a message; nothing when they are of another type or version.
template <typename Message>
std::optional<Message> decoded(const std::vector<std::uint8_t>& data) {
  Message message{};
  if (message.decode(data.data(), 0, static_cast<int>(data.size())) < 0) {
    return std::nullopt;
  }
  return message;
}

template <typename Message>
std::vector<std::uint8_t> encoded(const Message& message) {
  std::vector<std::uint8_t> data(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(data.data(), 0, static_cast<int>(data.size()));
  return data;
}

}  // namespace luminav
