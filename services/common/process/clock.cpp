#include "services/common/process/clock.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>

namespace luminav {
namespace {

std::int64_t read_clock(clockid_t id) {
  timespec now{};
  clock_gettime(id, &now);
  return static_cast<std::int64_t>(now.tv_sec) * 1'000'000 + now.tv_nsec / 1000;
}

std::filesystem::path offset_file() {
  std::string boot = "unknown";
  std::ifstream("/proc/sys/kernel/random/boot_id") >> boot;
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  const std::filesystem::path folder = runtime != nullptr && *runtime != '\0' ? runtime : "/tmp";
  return folder / fmt::format("luminav-clock-{}-{}", getuid(), boot);
}

/// The first driver of a boot writes the offset; link() makes exactly one of several win.
std::int64_t shared_offset() {
  const std::filesystem::path file = offset_file();
  std::int64_t offset = 0;
  if (std::ifstream(file) >> offset) {
    return offset;
  }
  offset = read_clock(CLOCK_REALTIME) - read_clock(CLOCK_MONOTONIC);
  const std::string temporary = fmt::format("{}.{}", file.string(), getpid());
  std::ofstream(temporary) << offset << '\n';
  const bool won = link(temporary.c_str(), file.c_str()) == 0;
  unlink(temporary.c_str());
  std::int64_t winner = 0;
  return !won && std::ifstream(file) >> winner ? winner : offset;
}

}  // namespace

HostClock::HostClock() : offset_(shared_offset()) {}

std::int64_t HostClock::utime() const {
  return read_clock(CLOCK_MONOTONIC) + offset_;
}

}  // namespace luminav
