#include "services/common/network/command_seal.hpp"

#include <fmt/format.h>
#include <sodium.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <luminav/stop_t.hpp>

#include "services/common/configuration/toml_table.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/clock.hpp"

namespace luminav {
namespace {

constexpr std::array<std::uint8_t, 4> kMark = {'L', 'N', 'K', '1'};
constexpr std::size_t kTagSize = 16;
constexpr std::size_t kSignedSize = kMark.size() + 8 + 8;  // mark, sender, counter
constexpr std::size_t kSealSize = kSignedSize + kTagSize;
constexpr std::int64_t kClockSlack = 60'000'000;  // [us] between the clocks of two machines

using Tag = std::array<std::uint8_t, kTagSize>;

std::int64_t wall_clock() {
  return read_clock(CLOCK_REALTIME);
}

void append_number(std::uint64_t number, std::vector<std::uint8_t>& bytes) {
  for (int shift = 56; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<std::uint8_t>(number >> shift));
  }
}

std::uint64_t number_at(std::span<const std::uint8_t> bytes) {
  std::uint64_t number = 0;
  for (const std::uint8_t byte : bytes.first(8)) {
    number = number << 8 | byte;
  }
  return number;
}

/// Over the channel with its NUL and everything before the tag.
Tag make_tag(const CommandKey& key, const std::string& channel, std::span<const std::uint8_t> sealed) {
  crypto_generichash_state state;
  Tag tag{};
  crypto_generichash_init(&state, key.bytes.data(), key.bytes.size(), tag.size());
  crypto_generichash_update(&state, reinterpret_cast<const unsigned char*>(channel.c_str()), channel.size() + 1);
  crypto_generichash_update(&state, sealed.data(), sealed.size());
  crypto_generichash_final(&state, tag.data(), tag.size());
  return tag;
}

bool is_command_channel(const std::string& channel) {
  for (const char* command :
       {channels::kVelocityCommand, channels::kStop, channels::kMotorsCommand, channels::kGoal, channels::kInitialPose,
        channels::kMapCommand, channels::kTeleopCommand, channels::kSupervision, channels::kSpeedLimit, channels::kJob,
        channels::kSurveyCommand, channels::kProcmanOrders}) {
    if (channel == command) {
      return true;
    }
  }
  return false;
}

void start_sodium() {
  if (sodium_init() < 0) {
    throw std::runtime_error("libsodium does not start");
  }
}

}  // namespace

CommandKey read_command_key(const std::filesystem::path& file) {
  struct stat status {};
  std::ifstream in(file);
  if (!in || stat(file.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) {
    throw ConfigurationError(
        fmt::format("{}: cannot be read, expected a key; `scripts/launch --make-key` makes one", file.string()));
  }
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    throw ConfigurationError(fmt::format("{}: others may read this key, say chmod 600", file.string()));
  }
  std::string digits;
  in >> digits;
  CommandKey key;
  std::size_t size = 0;
  start_sodium();
  if (digits.size() != 2 * key.bytes.size() ||
      sodium_hex2bin(key.bytes.data(), key.bytes.size(), digits.data(), digits.size(), nullptr, &size, nullptr) != 0 ||
      size != key.bytes.size()) {
    throw ConfigurationError(fmt::format("{}: must hold 64 hexadecimal digits", file.string()));
  }
  key.read_at = wall_clock();
  return key;
}

bool needs_seal(const std::string& channel, std::span<const std::uint8_t> message) {
  if (channel == channels::kStop) {
    stop_t stop{};
    return stop.decode(message.data(), 0, static_cast<int>(message.size())) < 0 || stop.engaged == 0;
  }
  return is_command_channel(channel);
}

CommandPublisher::CommandPublisher(lcm::LCM& lcm, std::optional<CommandKey> key, std::function<std::int64_t()> clock)
    : lcm_(lcm), key_(key), clock_(clock ? std::move(clock) : wall_clock) {
  if (key_) {
    start_sodium();
    randombytes_buf(&sender_, sizeof sender_);
  }
}

int CommandPublisher::publish_bytes(const std::string& channel, std::vector<std::uint8_t> bytes) {
  if (key_) {
    counter_ = std::max(counter_ + 1, clock_());
    bytes.insert(bytes.end(), kMark.begin(), kMark.end());
    append_number(sender_, bytes);
    append_number(static_cast<std::uint64_t>(counter_), bytes);
    const Tag tag = make_tag(*key_, channel, bytes);
    bytes.insert(bytes.end(), tag.begin(), tag.end());
  }
  return lcm_.publish(channel, bytes.data(), static_cast<unsigned>(bytes.size()));
}

SealGuard::SealGuard(std::optional<CommandKey> key) : key_(key) {
  if (key_) {
    floor_ = key_->read_at - kClockSlack;
  }
}

std::string SealGuard::judge(const std::string& channel, std::span<const std::uint8_t> message) {
  if (!key_ || !needs_seal(channel, message)) {
    return "";
  }
  if (message.size() < kSealSize ||
      !std::equal(kMark.begin(), kMark.end(), message.end() - static_cast<std::ptrdiff_t>(kSealSize))) {
    return "without a key's seal, from somebody who has none";
  }
  const Tag tag = make_tag(*key_, channel, message.first(message.size() - kTagSize));
  if (sodium_memcmp(tag.data(), message.last(kTagSize).data(), kTagSize) != 0) {
    return "sealed with another key";
  }
  const std::span<const std::uint8_t> seal = message.last(kSealSize).subspan(kMark.size());
  const std::uint64_t sender = number_at(seal);
  const auto counter = static_cast<std::int64_t>(number_at(seal.subspan(8)));
  const auto known = counters_.find(sender);
  if (known != counters_.end() && counter <= known->second) {
    return "heard before";
  }
  if (known == counters_.end() && counter <= floor_) {
    return fmt::format("sealed {} s before this process started: an old recording, or a clock that is behind",
                       (floor_ + kClockSlack - counter) / 1'000'000);
  }
  counters_[sender] = counter;
  if (counters_.size() > kMaxSenders) {
    const auto oldest = std::min_element(counters_.begin(), counters_.end(),
                                         [](const auto& a, const auto& b) { return a.second < b.second; });
    floor_ = std::max(floor_, oldest->second);
    counters_.erase(oldest);
  }
  return "";
}

}  // namespace luminav
