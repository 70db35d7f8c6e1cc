#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "drivers/create2/oi/oi_commands.hpp"
#include "drivers/create2/oi/sensor_reading.hpp"
#include "drivers/create2/oi/stream_parser.hpp"

namespace luminav {
namespace {

using Bytes = std::vector<std::uint8_t>;
using testing::ElementsAre;

/// A robot that drives on a carpet, as it stands in a frame.
SensorReading driving() {
  SensorReading reading;
  reading.bump_left = true;
  reading.cliff_front_right = true;
  reading.overcurrent_right = true;
  reading.charging_state = 0;
  reading.voltage = 15.512;
  reading.mode = OiMode::kSafe;
  reading.left_count = 65'500;
  reading.right_count = 12;
  return reading;
}

TEST(OiCommands, AreTheBytesOfTheManual) {
  EXPECT_THAT(encode_opcode(OiOpcode::kStart), ElementsAre(128));
  EXPECT_THAT(encode_opcode(OiOpcode::kSafe), ElementsAre(131));
  EXPECT_THAT(encode_opcode(OiOpcode::kFull), ElementsAre(132));
  const Bytes ids = {29, 13};
  EXPECT_THAT(encode_stream_request(ids), ElementsAre(148, 2, 29, 13));
  EXPECT_THAT(encode_drive_direct(-200, 500), ElementsAre(145, 0x01, 0xF4, 0xFF, 0x38))
      << "right first, high byte first";
  EXPECT_EQ(encode_drive_direct(900, -900), encode_drive_direct(500, -500));
}

TEST(OiCommands, HaltAfterACommandThatWasCutOffAnywhere) {
  for (std::size_t length = 0; length <= 5; ++length) {
    Bytes line = encode_drive_direct(300, 300);
    line.resize(length);
    const Bytes halt = encode_halt();
    line.insert(line.end(), halt.begin(), halt.end());
    int left = 300;
    int right = 300;
    for (std::size_t i = 0; i < line.size();) {
      if (line[i] == 145 && i + 4 < line.size()) {
        right = static_cast<std::int16_t>(line[i + 1] << 8 | line[i + 2]);
        left = static_cast<std::int16_t>(line[i + 3] << 8 | line[i + 4]);
      }
      i += 1 + static_cast<std::size_t>(oi_data_size(line[i]));
    }
    EXPECT_EQ(left, 0) << length << " bytes";
    EXPECT_EQ(right, 0) << length << " bytes";
  }
}

TEST(StreamFrame, HasTheChecksumOfTheManual) {
  const Bytes payload = {29, 2, 25, 13, 0};
  EXPECT_THAT(encode_stream_frame(payload), ElementsAre(19, 5, 29, 2, 25, 13, 0, 163));
}

TEST(SensorReading, ComesBackAsItWasEncoded) {
  const Bytes payload = encode_readings(driving(), wanted_readings());
  ASSERT_EQ(payload.size(), readings_size());
  const auto decoded = decode_readings(payload);
  ASSERT_TRUE(decoded);
  EXPECT_EQ(encode_readings(*decoded, wanted_readings()), payload);
  EXPECT_TRUE(decoded->bump_left);
  EXPECT_FALSE(decoded->bump_right);
  EXPECT_TRUE(decoded->cliff_front_right);
  EXPECT_FALSE(decoded->cliff_left);
  EXPECT_TRUE(decoded->overcurrent_right);
  EXPECT_DOUBLE_EQ(decoded->voltage, 15.512);
  EXPECT_EQ(decoded->mode, OiMode::kSafe);
  EXPECT_EQ(decoded->left_count, 65'500);
}

TEST(SensorReading, FitsAFramePeriodOfTheSlowestLine) {
  constexpr double kFramePeriod = 0.015;  // [s]
  constexpr double kBitsPerByte = 10.0;   // 8N1
  const Bytes frame = encode_stream_frame(encode_readings(driving(), wanted_readings()));
  EXPECT_LT(kBitsPerByte * static_cast<double>(frame.size()) / 19200.0, kFramePeriod);
}

TEST(SensorReading, IsRefusedWhenItSaysTheImpossible) {
  const Bytes good = encode_readings(driving(), wanted_readings());
  for (const std::uint8_t id : {std::uint8_t{21}, std::uint8_t{35}}) {
    Bytes payload = good;
    std::size_t at = 0;
    for (const std::uint8_t before : wanted_readings()) {
      if (before == id) {
        break;
      }
      at += 1 + static_cast<std::size_t>(reading_size(before));
    }
    ASSERT_EQ(payload[at], id);
    payload[at + 1] = 9;
    EXPECT_FALSE(decode_readings(payload)) << static_cast<int>(id);
  }
  EXPECT_FALSE(decode_readings(std::span(good).first(good.size() - 1)));
}

TEST(StreamParser, FindsFramesAmongTheTextOfAStartAndInPiecesOfAnySize) {
  const std::string text = "bl-start\r\n2012-11-02\r\n\x13\x13";  // with headers in it
  Bytes line(text.begin(), text.end());
  constexpr int kFrames = 5;
  for (int i = 0; i < kFrames; ++i) {
    SensorReading reading = driving();
    reading.left_count = static_cast<std::uint16_t>(19 * 256 + i);  // a header inside of the frame
    const Bytes frame = encode_stream_frame(encode_readings(reading, wanted_readings()));
    line.insert(line.end(), frame.begin(), frame.end());
  }
  for (const std::size_t piece : {std::size_t{1}, std::size_t{7}, line.size()}) {
    StreamParser parser;
    int found = 0;
    for (std::size_t i = 0; i < line.size(); i += piece) {
      parser.push(std::span(line).subspan(i, std::min(piece, line.size() - i)));
      while (const auto payload = parser.next(readings_size())) {
        EXPECT_EQ(decode_readings(*payload)->left_count, 19 * 256 + found++);
      }
    }
    EXPECT_EQ(found, kFrames) << "pieces of " << piece;
    EXPECT_EQ(parser.bad_frames(), 0);
  }
}

TEST(StreamParser, LosesOnlyTheFrameThatIsBroken) {
  const Bytes frame = encode_stream_frame(encode_readings(driving(), wanted_readings()));
  std::mt19937 rng(42);
  for (int round = 0; round < 200; ++round) {
    Bytes line;
    for (int i = 0; i < 3; ++i) {
      line.insert(line.end(), frame.begin(), frame.end());
    }
    const std::size_t hit = frame.size() + rng() % frame.size();
    line[hit] ^= static_cast<std::uint8_t>(1U << rng() % 8);
    StreamParser parser;
    parser.push(line);
    int found = 0;
    while (parser.next(readings_size())) {
      ++found;
    }
    EXPECT_EQ(found, 2);
  }
}

}  // namespace
}  // namespace luminav
