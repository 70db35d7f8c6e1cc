#include "services/operator/terminal.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <stdexcept>

#include "services/common/process/clock.hpp"
#include "services/common/process/interrupts.hpp"

namespace luminav {
std::int64_t monotonic_us() {
  return read_clock(CLOCK_MONOTONIC);
}

std::int64_t new_id() {
  return read_clock(CLOCK_REALTIME);
}

void listen_until(lcm::LCM& lcm, std::int64_t end) {
  while (!is_interrupted()) {
    const std::int64_t left = end - monotonic_us();
    if (left <= 0) {
      return;
    }
    pollfd descriptor{lcm.getFileno(), POLLIN, 0};
    if (poll(&descriptor, 1, static_cast<int>(left / 1000 + 1)) > 0 && lcm.handleTimeout(0) < 0) {
      throw std::runtime_error("the LCM network failed");
    }
  }
}

void ProgressLine::show(const std::string& text) {
  if (isatty(STDOUT_FILENO) != 0) {
    fmt::print("\r\033[K{}", text);
    std::fflush(stdout);
  } else if (monotonic_us() - shown_ > 2'000'000 && text != last_) {
    fmt::print("{}\n", text);
    std::fflush(stdout);
    shown_ = monotonic_us();
  }
  last_ = text;
}

void ProgressLine::end() const {
  if (isatty(STDOUT_FILENO) != 0 && !last_.empty()) {
    fmt::print("\n");
  }
}

}  // namespace luminav
