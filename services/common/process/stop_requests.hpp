#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>

namespace luminav {

/// The rule by which STOP is obeyed, the same for all who obey it: whoever asks for a stop gets it, and it stays until
/// it is released. Requests are repeated by their senders: each release is acted on once, and nobody's release from
/// before a stop of his own counts.
class StopRequests {
 public:
  enum class Verdict { kTaken, kRepeated, kOutdated };

  StopRequests() = default;
  /// Goes on from the last request that was taken before.
  StopRequests(std::int64_t id, bool engaged, const std::string& sender)
      : engaged_(engaged), id_(id), sender_(shortened(sender)), seen_{{sender_, id, engaged}} {}

  Verdict take(std::int64_t id, bool engaged, const std::string& sender) {
    const Request request{shortened(sender), id, engaged};
    const bool is_known = std::find(seen_.begin(), seen_.end(), request) != seen_.end();
    if (!engaged && is_known) {
      return Verdict::kRepeated;
    }
    if (!engaged && is_from_before_own_stop(request)) {
      return Verdict::kOutdated;
    }
    if (!is_known) {
      remember(request);
    }
    // While released even a known stop is obeyed: standing once too often is the better mistake.
    const bool repeats = is_known && engaged_;
    engaged_ = engaged;
    id_ = id;
    sender_ = request.sender;
    return repeats ? Verdict::kRepeated : Verdict::kTaken;
  }

  [[nodiscard]] bool engaged() const { return engaged_; }
  /// Id of the last request obeyed, a repeated stop too; 0 = none.
  [[nodiscard]] std::int64_t id() const { return id_; }
  /// Sender of that request, shortened to 64 letters.
  [[nodiscard]] const std::string& sender() const { return sender_; }

 private:
  struct Request {
    std::string sender;
    std::int64_t id = 0;
    bool engaged = false;
    friend bool operator==(const Request&, const Request&) = default;
  };

  // Ids are compared within one sender only, since hosts' clocks differ.
  [[nodiscard]] bool is_from_before_own_stop(const Request& release) const {
    return std::any_of(seen_.begin(), seen_.end(), [&](const Request& seen) {
      return seen.engaged && seen.sender == release.sender && seen.id >= release.id;
    });
  }
  void remember(const Request& request) {
    constexpr std::size_t kRemembered = 128;  // each is repeated for a second at most
    seen_.push_back(request);
    if (seen_.size() > kRemembered) {
      seen_.pop_front();
    }
  }
  // It is sent on in ROBOT_STATUS, 50 times a second.
  static std::string shortened(const std::string& sender) {
    constexpr std::size_t kLongestSender = 64;  // [bytes]
    return sender.substr(0, kLongestSender);
  }

  bool engaged_ = false;
  std::int64_t id_ = 0;
  std::string sender_;
  std::deque<Request> seen_;  // newest last
};

}  // namespace luminav
