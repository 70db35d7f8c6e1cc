// The decoders of all message types, on whatever bytes: none throws, none asks for more memory than a datagram is
// worth, and what one takes, it writes the same again.
#include <array>
#include <cstdlib>
#include <functional>
#include <span>
#include <string_view>

#include "services/common/network/command_seal.hpp"
#include "services/common/process/channels.hpp"
#include "tests/fuzz/message_types.hpp"
#include "tests/replay/log_reading/message_schema.hpp"

using namespace luminav;

namespace {

void require(bool claim) {
  if (!claim) {
    std::abort();
  }
}

template <typename Message>
void try_type(const std::vector<std::uint8_t>& bytes) {
  Message message{};
  const int used = message.decode(bytes.data(), 0, static_cast<int>(bytes.size()));
  require(used <= static_cast<int>(bytes.size()));
  if (used < 0) {
    return;
  }
  std::vector<std::uint8_t> again(static_cast<std::size_t>(message.getEncodedSize()));
  require(message.encode(again.data(), 0, static_cast<int>(again.size())) == static_cast<int>(again.size()));
  Message copy{};
  require(copy.decode(again.data(), 0, static_cast<int>(again.size())) == static_cast<int>(again.size()));
}

/// The bytes of a message of this type: its fingerprint goes before them.
template <typename Message>
void try_body(std::span<const std::uint8_t> body) {
  const auto fingerprint = static_cast<std::uint64_t>(Message::getHash());
  std::vector<std::uint8_t> bytes;
  for (int shift = 56; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<std::uint8_t>(fingerprint >> shift));
  }
  bytes.insert(bytes.end(), body.begin(), body.end());
  try_type<Message>(bytes);
  (void)MessageSchemas::built_in().decode(bytes);
}

template <typename... Messages>
std::vector<std::function<void(std::span<const std::uint8_t>)>> tries(MessageTypes<Messages...>) {
  return {try_body<Messages>...};
}

void judge_seal(std::span<const std::uint8_t> bytes) {
  static SealGuard guard(CommandKey{});
  require(!guard.judge(channels::kGoal, bytes).empty());
}

}  // namespace

/// The first byte says which type.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const auto kTries = tries(AllMessageTypes{});
  if (size > 0) {
    const std::span body(data + 1, size - 1);
    kTries[data[0] % kTries.size()](body);
    judge_seal(body);
  }
  return 0;
}
