#include "services/launcher/sheriff/session.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <stdexcept>

#include "services/common/process/interrupts.hpp"
#include "services/launcher/sheriff/status_table.hpp"

namespace luminav::launcher {
namespace {

constexpr int kTickPeriod = 50;                 // [ms]
constexpr std::int64_t kTablePeriod = 500'000;  // [us]

std::size_t terminal_width() {
  winsize size{};
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20 ? size.ws_col - 1U : 0U;
}

void drain(lcm::LCM& lcm) {
  constexpr int kMaxAtOnce = 500;
  for (int i = 0; i < kMaxAtOnce; ++i) {
    const int handled = lcm.handleTimeout(0);
    if (handled < 0 && errno != EINTR) {
      throw std::runtime_error("the LCM network failed");
    }
    if (handled <= 0) {
      return;
    }
  }
}

}  // namespace

Session::Session(lcm::LCM& procman, lcm::LCM* data, Sheriff& sheriff)
    : procman_(procman), data_(data), sheriff_(sheriff), terminal_(isatty(STDOUT_FILENO) == 1) {}

void Session::pump() {
  std::vector<pollfd> descriptors{{procman_.getFileno(), POLLIN, 0}};
  if (data_ != nullptr) {
    descriptors.push_back({data_->getFileno(), POLLIN, 0});
  }
  poll(descriptors.data(), descriptors.size(), kTickPeriod);
  drain(procman_);
  if (data_ != nullptr) {
    drain(*data_);
  }
  sheriff_.tick(Instant::read());
}

bool Session::run_until(const std::function<bool()>& done, bool show) {
  while (!done()) {
    pump();  // first: what `done` has ordered goes out even if an interrupt is waiting
    if (take_interrupt()) {
      return false;
    }
    const std::int64_t now = Instant::read().steady;
    if (show && !terminal_) {
      print_changes();
    } else if (show && now - shown_ >= kTablePeriod) {
      shown_ = now;
      show_table();
    }
  }
  return true;
}

bool Session::run_for(double seconds, bool show) {
  const std::int64_t end = Instant::read().steady + static_cast<std::int64_t>(seconds * 1e6);
  return run_until([end] { return Instant::read().steady >= end; }, show);
}

std::optional<bool> Session::run_script(ScriptRun& script, bool show) {
  auto progress = ScriptRun::Progress::kGoingOn;
  const bool finished = run_until(
      [&] {
        progress = script.step(Instant::read().steady);
        return progress != ScriptRun::Progress::kGoingOn;
      },
      show);
  if (!finished) {
    return std::nullopt;
  }
  if (progress == ScriptRun::Progress::kSucceeded) {
    // The last orders of a script need no answer, but they have to go out.
    pump();
  }
  return progress == ScriptRun::Progress::kSucceeded;
}

void Session::erase_table() {
  if (lines_on_screen_ > 0) {
    fmt::print("\x1b[{}A\x1b[J", lines_on_screen_);
    lines_on_screen_ = 0;
  }
}

void Session::show_table() {
  const std::vector<std::string> lines = status_table(sheriff_, terminal_ ? terminal_width() : 0);
  erase_table();
  for (const std::string& line : lines) {
    fmt::print("{}\n", line);
  }
  lines_on_screen_ = terminal_ ? lines.size() : 0;
  std::fflush(stdout);
}

void Session::print(const std::string& line) {
  erase_table();
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

void Session::print_changes() {
  std::vector<std::pair<std::string, std::string>> current;
  for (const CommandState& state : sheriff_.states()) {
    current.emplace_back(state.deputy + "/" + state.name,
                         state.detail.empty() ? to_string(state.condition)
                                              : fmt::format("{} ({})", to_string(state.condition), state.detail));
  }
  for (const auto& entry : current) {
    if (std::find(last_.begin(), last_.end(), entry) == last_.end()) {
      print(fmt::format("{} {}", entry.first, entry.second));
    }
  }
  last_ = std::move(current);
}

}  // namespace luminav::launcher
