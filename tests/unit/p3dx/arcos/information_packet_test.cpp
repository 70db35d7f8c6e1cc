#include "drivers/p3dx/arcos/information_packet.hpp"

#include <gtest/gtest.h>

#include <random>

#include "drivers/p3dx/arcos/arcos_packet.hpp"
#include "drivers/p3dx/arcos/configuration_packet.hpp"
#include "tests/unit/p3dx/hex.hpp"

namespace luminav {
namespace {

using Bytes = std::vector<std::uint8_t>;

const char* const kMovingFrame =
    "FA FB 28 33 06 7F B0 04 00 04 2C 01 2C 01 7E 00 00 00 00 07 00 00 02 00 DC 05 07 88 13 00 00 00 FF FF 7E 00 00 "
    "00 00 00 00 53 01";

Bytes payload_of(const Bytes& frame) {
  return {frame.begin() + 4, frame.end() - 2};
}

TEST(InformationPacket, ReadsARecordedPacketOfAMovingRobot) {
  PacketParser parser;
  parser.push(hex(kMovingFrame));
  const auto frame = parser.next();
  ASSERT_TRUE(frame.has_value());
  const auto packet = decode_information(frame->type, frame->payload);
  ASSERT_TRUE(packet.has_value());
  EXPECT_TRUE(packet->moving);
  EXPECT_EQ((packet->x_mm - -250) % 32768, 0);
  EXPECT_EQ(packet->y_mm, 1200);
  EXPECT_EQ(packet->heading, 1024);  // 90 degrees
  EXPECT_EQ(packet->left_mm_s, 300);
  EXPECT_EQ(packet->right_mm_s, 300);
  EXPECT_DOUBLE_EQ(packet->battery_voltage, 12.6);
  EXPECT_TRUE(packet->motors_enabled);
  EXPECT_EQ(packet->sonar_arrays, 3);
  ASSERT_EQ(packet->sonar.size(), 2U);
  EXPECT_EQ(packet->sonar[0].disc, 0);
  EXPECT_EQ(packet->sonar[0].range_mm, 1500);
  EXPECT_EQ(packet->sonar[1].disc, 7);
  EXPECT_EQ(packet->sonar[1].range_mm, 5000);
}

InformationPacket sample() {
  InformationPacket packet;
  packet.moving = true;
  packet.x_mm = -991;
  packet.y_mm = 30000;
  packet.heading = -1500;
  packet.left_mm_s = -200;
  packet.right_mm_s = 250;
  packet.battery_voltage = 12.3;
  packet.stall_right = true;
  packet.bumpers_front = 0x12;
  packet.bumpers_rear = 0x01;
  packet.heading_setpoint = 77;
  packet.motors_enabled = true;
  packet.sonar_arrays = 2;
  packet.stop_button = true;
  packet.compass = 12;
  packet.sonar = {{3, 444}, {11, 5000}};
  packet.charge_state = 0;
  packet.turn_rate = -123;
  packet.state_of_charge = 80;
  return packet;
}

TEST(InformationPacket, RoundTrips) {
  const InformationPacket sent = sample();
  const Bytes frame = encode_information(sent);
  const auto read = decode_information(frame[3], payload_of(frame));
  ASSERT_TRUE(read.has_value());
  EXPECT_TRUE(read->moving);
  EXPECT_EQ(read->x_mm, sent.x_mm);
  EXPECT_EQ(read->y_mm, sent.y_mm);
  EXPECT_EQ(read->heading, sent.heading);
  EXPECT_EQ(read->left_mm_s, sent.left_mm_s);
  EXPECT_EQ(read->right_mm_s, sent.right_mm_s);
  EXPECT_FALSE(read->stall_left);
  EXPECT_TRUE(read->stall_right);
  EXPECT_EQ(read->bumpers_front, sent.bumpers_front);
  EXPECT_EQ(read->bumpers_rear, sent.bumpers_rear);
  EXPECT_EQ(read->heading_setpoint, sent.heading_setpoint);
  EXPECT_TRUE(read->stop_button);
  EXPECT_FALSE(read->stop_button_stall);
  EXPECT_EQ(read->sonar.size(), 2U);
  EXPECT_EQ(read->charge_state, 0);
  EXPECT_EQ(read->turn_rate, -123);
  EXPECT_EQ(read->state_of_charge, 80);
  EXPECT_FALSE(read->temperature.has_value());
}

TEST(InformationPacket, HasTheLengthOfARealOne) {
  InformationPacket packet = sample();
  packet.sonar.assign(16, {1, 1000});
  EXPECT_EQ(encode_information(packet).size(), 89U);
  packet.sonar.clear();
  EXPECT_EQ(encode_information(packet).size(), 41U);
}

TEST(InformationPacket, ReadsAsMuchOfTheTailAsThereIs) {
  const Bytes payload = payload_of(encode_information(sample()));
  const std::size_t fixed = 19 + 2 * 3;
  for (std::size_t size = 0; size <= payload.size(); ++size) {
    const auto packet = decode_information(0x32, std::span(payload).first(size));
    ASSERT_EQ(packet.has_value(), size >= fixed) << size;
    if (packet) {
      EXPECT_EQ(packet->has_extension, size >= fixed + 5) << size;
      EXPECT_EQ(packet->charge_state.has_value(), size >= fixed + 8) << size;
      EXPECT_EQ(packet->turn_rate.has_value(), size >= fixed + 10) << size;
    }
  }
}

TEST(InformationPacket, RefusesSonarThatIsNotThere) {
  Bytes payload = payload_of(encode_information(sample()));
  payload[18] = 255;
  EXPECT_FALSE(decode_information(0x32, payload).has_value());
  payload[18] = 2;
  payload[19] = 32;  // no such disc
  EXPECT_FALSE(decode_information(0x32, payload).has_value());
}

TEST(InformationPacket, TakesTheFinerVoltageWhenTheFirstIsSaturated) {
  InformationPacket packet;
  packet.battery_voltage = 26.1;
  const Bytes frame = encode_information(packet);
  EXPECT_DOUBLE_EQ(decode_information(0x32, payload_of(frame))->battery_voltage, 26.1);
}

TEST(RobotIdentity, IsReadFromTheAnswerToTheHandshake) {
  const RobotIdentity identity{"MyBot", "Pioneer", "p3dx-sh"};
  EXPECT_EQ(encode_identity(identity),
            hex("FA FB 19 02 4D 79 42 6F 74 00 50 69 6F 6E 65 65 72 00 70 33 64 78 2D 73 68 00 48 02"));
  EXPECT_EQ(decode_identity(payload_of(encode_identity(identity))).subclass, "p3dx-sh");
}

TEST(RobotIdentity, BoundsTextsAndForgivesAMissingEnd) {
  const Bytes endless(200, 'x');
  EXPECT_EQ(decode_identity(endless).name, std::string(40, 'x'));
  EXPECT_EQ(decode_identity(hex("41 07 42 00")).name, "A?B");
  EXPECT_EQ(decode_identity({}).subclass, "");
}

TEST(EncoderPacket, RoundTripsWrappingTicks) {
  const Bytes frame = encode_encoder({-5, 2'000'000'000});
  const auto packet = decode_encoder(payload_of(frame));
  ASSERT_TRUE(packet.has_value());
  EXPECT_EQ(packet->left, -5);
  EXPECT_EQ(packet->right, 2'000'000'000);
  EXPECT_FALSE(decode_encoder(hex("01 02 03 04 05 06 07")).has_value());
}

TEST(InputOutputPacket, RoundTripsAndForgivesAnInflatedCount) {
  const Bytes frame = encode_input_output({{255, 1, 2, 3}, {7}, {0, 1023}});
  Bytes payload = payload_of(frame);
  payload[7] = 9;  // announces nine analog words and has two
  const auto packet = decode_input_output(payload);
  ASSERT_TRUE(packet.has_value());
  EXPECT_EQ(packet->digital_in.size(), 4U);
  EXPECT_EQ(packet->digital_out.at(0), 7);
  ASSERT_EQ(packet->analog.size(), 2U);
  EXPECT_EQ(packet->analog[1], 1023);
}

TEST(ConfigurationPacket, RoundTripsAndIsLongerThan127Bytes) {
  ConfigurationPacket sent;
  sent.serial = "GJC_3156";
  sent.name = "FAPESP_3156-of-a-long-name-for-a-robot";
  sent.drift_factor = -3;
  sent.watchdog = 1500;
  sent.kinematics_delay = 40;
  const Bytes frame = encode_configuration(sent);
  EXPECT_GT(frame[2], 127);
  const auto read = decode_configuration(payload_of(frame));
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->serial, sent.serial);
  EXPECT_EQ(read->name, sent.name);
  EXPECT_EQ(read->drift_factor, -3);
  EXPECT_EQ(read->watchdog, 1500);
  EXPECT_EQ(read->kinematics_delay, 40);
}

TEST(ConfigurationPacket, KeepsDefaultsForWhatOlderFirmwareDoesNotSend) {
  ConfigurationPacket sent;
  sent.deceleration = 555;
  sent.ticks_per_mm = 99;
  const Bytes payload = payload_of(encode_configuration(sent));
  int complete = 0;
  for (std::size_t size = 0; size <= payload.size(); ++size) {
    const auto read = decode_configuration(std::span(payload).first(size));
    if (read) {
      EXPECT_EQ(read->deceleration, 555);
      complete += read->ticks_per_mm == 99 ? 1 : 0;
    }
  }
  EXPECT_GT(complete, 0);
  EXPECT_FALSE(decode_configuration(std::span(payload).first(40)).has_value());
}

}  // namespace
}  // namespace luminav
