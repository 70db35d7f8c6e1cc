#pragma once

#include <functional>
#include <memory>
#include <random>
#include <set>
#include <vector>

#include "drivers/base/line/byte_stream.hpp"
#include "drivers/p3dx/arcos/arcos_packet.hpp"

namespace luminav {

/// What a bad cable does to the bytes of both directions; the same each time.
struct LineNoise {
  double byte_errors = 0.0;            // fraction of bytes that arrive wrong
  std::size_t max_written = 1U << 20;  // bytes that one write takes
  std::size_t max_read = 1U << 20;     // bytes that one read gives
  std::mt19937 rng{42};
  std::set<std::vector<std::uint8_t>> sent;  // frames as the driver wrote them
  PacketParser writing;
  std::function<void(const PacketView&)> on_frame = [](const PacketView&) {};  // as it leaves

  void damage(std::span<std::uint8_t> bytes) {
    std::bernoulli_distribution wrong(byte_errors);
    for (std::uint8_t& byte : bytes) {
      if (byte_errors > 0.0 && wrong(rng)) {
        byte = static_cast<std::uint8_t>(rng());
      }
    }
  }
};

/// A line through that noise.
class NoisyStream final : public ByteStream {
 public:
  NoisyStream(std::unique_ptr<ByteStream> line, LineNoise& noise) : line_(std::move(line)), noise_(noise) {}

  std::size_t read(std::span<std::uint8_t> bytes) override {
    const std::size_t count = line_->read(bytes.first(std::min(bytes.size(), noise_.max_read)));
    noise_.damage(bytes.first(count));
    return count;
  }
  std::size_t write(std::span<const std::uint8_t> bytes) override {
    std::vector<std::uint8_t> damaged(
        bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(std::min(bytes.size(), noise_.max_written)));
    noise_.damage(damaged);
    const std::size_t count = line_->write(damaged);
    noise_.writing.push(bytes.first(count));
    while (const auto packet = noise_.writing.next()) {
      noise_.sent.insert(encode_packet(packet->type, packet->payload));
      noise_.on_frame(*packet);
    }
    return count;
  }
  [[nodiscard]] int descriptor() const override { return line_->descriptor(); }
  [[nodiscard]] bool is_open() const override { return line_->is_open(); }
  void close() override { line_->close(); }
  [[nodiscard]] std::string failure() const override { return line_->failure(); }

 private:
  std::unique_ptr<ByteStream> line_;
  LineNoise& noise_;
};

}  // namespace luminav
