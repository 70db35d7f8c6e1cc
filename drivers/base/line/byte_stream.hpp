#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace luminav {

/// A line to a robot. Nothing here waits: reads and writes take what is possible now.
class ByteStream {
 public:
  ByteStream() = default;
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;
  virtual ~ByteStream() = default;

  /// Bytes read; 0 = nothing now. An end of file or an error closes the stream: look at is_open().
  virtual std::size_t read(std::span<std::uint8_t> bytes) = 0;
  /// Bytes taken, perhaps fewer than given.
  virtual std::size_t write(std::span<const std::uint8_t> bytes) = 0;
  /// For poll(); -1 when there is none.
  [[nodiscard]] virtual int descriptor() const = 0;
  [[nodiscard]] virtual bool is_open() const = 0;
  virtual void close() = 0;
  /// Why it closed by itself, one sentence; "" while open or closed by us.
  [[nodiscard]] virtual std::string failure() const { return {}; }

  /// Serial lines only: false where there is no such thing. Drops what was received and not yet read.
  virtual bool set_baud(int /*bits_per_second*/) { return false; }
  [[nodiscard]] virtual int baud() const { return 0; }  // [bit/s]; 0 = not a serial line
};

/// Opens a line, again and again when it is lost. Throws std::runtime_error with one plain sentence when it cannot.
using OpenStream = std::function<std::unique_ptr<ByteStream>()>;

/// "tcp:HOST:PORT" or the path of a serial device, which need not be there yet. Throws std::invalid_argument when it is
/// neither.
OpenStream stream_opener(const std::string& device, int baud);

/// A file descriptor that is read and written without waiting; owns it.
class DescriptorStream : public ByteStream {
 public:
  explicit DescriptorStream(int descriptor) : descriptor_(descriptor) {}
  ~DescriptorStream() override { DescriptorStream::close(); }

  std::size_t read(std::span<std::uint8_t> bytes) override;
  std::size_t write(std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] int descriptor() const override { return descriptor_; }
  [[nodiscard]] bool is_open() const override { return descriptor_ >= 0; }
  void close() override;
  [[nodiscard]] std::string failure() const override { return failure_; }

 protected:
  void fail(const std::string& reason);

 private:
  int descriptor_;
  std::string failure_;
};

/// A network connection; connects while it is used. Closing ends it for every process that shares it.
class TcpStream final : public DescriptorStream {
 public:
  TcpStream(const std::string& host, int port);
  /// A connection accepted by a server.
  explicit TcpStream(int descriptor) : DescriptorStream(descriptor), connected_(true) {}
  ~TcpStream() override { TcpStream::close(); }

  std::size_t read(std::span<std::uint8_t> bytes) override;
  std::size_t write(std::span<const std::uint8_t> bytes) override;
  void close() override;

 private:
  bool check_connected();
  bool connected_ = false;
  std::string peer_;
};

/// A serial device: raw, 8N1, no flow control.
class SerialStream final : public DescriptorStream {
 public:
  SerialStream(const std::string& device, int baud);
  bool set_baud(int bits_per_second) override;
  [[nodiscard]] int baud() const override { return baud_; }

 private:
  int baud_ = 0;
};

/// A line within one program, deterministic: what one end writes the other end reads. Each end can be opened again
/// after it was closed or the line was unplugged; bytes on their way are then lost, as on a serial line.
class MemoryPipe {
 public:
  /// The driver's end and the robot's. Throw std::runtime_error while unplugged.
  std::unique_ptr<ByteStream> open_driver_end() { return open(0); }
  std::unique_ptr<ByteStream> open_robot_end() { return open(1); }
  /// For a driver.
  OpenStream driver_opener() {
    return [this] { return open_driver_end(); };
  }

  /// Unplugged: both ends close, and nothing can be opened until it is plugged in again.
  void unplug();
  void plug_in();

 private:
  struct Line {
    std::deque<std::uint8_t> towards[2];  // bytes waiting for the driver's end [0] and the robot's [1]
    int generation[2] = {0, 0};           // which opening of an end is the valid one
    bool plugged = true;
  };
  class End;
  std::unique_ptr<ByteStream> open(int end);

  std::shared_ptr<Line> line_ = std::make_shared<Line>();
};

}  // namespace luminav
