#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <string>

namespace luminav {

/// [us] since some moment.
std::int64_t monotonic_us();
/// Ids of requests must grow from one call to the next, also after a reboot: [us] of the wall clock.
std::int64_t new_id();

/// Hands over messages until `end` [us, monotonic] or an interruption. Throws std::runtime_error when the network
/// fails.
void listen_until(lcm::LCM& lcm, std::int64_t end);

/// Rewrites one line on a terminal; elsewhere a line only when it says something new.
class ProgressLine {
 public:
  void show(const std::string& text);
  void end() const;

 private:
  std::string last_;
  std::int64_t shown_ = 0;  // [us]
};

}  // namespace luminav
