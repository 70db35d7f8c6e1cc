#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>

namespace luminav {

/// The rule by which STOP is obeyed, the same for all who obey it: once engaged it stays until it is released. Requests
/// are repeated by their senders and each is acted on once; nobody's release from before a stop of his own counts.
class StopRequests {
 public:
  enum class Verdict { kTaken, kRepeated, kOutdated };

  StopRequests() = default;
  /// Goes on from the last request that was taken before.
  StopRequests(std::int64_t id, bool engaged, const std::string& sender)
      : engaged_(engaged), id_(id), sender_(sender), seen_{{sender, id}} {}

  Verdict take(std::int64_t id, bool engaged, const std::string& sender) {
    const std::pair<std::string, std::int64_t> key{sender, id};
    if (std::find(seen_.begin(), seen_.end(), key) != seen_.end()) {
      return Verdict::kRepeated;
    }
    // Ids are compared within one sender only, since hosts' clocks differ. A stop is obeyed whatever its id.
    if (!engaged && engaged_ && sender == sender_ && id < id_) {
      return Verdict::kOutdated;
    }
    seen_.push_back(key);
    if (seen_.size() > kRemembered) {
      seen_.pop_front();
    }
    engaged_ = engaged;
    id_ = id;
    sender_ = sender;
    return Verdict::kTaken;
  }

  [[nodiscard]] bool engaged() const { return engaged_; }
  /// Id of the last request taken; 0 = none.
  [[nodiscard]] std::int64_t id() const { return id_; }
  [[nodiscard]] const std::string& sender() const { return sender_; }

 private:
  static constexpr std::size_t kRemembered = 128;  // requests; each is repeated for a second at most
  bool engaged_ = false;
  std::int64_t id_ = 0;
  std::string sender_;
  std::deque<std::pair<std::string, std::int64_t>> seen_;  // sender and id, newest last
};

}  // namespace luminav
