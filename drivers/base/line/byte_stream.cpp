#include "drivers/base/line/byte_stream.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace luminav {

std::size_t DescriptorStream::read(std::span<std::uint8_t> bytes) {
  while (is_open()) {
    const ssize_t count = ::read(descriptor_, bytes.data(), bytes.size());
    if (count > 0) {
      return static_cast<std::size_t>(count);
    }
    if (count == 0) {
      fail("the other side has closed the line");
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      break;
    } else if (errno != EINTR) {
      fail(std::strerror(errno));  // an unplugged USB adapter says EIO
    }
  }
  return 0;
}

std::size_t DescriptorStream::write(std::span<const std::uint8_t> bytes) {
  while (is_open() && !bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count >= 0) {
      return static_cast<std::size_t>(count);
    }
    if (errno == EAGAIN || errno == EWOULDBLOCK) {
      break;
    }
    if (errno != EINTR) {
      fail(std::strerror(errno));
    }
  }
  return 0;
}

void DescriptorStream::close() {
  if (descriptor_ >= 0) {
    ::close(descriptor_);
    descriptor_ = -1;
  }
}

void DescriptorStream::fail(const std::string& reason) {
  failure_ = reason;
  close();
}

OpenStream stream_opener(const std::string& device, int baud) {
  constexpr std::string_view kTcp = "tcp:";
  if (!device.starts_with(kTcp)) {
    if (!device.starts_with('/')) {
      throw std::invalid_argument("device = \"" + device + "\": must be tcp:HOST:PORT or the path of a serial device");
    }
    std::error_code error;  // what is not there may be plugged in later, but these remain what they are
    const std::filesystem::file_status status = std::filesystem::status(device, error);
    if (std::filesystem::is_directory(status) || std::filesystem::is_regular_file(status)) {
      throw std::invalid_argument(device + ": is " +
                                  (std::filesystem::is_directory(status) ? "a directory" : "a file") +
                                  ", not a serial device");
    }
    return [device, baud] { return std::make_unique<SerialStream>(device, baud); };
  }
  const std::size_t colon = device.rfind(':');
  const std::string host = colon > kTcp.size() ? device.substr(kTcp.size(), colon - kTcp.size()) : "";
  int port = 0;
  const char* end = device.data() + device.size();
  const auto [last, error] = std::from_chars(device.data() + colon + 1, end, port);
  if (host.empty() || error != std::errc() || last != end || port < 1 || port > 65535) {
    throw std::invalid_argument("device = \"" + device + "\": must be tcp:HOST:PORT with a port of 1..65535");
  }
  return [host, port] { return std::make_unique<TcpStream>(host, port); };
}

/// One opening of one end of the pipe; a later opening of the same end closes it.
class MemoryPipe::End final : public ByteStream {
 public:
  End(std::shared_ptr<Line> line, int end)
      : line_(std::move(line)), own_(static_cast<std::size_t>(end)), generation_(++line_->generation[own_]) {
    line_->towards[own_].clear();
  }
  ~End() override { End::close(); }

  std::size_t read(std::span<std::uint8_t> bytes) override {
    if (!is_open()) {
      return 0;
    }
    std::deque<std::uint8_t>& waiting = line_->towards[own_];
    const std::size_t count = std::min(bytes.size(), waiting.size());
    const auto last = waiting.begin() + static_cast<std::ptrdiff_t>(count);
    std::copy(waiting.begin(), last, bytes.begin());
    waiting.erase(waiting.begin(), last);
    return count;
  }

  std::size_t write(std::span<const std::uint8_t> bytes) override {
    if (!is_open()) {
      return 0;
    }
    // As a serial line: bytes go out whether or not anybody listens, and an absent listener loses them.
    std::deque<std::uint8_t>& waiting = line_->towards[1 - own_];
    waiting.insert(waiting.end(), bytes.begin(), bytes.end());
    if (waiting.size() > kLongestQueue) {
      waiting.erase(waiting.begin(), waiting.end() - static_cast<std::ptrdiff_t>(kLongestQueue));
    }
    return bytes.size();
  }

  [[nodiscard]] int descriptor() const override { return -1; }
  [[nodiscard]] bool is_open() const override {
    return !closed_ && line_->plugged && line_->generation[own_] == generation_;
  }
  void close() override { closed_ = true; }
  [[nodiscard]] std::string failure() const override { return closed_ || is_open() ? "" : "the line was unplugged"; }

 private:
  static constexpr std::size_t kLongestQueue = 65536;
  std::shared_ptr<Line> line_;
  std::size_t own_;
  int generation_;
  bool closed_ = false;
};

std::unique_ptr<ByteStream> MemoryPipe::open(int end) {
  if (!line_->plugged) {
    throw std::runtime_error("the line is unplugged");
  }
  return std::make_unique<End>(line_, end);
}

void MemoryPipe::unplug() {
  line_->plugged = false;
  for (int end : {0, 1}) {
    line_->towards[end].clear();
    ++line_->generation[end];
  }
}

void MemoryPipe::plug_in() {
  line_->plugged = true;
}

}  // namespace luminav
