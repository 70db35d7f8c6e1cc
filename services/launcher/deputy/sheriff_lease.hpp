#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace luminav::launcher {

/// Start time [us] of a sheriff from its id "host:pid:utime"; 0 when the id has another form.
[[nodiscard]] std::int64_t start_of_sheriff(std::string_view sheriff_id);

/// Lets two sheriffs on one network not undo each other's orders once a second: the one that started last commands,
/// and an older one is heard again when the younger has been silent for a while. Order, not security: ids are free
/// text.
class SheriffLease {
 public:
  static constexpr std::int64_t kLength = 3'000'000;  // [us] three missed orders

  [[nodiscard]] bool accepts(const std::string& sheriff_id, std::int64_t steady_now) {
    const bool held = !holder_.empty() && steady_now - heard_ < kLength;
    if (held && sheriff_id != holder_ && start_of_sheriff(sheriff_id) < start_of_sheriff(holder_)) {
      return false;
    }
    holder_ = sheriff_id;
    heard_ = steady_now;
    return true;
  }
  [[nodiscard]] const std::string& holder() const { return holder_; }

 private:
  std::string holder_;
  std::int64_t heard_ = 0;  // [us]
};

}  // namespace luminav::launcher
