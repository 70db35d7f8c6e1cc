#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace luminav {

/// Reads little-endian words one after another. What lies behind the end reads as 0 and `complete` turns false.
class WordReader {
 public:
  explicit WordReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  std::uint8_t u8() { return take(); }
  std::int8_t s8() { return static_cast<std::int8_t>(take()); }
  std::uint16_t u16() {
    const std::uint16_t low = take();
    return static_cast<std::uint16_t>(low | (take() << 8));
  }
  std::int16_t s16() { return static_cast<std::int16_t>(u16()); }
  std::int32_t s32() {
    const std::uint32_t low = u16();
    return static_cast<std::int32_t>(low | (static_cast<std::uint32_t>(u16()) << 16));
  }
  /// Up to its NUL; a missing NUL ends at the last byte and leaves `complete` false.
  std::string text() {
    std::string result;
    while (!bytes_.empty()) {
      const auto byte = static_cast<char>(take());
      if (byte == '\0') {
        return result;
      }
      result.push_back(byte);
    }
    complete_ = false;
    return result;
  }

  [[nodiscard]] std::size_t left() const { return bytes_.size(); }
  [[nodiscard]] bool complete() const { return complete_; }

 private:
  std::uint8_t take() {
    if (bytes_.empty()) {
      complete_ = false;
      return 0;
    }
    const std::uint8_t byte = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return byte;
  }

  std::span<const std::uint8_t> bytes_;
  bool complete_ = true;
};

/// Writes little-endian words one after another.
class WordWriter {
 public:
  void u8(int value) { bytes_.push_back(static_cast<std::uint8_t>(value & 0xFF)); }
  void u16(int value) {
    u8(value);
    u8(value >> 8);
  }
  void u32(std::uint32_t value) {
    u16(static_cast<int>(value & 0xFFFF));
    u16(static_cast<int>(value >> 16));
  }
  void text(std::string_view value) {
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    bytes_.push_back(0);
  }

  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

}  // namespace luminav
