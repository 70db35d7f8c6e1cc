#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "drivers/simulator/board_server.hpp"

namespace luminav {
namespace {

constexpr std::size_t kLongestBacklog = 512;  // [bytes] a slow line drops what does not fit

double now_seconds() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

int bits_per_second(speed_t speed) {
  switch (speed) {
    case B9600:
      return 9600;
    case B19200:
      return 19200;
    case B38400:
      return 38400;
    case B57600:
      return 57600;
    case B115200:
      return 115200;
    default:
      return 0;
  }
}

/// What a receiver at another rate makes of bytes: as many, and all wrong.
void garble(std::span<std::uint8_t> bytes) {
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>((byte << 3) ^ (byte >> 2) ^ 0xA5);
  }
}

bool is_symlink(const std::string& path) {
  std::error_code ignored;  // nothing there, or nothing that can be looked at: no link
  return std::filesystem::is_symlink(path, ignored);
}

/// A pseudo terminal with the rate of a serial line: bytes take their time, and rates must agree.
class PtyBoardServer final : public BoardServer {
 public:
  PtyBoardServer(BaseBoard& board, std::string link) : board_(board), link_(std::move(link)) {
    terminal_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    std::array<char, 128> name{};
    if (terminal_ < 0 || grantpt(terminal_) != 0 || unlockpt(terminal_) != 0 ||
        ptsname_r(terminal_, name.data(), name.size()) != 0) {
      throw std::runtime_error(std::string("cannot make a pseudo terminal (is /dev/pts mounted?): ") +
                               std::strerror(errno));
    }
    name_ = name.data();
    // Opened and closed once: from now on the terminal says "hung up" while nobody has it open.
    close(open(name_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
    if (!link_.empty()) {
      place_link();
    }
    budget_at_ = now_seconds();
  }
  PtyBoardServer(const PtyBoardServer&) = delete;
  PtyBoardServer& operator=(const PtyBoardServer&) = delete;
  ~PtyBoardServer() override {
    close(terminal_);
    if (!link_.empty() && leads_here()) {
      unlink(link_.c_str());
    }
  }

  void poll() override {
    if (unplugged_) {
      board_.take_output();
      backlog_.clear();
      discard_input();
      return;
    }
    const bool anybody = has_client();
    receive();  // the last words of a client that has left, too
    if (!anybody) {
      board_.take_output();
      backlog_.clear();
      return;
    }
    std::vector<std::uint8_t> output = board_.take_output();
    if (backlog_.size() + output.size() <= kLongestBacklog) {
      backlog_.insert(backlog_.end(), output.begin(), output.end());
    }
    transmit();
  }

  [[nodiscard]] std::vector<int> descriptors() const override {
    return has_client() ? std::vector{terminal_} : std::vector<int>{};
  }
  [[nodiscard]] bool has_client() const override {
    pollfd state{terminal_, POLLOUT, 0};
    return ::poll(&state, 1, 0) >= 0 && (state.revents & POLLHUP) == 0;
  }
  [[nodiscard]] std::string address() const override { return link_.empty() ? name_ : link_; }
  void set_unplugged(bool unplugged) override { unplugged_ = unplugged; }

 private:
  // One that a simulator before this one left is replaced; anything else may be somebody's work.
  void place_link() {
    if (is_symlink(link_)) {
      unlink(link_.c_str());
    }
    if (symlink(name_.c_str(), link_.c_str()) != 0) {
      const std::string why =
          errno == EEXIST ? "is there and no symbolic link, expected a free name" : std::strerror(errno);
      close(terminal_);
      throw std::runtime_error(link_ + ": " + why);
    }
  }

  // A simulator that was started since may have put its own link there.
  [[nodiscard]] bool leads_here() const {
    std::array<char, 128> target{};
    const ssize_t length = readlink(link_.c_str(), target.data(), target.size());
    return length > 0 && name_ == std::string_view(target.data(), static_cast<std::size_t>(length));
  }

  [[nodiscard]] bool rates_agree() const {
    termios settings{};
    return tcgetattr(terminal_, &settings) == 0 && bits_per_second(cfgetospeed(&settings)) == board_.baud();
  }

  void receive() {
    std::array<std::uint8_t, 4096> bytes;
    const ssize_t count = read(terminal_, bytes.data(), bytes.size());
    if (count > 0) {
      const std::span received = std::span(bytes).first(static_cast<std::size_t>(count));
      if (!rates_agree()) {
        garble(received);
      }
      board_.receive(received);
    }
  }

  void discard_input() {
    std::array<std::uint8_t, 4096> bytes;
    while (read(terminal_, bytes.data(), bytes.size()) > 0) {
    }
  }

  void transmit() {
    const double now = now_seconds();
    const double rate = board_.baud() / 10.0;  // [bytes/s] 8N1
    budget_ = std::min(budget_ + rate * (now - budget_at_), 0.05 * rate);
    budget_at_ = now;
    const std::size_t count = std::min(backlog_.size(), static_cast<std::size_t>(std::max(0.0, budget_)));
    if (count == 0) {
      return;
    }
    std::vector<std::uint8_t> bytes(backlog_.begin(), backlog_.begin() + static_cast<std::ptrdiff_t>(count));
    if (!rates_agree()) {
      garble(bytes);
    }
    const ssize_t written = write(terminal_, bytes.data(), bytes.size());
    if (written > 0) {
      backlog_.erase(backlog_.begin(), backlog_.begin() + written);
      budget_ -= static_cast<double>(written);
    }
  }

  BaseBoard& board_;
  std::string link_;
  std::string name_;
  int terminal_ = -1;
  std::vector<std::uint8_t> backlog_;
  double budget_ = 0.0;     // [bytes] that the line has had time for
  double budget_at_ = 0.0;  // [s]
  bool unplugged_ = false;
};

}  // namespace

std::unique_ptr<BoardServer> BoardServer::on_pty(BaseBoard& board, const std::string& link) {
  return std::make_unique<PtyBoardServer>(board, link);
}

}  // namespace luminav
