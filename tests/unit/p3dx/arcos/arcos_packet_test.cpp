#include "drivers/p3dx/arcos/arcos_packet.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/unit/p3dx/hex.hpp"

namespace luminav {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes random_payload(std::size_t size, std::mt19937& rng) {
  Bytes payload(size);
  for (std::uint8_t& byte : payload) {
    byte = static_cast<std::uint8_t>(rng());
  }
  return payload;
}

void append(Bytes& to, const Bytes& bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

/// Types of the packets found.
std::vector<int> types(PacketParser& parser) {
  std::vector<int> found;
  while (const auto packet = parser.next()) {
    found.push_back(packet->type);
  }
  return found;
}

TEST(ArcosChecksum, AddsPairsAndXorsTheOddByte) {
  EXPECT_EQ(arcos_checksum(hex("0B 3B 2C 01")), 0x373C);
  EXPECT_EQ(arcos_checksum(hex("20 1B FB 04")), 0x1B1F);  // beyond 16 bits
  EXPECT_EQ(arcos_checksum(hex("0F 2B 02 19 45")), 0x1101);
  EXPECT_EQ(arcos_checksum({}), 0);
}

TEST(ArcosChecksum, IsTheSameForLongPacketsAsByteByByte) {
  std::mt19937 rng(42);
  for (std::size_t size = 0; size <= 254; ++size) {
    const Bytes bytes = random_payload(size, rng);
    unsigned sum = 0;
    for (std::size_t i = 0; i + 1 < size; i += 2) {
      sum = (sum + (unsigned{bytes[i]} << 8) + bytes[i + 1]) & 0xFFFF;
    }
    if (size % 2 != 0) {
      sum ^= bytes[size - 1];
    }
    EXPECT_EQ(arcos_checksum(bytes), sum) << size;
  }
}

TEST(PacketParser, ReadsBackWhatWasEncodedAtEverySize) {
  std::mt19937 rng(1);
  for (std::size_t size = 0; size <= kLargestPayload; ++size) {  // counts 3..255: 127, 128 and 200 among them
    const Bytes payload = random_payload(size, rng);
    PacketParser parser;
    parser.push(encode_packet(0x42, payload));
    const auto packet = parser.next();
    ASSERT_TRUE(packet.has_value()) << size;
    EXPECT_EQ(packet->type, 0x42);
    EXPECT_THAT(Bytes(packet->payload.begin(), packet->payload.end()), testing::ElementsAreArray(payload));
    EXPECT_FALSE(parser.next().has_value());
    EXPECT_EQ(parser.bad_packets(), 0);
  }
}

TEST(PacketParser, TakesAStreamInPiecesOfAnySize) {
  std::mt19937 rng(2);
  Bytes stream;
  for (int i = 0; i < 40; ++i) {
    append(stream, encode_packet(static_cast<std::uint8_t>(i), random_payload(rng() % 253, rng)));
  }
  for (const std::size_t piece : {1U, 2U, 3U, 7U, 64U, 1000U}) {
    PacketParser parser;
    std::vector<int> found;
    for (std::size_t i = 0; i < stream.size(); i += piece) {
      parser.push(std::span(stream).subspan(i, std::min(piece, stream.size() - i)));
      for (const int type : types(parser)) {
        found.push_back(type);
      }
    }
    ASSERT_EQ(found.size(), 40U) << piece;
    EXPECT_EQ(found.back(), 39);
    EXPECT_EQ(parser.bad_packets(), 0);
  }
}

TEST(PacketParser, RejectsEveryFlippedBit) {
  const Bytes frame = encode_packet(0x33, hex("01 02 03 04 05 06 07"));
  for (std::size_t bit = 8 * 3; bit < 8 * frame.size(); ++bit) {
    Bytes damaged = frame;
    damaged[bit / 8] = static_cast<std::uint8_t>(damaged[bit / 8] ^ (1 << (bit % 8)));
    PacketParser parser;
    parser.push(damaged);
    EXPECT_FALSE(parser.next().has_value()) << bit;
    EXPECT_GE(parser.bad_packets(), 1) << bit;
  }
}

TEST(PacketParser, LosesOnlyTheBrokenPacket) {
  Bytes broken = encode_packet(2, hex("AA BB CC DD"));
  broken[5] ^= 0xFF;
  Bytes stream = encode_packet(1);
  append(stream, broken);
  append(stream, encode_packet(3));
  append(stream, encode_packet(4));
  PacketParser parser;
  parser.push(stream);
  EXPECT_THAT(types(parser), testing::ElementsAre(1, 3, 4));
  EXPECT_EQ(parser.bad_packets(), 1);
}

TEST(PacketParser, LosesOnlyTheCutPacket) {
  Bytes cut = encode_packet(2, hex("AA BB CC DD EE"));
  cut.resize(6);
  Bytes stream = encode_packet(1);
  append(stream, cut);
  append(stream, encode_packet(3, hex("01 02 03 04 05 06 07 08")));
  append(stream, encode_packet(4));
  PacketParser parser;
  parser.push(stream);
  EXPECT_THAT(types(parser), testing::ElementsAre(1, 3, 4));
}

TEST(PacketParser, FindsTheHeaderBehindADoubledFirstByte) {
  Bytes stream = hex("FA FA");
  append(stream, encode_packet(7));
  PacketParser parser;
  parser.push(stream);
  EXPECT_THAT(types(parser), testing::ElementsAre(7));
}

TEST(PacketParser, PassesAFalseHeaderThatClaimsTheMost) {
  Bytes stream = hex("FA FB FF");
  for (int i = 0; i < 10; ++i) {
    append(stream, encode_packet(static_cast<std::uint8_t>(i), Bytes(30, 0x55)));
  }
  PacketParser parser;
  parser.push(stream);
  EXPECT_EQ(types(parser).size(), 10U);
}

TEST(PacketParser, GivesUpAPartialPacketWhenToldTo) {
  Bytes stream = hex("FA FB FF 01");
  append(stream, encode_packet(9));
  PacketParser parser;
  parser.push(stream);
  EXPECT_FALSE(parser.next().has_value());
  EXPECT_TRUE(parser.has_partial());
  parser.give_up_partial();
  EXPECT_THAT(types(parser), testing::ElementsAre(9));
}

TEST(PacketParser, SurvivesTextBeforeTheFirstPacketAndHeadersInsideData) {
  Bytes stream = {'W', 'M', 'S', '2', '\r'};
  append(stream, encode_packet(1, hex("FA FB 03 FA FB FF FA")));
  append(stream, encode_packet(2));
  PacketParser parser;
  parser.push(stream);
  EXPECT_THAT(types(parser), testing::ElementsAre(1, 2));
}

TEST(PacketParser, RefusesCountsBelowThree) {
  for (const char* text : {"FA FB 00", "FA FB 01 00", "FA FB 02 00 00"}) {
    Bytes stream = hex(text);
    append(stream, encode_packet(5));
    PacketParser parser;
    parser.push(stream);
    EXPECT_THAT(types(parser), testing::ElementsAre(5)) << text;
  }
}

TEST(PacketParser, StampsAHeaderWithItsArrivalOnASlowLine) {
  const Bytes frame = encode_packet(0x32, Bytes(83, 0));
  ASSERT_EQ(frame.size(), 89U);
  constexpr double kByteTime = 1e7 / 9600.0;  // [us]
  PacketParser parser;
  parser.push(std::span(frame).first(10), 500'000, kByteTime);  // its first byte came 10 byte times before
  parser.push(std::span(frame).subspan(10), 590'000, kByteTime);
  const auto packet = parser.next();
  ASSERT_TRUE(packet.has_value());
  EXPECT_NEAR(static_cast<double>(packet->header_utime), 500'000 - 10 * kByteTime, 1.0);
}

TEST(PacketParser, FindsAllPacketsInNoise) {
  std::mt19937 rng(3);
  int sent = 0;
  int found = 0;
  PacketParser parser;
  for (int i = 0; i < 2000; ++i) {
    parser.push(random_payload(rng() % 40, rng));
    parser.push(encode_packet(0x77, random_payload(60, rng)));
    ++sent;
    for (const int type : types(parser)) {
      found += type == 0x77 ? 1 : 0;
    }
  }
  parser.push(Bytes(300, 0));  // releases what a false header held back
  for (const int type : types(parser)) {
    found += type == 0x77 ? 1 : 0;
  }
  EXPECT_EQ(found, sent);
}

}  // namespace
}  // namespace luminav
