#pragma once

#include <cstdint>

namespace luminav {

/// Judges the stamps of one stream: old messages are refused, and a backward jump of more than a second seen on three
/// messages in a row means that the sender's clock or the sender itself started anew.
class StampGuard {
 public:
  enum class Verdict { kNewer, kOld, kNewSession };

  Verdict check(std::int64_t utime) {
    if (utime > newest_) {
      newest_ = utime;
      backward_ = 0;
      return Verdict::kNewer;
    }
    if (newest_ - utime <= kJump) {
      backward_ = 0;
      return Verdict::kOld;
    }
    if (++backward_ < kConfirmations) {
      return Verdict::kOld;
    }
    newest_ = utime;
    backward_ = 0;
    return Verdict::kNewSession;
  }

  [[nodiscard]] std::int64_t newest() const { return newest_; }

 private:
  static constexpr std::int64_t kJump = 1'000'000;  // [us]
  static constexpr int kConfirmations = 3;
  std::int64_t newest_ = 0;  // [us]
  int backward_ = 0;
};

}  // namespace luminav
