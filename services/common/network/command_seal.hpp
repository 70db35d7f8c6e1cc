#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace luminav {

/// The secret that the machines of one robot share.
struct CommandKey {
  std::array<std::uint8_t, 32> bytes{};
  std::int64_t read_at = 0;  // [us] by the wall clock: what was sealed a minute before it is no command any more
};

/// Reads a key: 64 hexadecimal digits in a file that only its owner may read. Throws ConfigurationError.
CommandKey read_command_key(const std::filesystem::path& file);

/// True if a message moves or changes something: only then it needs a seal. Engaging a STOP never does.
[[nodiscard]] bool needs_seal(const std::string& channel, std::span<const std::uint8_t> message);

/// Publishes commands. With a key each gets a seal behind LCM's encoding: who sends it, a counter that grows (the wall
/// clock), and a tag over all of it and the channel (BLAKE2b, keyed). LCM's decoders ignore bytes behind a message, so
/// logs, spies and receivers without a key take them as ever.
class CommandPublisher {
 public:
  explicit CommandPublisher(lcm::LCM& lcm, std::optional<CommandKey> key = {},
                            std::function<std::int64_t()> clock = {});

  /// What LCM returned: below 0, nothing was sent.
  template <typename Message>
  int publish(const std::string& channel, const Message& message) {
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    if (message.encode(bytes.data(), 0, static_cast<int>(bytes.size())) < 0) {
      return -1;
    }
    return publish_bytes(channel, std::move(bytes));
  }

 private:
  int publish_bytes(const std::string& channel, std::vector<std::uint8_t> bytes);

  lcm::LCM& lcm_;
  std::optional<CommandKey> key_;
  std::function<std::int64_t()> clock_;  // [us]
  std::uint64_t sender_ = 0;             // drawn at random
  std::int64_t counter_ = 0;
};

/// Judges the seals of what is received. Without a key everything passes.
class SealGuard {
 public:
  explicit SealGuard(std::optional<CommandKey> key = {});

  /// Why a message must not be obeyed, in one sentence; "" when it may.
  std::string judge(const std::string& channel, std::span<const std::uint8_t> message);

 private:
  static constexpr std::size_t kMaxSenders = 64;

  std::optional<CommandKey> key_;
  std::map<std::uint64_t, std::int64_t> counters_;  // the last of each sender
  std::int64_t floor_ = 0;                          // new senders count from here
};

}  // namespace luminav
