#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <initializer_list>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "services/common/network/command_seal.hpp"

namespace luminav {

inline bool is_stamp(std::int64_t utime) {
  return utime > 0 && utime < std::int64_t{1} << 53;
}

/// Of what may not have been yet.
inline bool is_stamp_or_none(std::int64_t utime) {
  return utime == 0 || is_stamp(utime);
}

/// What is sent has a stamp, and a request an id, which is taken from the clock too. A stop is obeyed whatever it says.
template <typename Message>
bool has_sound_stamps(const Message& message) {
  if constexpr (requires { message.range_utime; }) {
    return is_stamp(message.utime) &&
           std::all_of(message.range_utime.begin(), message.range_utime.end(), is_stamp_or_none);
  } else if constexpr (requires { message.fixture_utime; }) {
    return is_stamp(message.utime) && is_stamp_or_none(message.fixture_utime);
  } else if constexpr (requires { message.engaged; }) {
    return message.engaged != 0 || is_stamp(message.id);
  } else if constexpr (requires { message.id; }) {
    return is_stamp(message.utime) && is_stamp(message.id);
  } else if constexpr (requires { message.utime; }) {
    return is_stamp(message.utime);
  }
  return true;
}

/// Subscribes a node's handlers so that nothing a peer sends can get through LCM as an exception (which would leave
/// the handle unusable, LCM 1.3.1): a message that does not decode, or whose handler throws, is dropped and counted.
///
/// Stamps and ids are after the epoch and below 2^53 (the year 2255): none of ours overflows when two are added or
/// subtracted.
class Subscriber {
 public:
  /// With a key, commands without its seal are dropped.
  explicit Subscriber(lcm::LCM& lcm, std::optional<CommandKey> key = {}) : lcm_(lcm), seals_(key) {}
  Subscriber(const Subscriber&) = delete;
  Subscriber& operator=(const Subscriber&) = delete;
  ~Subscriber() {
    for (const auto& entry : entries_) {
      lcm_.unsubscribe(entry->subscription);
    }
  }

  template <typename Message, typename Node>
  void on(const std::string& channel, void (Node::*handler)(const Message&), Node* node) {
    auto entry = std::make_unique<TypedEntry<Message, Node>>();
    entry->owner = this;
    entry->node = node;
    entry->handler = handler;
    entry->subscription = lcm_.subscribe(channel, &Entry::on_bytes, static_cast<Entry*>(entry.get()));
    if (entry->subscription != nullptr) {
      // the default of 30 drops the newest of a burst of tiles
      entry->subscription->setQueueCapacity(kQueueCapacity);
      entries_.push_back(std::move(entry));
      channels_.push_back(channel);
    }
  }

  /// For messages that decode but make no sense to the node (stale, not a number, out of range).
  void drop(std::string reason) {
    ++dropped_;
    last_reason_ = std::move(reason);
  }
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }
  /// Why the last one was dropped, for NODE_STATUS.
  [[nodiscard]] const std::string& last_reason() const { return last_reason_; }
  /// All that were subscribed.
  [[nodiscard]] const std::vector<std::string>& channels() const { return channels_; }

 private:
  static constexpr int kQueueCapacity = 500;

  struct Entry {
    virtual ~Entry() = default;
    virtual void deliver(const lcm::ReceiveBuffer& buffer) = 0;
    void on_bytes(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
      try {
        const std::span<const std::uint8_t> bytes(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
        if (const std::string why = owner->seals_.judge(channel, bytes); !why.empty()) {
          owner->drop(channel + ": " + why);
          return;
        }
        deliver(*buffer);
      } catch (const std::exception& error) {
        owner->drop(channel + ": " + error.what());
      }
    }
    Subscriber* owner = nullptr;
    lcm::Subscription* subscription = nullptr;
  };

  template <typename Message, typename Node>
  struct TypedEntry final : Entry {
    void deliver(const lcm::ReceiveBuffer& buffer) override {
      Message message{};  // fresh: decoding does not clear vectors whose count is 0
      if (message.decode(buffer.data, 0, static_cast<int>(buffer.data_size)) < 0) {
        owner->drop(std::string(Message::getTypeName()) + " does not decode: another version of the type, or damaged");
        return;
      }
      if (!has_sound_stamps(message)) {
        owner->drop(std::string(Message::getTypeName()) + " with a stamp or an id that no clock shows");
        return;
      }
      (node->*handler)(message);
    }
    Node* node = nullptr;
    void (Node::*handler)(const Message&) = nullptr;
    using Entry::owner;
  };

  lcm::LCM& lcm_;
  SealGuard seals_;
  std::vector<std::unique_ptr<Entry>> entries_;
  std::vector<std::string> channels_;
  std::int64_t dropped_ = 0;
  std::string last_reason_;
};

inline bool all_finite(std::initializer_list<double> values) {
  for (const double value : values) {
    if (!std::isfinite(value)) {
      return false;
    }
  }
  return true;
}

}  // namespace luminav
