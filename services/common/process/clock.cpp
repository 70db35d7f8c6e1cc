#include "services/common/process/clock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>

namespace luminav {
namespace {

std::filesystem::path offset_file() {
  std::string boot = "unknown";
  std::ifstream("/proc/sys/kernel/random/boot_id") >> boot;
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  const std::filesystem::path folder = runtime != nullptr && *runtime != '\0' ? runtime : "/tmp";
  return folder / fmt::format("luminav-clock-{}-{}", getuid(), boot);
}

/// What a driver of this user and boot has written. The folder may be everybody's: a file of another user's, or a link
/// to one, would set this robot's time. Throws std::runtime_error for one.
std::optional<std::int64_t> read_offset(const std::filesystem::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor < 0 && errno == ENOENT) {
    return std::nullopt;
  }
  struct stat status {};
  const bool ours = descriptor >= 0 && fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) &&
                    status.st_uid == getuid() && (status.st_mode & (S_IWGRP | S_IWOTH)) == 0;
  std::array<char, 32> text{};
  const ssize_t size = ours ? read(descriptor, text.data(), text.size()) : 0;
  if (descriptor >= 0) {
    close(descriptor);
  }
  if (!ours) {
    throw std::runtime_error(
        fmt::format("{}: not a file of this user alone, so it may not set the clock; remove it", file.string()));
  }
  std::int64_t offset = 0;
  const char* end = text.data() + std::max<ssize_t>(size, 0);
  return std::from_chars(text.data(), end, offset).ec == std::errc() ? std::optional(offset) : std::nullopt;
}

/// The first driver of a boot writes the offset; link() makes exactly one of several win.
std::int64_t shared_offset() {
  const std::filesystem::path file = offset_file();
  if (const auto known = read_offset(file)) {
    return *known;
  }
  const std::int64_t offset = read_clock(CLOCK_REALTIME) - read_clock(CLOCK_MONOTONIC);
  const std::string temporary = fmt::format("{}.{}", file.string(), getpid());
  unlink(temporary.c_str());
  const int descriptor = open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
  const std::string text = fmt::format("{}\n", offset);
  const bool written =
      descriptor >= 0 && write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (descriptor >= 0) {
    close(descriptor);
  }
  const bool won = written && link(temporary.c_str(), file.c_str()) == 0;
  unlink(temporary.c_str());
  return won ? offset : read_offset(file).value_or(offset);
}

}  // namespace

HostClock::HostClock() : offset_(shared_offset()) {}

std::int64_t HostClock::utime() const {
  return read_clock(CLOCK_MONOTONIC) + offset_;
}

}  // namespace luminav
