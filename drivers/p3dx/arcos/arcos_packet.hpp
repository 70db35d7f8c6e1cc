#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace luminav {

/// Largest payload behind the type byte: 255 minus the type and the two bytes of the checksum.
inline constexpr std::size_t kLargestPayload = 252;

/// Sum of big-endian byte pairs modulo 65536, an odd last byte XORed into the low byte. Over type and data.
std::uint16_t arcos_checksum(std::span<const std::uint8_t> bytes);

/// FA FB, count, type, data, checksum (high byte first). Both directions have the same frame. A payload above
/// kLargestPayload is cut there.
std::vector<std::uint8_t> encode_packet(std::uint8_t type, std::span<const std::uint8_t> payload = {});

/// One packet that passed its checksum. `payload` points into the parser and lives until its next call.
struct PacketView {
  std::uint8_t type = 0;                  // command number from a client, packet type from a robot
  std::span<const std::uint8_t> payload;  // behind the type
  std::int64_t header_utime = 0;          // [us] when the first header byte arrived
};

/// Finds the packets in a stream of bytes, in pieces of any size. After garbage, a wrong checksum or a cut packet it
/// looks for the next header right behind the false one, so that only the broken packet is lost. The count is unsigned.
class PacketParser {
 public:
  /// Takes bytes that had all arrived at `utime` [us], the last of them just then; `byte_time` [us] is what one byte
  /// takes on the line (0 for a network), so that the arrival of each header can be told.
  void push(std::span<const std::uint8_t> bytes, std::int64_t utime = 0, double byte_time = 0.0);

  /// The next whole packet, or nothing until more bytes arrive.
  std::optional<PacketView> next();

  /// A packet has begun and is not complete. A false header may claim 255 bytes and would hold back what follows it: a
  /// caller on whose line nothing comes any more gives it up.
  [[nodiscard]] bool has_partial() const { return begin_ < buffer_.size(); }
  void give_up_partial();
  /// When the last byte of such a packet came [us].
  [[nodiscard]] std::int64_t last_arrival() const { return chunks_.back().utime; }
  /// Forgets all bytes; the counter stays.
  void clear();

  [[nodiscard]] std::int64_t bad_packets() const { return bad_packets_; }  // wrong checksum, or cut

 private:
  struct Chunk {
    std::uint64_t end;   // stream offset behind the chunk
    std::int64_t utime;  // [us]
    double byte_time;    // [us]
  };
  [[nodiscard]] std::int64_t arrival(std::uint64_t offset) const;

  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0;   // first byte not yet used
  std::uint64_t base_ = 0;  // stream offset of buffer_[0]
  std::deque<Chunk> chunks_;
  std::int64_t bad_packets_ = 0;
};

}  // namespace luminav
