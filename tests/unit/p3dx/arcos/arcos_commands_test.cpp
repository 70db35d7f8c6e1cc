#include "drivers/p3dx/arcos/arcos_commands.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/p3dx/hex.hpp"

namespace luminav {
namespace {

CommandArgument argument_of(const std::vector<std::uint8_t>& frame, PacketParser& parser) {
  parser.push(frame);
  const auto packet = parser.next();
  return packet ? decode_argument(packet->payload) : CommandArgument{};
}

TEST(ArcosCommands, EncodesTheFramesThatRobotsKnow) {
  EXPECT_EQ(encode_command(ArcosCommand::kPulse), hex("FA FB 03 00 00 00"));
  EXPECT_EQ(encode_command(ArcosCommand::kOpen), hex("FA FB 03 01 00 01"));
  EXPECT_EQ(encode_command(ArcosCommand::kClose), hex("FA FB 03 02 00 02"));
  EXPECT_EQ(encode_command(ArcosCommand::kOpen, 1), hex("FA FB 06 01 3B 01 00 02 3B"));
  EXPECT_EQ(encode_command(ArcosCommand::kClose, 1), hex("FA FB 06 02 3B 01 00 03 3B"));
  EXPECT_EQ(encode_command(ArcosCommand::kEnable, 1), hex("FA FB 06 04 3B 01 00 05 3B"));
  EXPECT_EQ(encode_command(ArcosCommand::kSonar, 1), hex("FA FB 06 1C 3B 01 00 1D 3B"));
  EXPECT_EQ(encode_command(ArcosCommand::kVelocity, 300), hex("FA FB 06 0B 3B 2C 01 37 3C"));
  EXPECT_EQ(encode_command(ArcosCommand::kVelocity, -300), hex("FA FB 06 0B 1B 2C 01 37 1C"));
  EXPECT_EQ(encode_command(ArcosCommand::kTurnRate, 30), hex("FA FB 06 15 3B 1E 00 33 3B"));
  EXPECT_EQ(encode_command(ArcosCommand::kTurnRate, -30), hex("FA FB 06 15 1B 1E 00 33 1B"));
  EXPECT_EQ(encode_command(ArcosCommand::kSetAcceleration, 300), hex("FA FB 06 05 3B 2C 01 31 3C"));
  EXPECT_EQ(encode_command(ArcosCommand::kSetAcceleration, -300), hex("FA FB 06 05 1B 2C 01 31 1C"));
  EXPECT_EQ(encode_command(ArcosCommand::kHeading, 90), hex("FA FB 06 0C 3B 5A 00 66 3B"));
  EXPECT_EQ(encode_command(ArcosCommand::kTurnBy, -45), hex("FA FB 06 0D 1B 2D 00 3A 1B"));
  EXPECT_EQ(encode_command(ArcosCommand::kStop), hex("FA FB 03 1D 00 1D"));
  EXPECT_EQ(encode_command(ArcosCommand::kEmergencyStop), hex("FA FB 03 37 00 37"));
  EXPECT_EQ(encode_command(ArcosCommand::kSetOrigin), hex("FA FB 03 07 00 07"));
  EXPECT_EQ(encode_command(ArcosCommand::kConfiguration, 1), hex("FA FB 06 12 3B 01 00 13 3B"));
  EXPECT_EQ(encode_command(ArcosCommand::kEncoder, 2), hex("FA FB 06 13 3B 02 00 15 3B"));
  EXPECT_EQ(encode_command(ArcosCommand::kHostBaud, 2), hex("FA FB 06 32 3B 02 00 34 3B"));
  EXPECT_EQ(encode_wheel_velocities({.left = -5, .right = 5}), hex("FA FB 06 20 3B 05 FB 26 36"));
  EXPECT_EQ(encode_command(ArcosCommand::kSay, std::string_view("\x19\x45", 2)), hex("FA FB 07 0F 2B 02 19 45 11 01"));
}

TEST(ArcosCommands, ReadsBothEncodingsOfWheelVelocities) {
  PacketParser parser;
  const int player = argument_of(hex("FA FB 06 20 3B 05 FB 26 36"), parser).value;
  const int aria = argument_of(hex("FA FB 06 20 1B FB 04 1B 1F"), parser).value;
  for (const int word : {player, aria}) {
    EXPECT_EQ(decode_wheel_velocities(word).right, 5);
    EXPECT_EQ(decode_wheel_velocities(word).left, -5);
  }
}

TEST(ArcosCommands, RoundTripsEveryWheelVelocity) {
  PacketParser parser;
  for (int left = -127; left <= 127; left += 3) {
    for (int right = -127; right <= 127; ++right) {
      const CommandArgument argument = argument_of(encode_wheel_velocities({left, right}), parser);
      const WheelVelocities wheels = decode_wheel_velocities(argument.value);
      ASSERT_EQ(wheels.left, left);
      ASSERT_EQ(wheels.right, right);
    }
  }
  const CommandArgument clamped = argument_of(encode_wheel_velocities({-1000, 1000}), parser);
  EXPECT_EQ(decode_wheel_velocities(clamped.value).left, -127);
  EXPECT_EQ(decode_wheel_velocities(clamped.value).right, 127);
}

TEST(ArcosCommands, RoundTripsIntegersAndClampsThem) {
  PacketParser parser;
  for (const int value : {0, 1, -1, 255, 256, -256, 32767, -32767}) {
    const CommandArgument argument = argument_of(encode_command(ArcosCommand::kVelocity, value), parser);
    EXPECT_EQ(argument.kind, CommandArgument::Kind::kInteger);
    EXPECT_EQ(argument.value, value);
  }
  EXPECT_EQ(argument_of(encode_command(ArcosCommand::kVelocity, -32768), parser).value, -32767);
  EXPECT_EQ(argument_of(encode_command(ArcosCommand::kVelocity, 100000), parser).value, 32767);
}

TEST(ArcosCommands, ReadsTextsWithAndWithoutALength) {
  const auto with = hex("2B 02 19 45");
  const auto without = hex("2B FF 41 42 00");
  EXPECT_THAT(decode_argument(with).text, testing::ElementsAre(0x19, 0x45));
  EXPECT_EQ(decode_argument(without).text.size(), 4U);
}

TEST(ArcosCommands, ToleratesCutAndUnknownArguments) {
  for (const char* text : {"", "3B", "3B 01", "1B 01", "99 01 02", "2B"}) {
    EXPECT_EQ(decode_argument(hex(text)).value, 0) << text;
  }
  EXPECT_EQ(decode_argument(hex("3B 05 00 77 88")).value, 5);  // more than there should be
}

TEST(ArcosCommands, KnowsTheRatesOfTheLine) {
  EXPECT_EQ(baud_of_code(0), 9600);
  EXPECT_EQ(baud_of_code(4), 115200);
  EXPECT_EQ(baud_of_code(5), 0);
  EXPECT_EQ(baud_of_code(-1), 0);
  EXPECT_EQ(code_of_baud(38400), 2);
  EXPECT_EQ(code_of_baud(1234), -1);
}

}  // namespace
}  // namespace luminav
