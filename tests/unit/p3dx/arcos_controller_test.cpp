#include "drivers/simulator/arcos/arcos_controller.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "services/common/geometry/angle.hpp"
#include "tests/node/p3dx/simulated_base.hpp"
#include "tests/unit/p3dx/hex.hpp"

namespace luminav {
namespace {

/// A client of the controller that keeps what it hears.
struct Client {
  explicit Client(const ArcosConfig& config = {}) : base(config) {}

  void send(const std::vector<std::uint8_t>& frame) { base.controller().receive(frame); }
  void send(ArcosCommand command) { send(encode_command(command)); }
  void send(ArcosCommand command, int value) { send(encode_command(command, value)); }

  void connect() {
    for (const std::uint8_t sync : {packet_type::kSync0, packet_type::kSync1, packet_type::kSync2}) {
      send(encode_packet(sync));
    }
    send(ArcosCommand::kOpen, 1);
    run(0.0);
  }
  void drive() {
    connect();
    send(ArcosCommand::kEnable, 1);
  }

  /// Lets time go on, with a keep-alive each 0.5 s.
  void run(double seconds, bool pulse = true) {
    hear(base.controller().take_output());
    for (int i = 0; i < static_cast<int>(std::lround(100.0 * seconds)); ++i) {
      if (pulse && i % 50 == 0) {
        send(ArcosCommand::kPulse);
      }
      base.step(&line);
    }
  }

  void hear(const std::vector<std::uint8_t>& bytes) {
    parser.push(bytes);
    while (const auto packet = parser.next()) {
      types.push_back(packet->type);
      if (is_information(packet->type)) {
        information.push_back(*decode_information(packet->type, packet->payload));
      } else if (packet->type == packet_type::kConfiguration) {
        configuration = *decode_configuration(packet->payload);
      } else if (packet->type == packet_type::kSync2) {
        identity = decode_identity(packet->payload);
      } else if (packet->type == packet_type::kEncoder) {
        encoders.push_back(*decode_encoder(packet->payload));
      }
    }
  }

  /// The controller's side of the line.
  struct Line final : ByteStream {
    explicit Line(Client& owner) : client(owner) {}
    std::size_t read(std::span<std::uint8_t>) override { return 0; }
    std::size_t write(std::span<const std::uint8_t> bytes) override {
      client.hear({bytes.begin(), bytes.end()});
      return bytes.size();
    }
    [[nodiscard]] int descriptor() const override { return -1; }
    [[nodiscard]] bool is_open() const override { return true; }
    void close() override {}
    Client& client;
  };

  SimulatedBase base;
  Line line{*this};
  PacketParser parser;
  std::vector<int> types;
  std::vector<InformationPacket> information;
  std::vector<EncoderPacket> encoders;
  ConfigurationPacket configuration;
  RobotIdentity identity;
};

TEST(ArcosController, EchoesTheSyncsAndSaysWhoItIs) {
  Client client;
  client.send(hex("57 4D 53 32 0D"));  // "WMS2\r", the greeting for an old radio modem
  client.connect();
  EXPECT_THAT(client.types, testing::ElementsAre(0, 1, 2));
  EXPECT_EQ(client.identity.robot_class, "Pioneer");
  EXPECT_EQ(client.identity.subclass, "p3dx-sh");
  EXPECT_TRUE(client.base.controller().session_open());
}

TEST(ArcosController, WaitsForTheFirstSyncWhenTheyComeOutOfOrder) {
  Client client;
  client.send(encode_packet(2));
  client.send(encode_packet(1));
  client.run(0.1, false);
  EXPECT_TRUE(client.types.empty());
  client.connect();
  EXPECT_EQ(client.types.size(), 3U);
}

TEST(ArcosController, IsNotHeldUpByADamagedCount) {
  Client client;
  client.send(hex("FA FB F3 00 00 00"));
  client.run(0.2, false);
  client.connect();
  EXPECT_THAT(client.types, testing::ElementsAre(0, 1, 2));
}

TEST(ArcosController, SendsItsInformationEveryTenthOfASecondWithoutDrift) {
  Client client;
  client.connect();
  client.run(600.0);
  EXPECT_EQ(client.information.size(), 6000U);
  EXPECT_FALSE(client.information.front().motors_enabled);
  EXPECT_FALSE(client.information.front().moving);
}

TEST(ArcosController, MovesOnlyWithItsMotorsOn) {
  Client client;
  client.connect();
  client.send(ArcosCommand::kVelocity, 300);
  client.run(1.0);
  EXPECT_EQ(client.base.travel, 0.0);
  client.send(ArcosCommand::kEnable, 1);
  client.run(1.0);
  EXPECT_EQ(client.base.travel, 0.0);  // the setpoint did not wait for the motors
  client.send(ArcosCommand::kVelocity, 300);
  client.run(1.0);
  EXPECT_GT(client.base.travel, 0.1);
}

TEST(ArcosController, DrivesATrapezoid) {
  Client client;
  client.drive();
  client.send(ArcosCommand::kSetAcceleration, 500);
  client.send(ArcosCommand::kSetAcceleration, -1000);
  client.send(ArcosCommand::kVelocity, 400);
  client.run(0.4);
  EXPECT_NEAR(client.base.outputs.linear, 0.2, 1e-9);
  client.run(0.6);
  EXPECT_NEAR(client.base.outputs.linear, 0.4, 1e-9);
  client.run(0.3);
  EXPECT_TRUE(client.information.back().moving);
  client.send(ArcosCommand::kStop);
  client.run(0.2);
  EXPECT_NEAR(client.base.outputs.linear, 0.2, 1e-9);
  client.run(0.2);
  EXPECT_NEAR(client.base.outputs.linear, 0.0, 1e-9);
  // v^2 / 2a + v t + v^2 / 2d; standing again it says so
  EXPECT_NEAR(client.base.travel, 0.16 + 0.5 * 0.4 + 0.08, 0.01);
  client.run(0.5);
  EXPECT_FALSE(client.information.back().moving);
}

TEST(ArcosController, KeepsWithinTheLimitsInForceAndTheTops) {
  Client client;
  client.drive();
  client.send(ArcosCommand::kSetMaximumVelocity, 250);
  client.send(ArcosCommand::kVelocity, 2000);
  client.send(ArcosCommand::kTurnRate, -1000);
  client.run(5.0);
  EXPECT_NEAR(client.base.outputs.linear, 0.25, 1e-9);
  EXPECT_NEAR(client.base.outputs.angular, radians(-150.0), 1e-9);
  client.send(ArcosCommand::kSetMaximumVelocity, 9000);
  client.send(ArcosCommand::kVelocity, 2000);
  client.run(10.0);
  EXPECT_NEAR(client.base.outputs.linear, 1.0, 1e-9);
}

TEST(ArcosController, ReportsTheLimitsInForce) {
  Client client;
  client.drive();
  client.send(ArcosCommand::kSetAcceleration, -700);
  client.send(ArcosCommand::kSetMaximumTurnRate, 99);
  client.send(ArcosCommand::kConfiguration, 1);
  client.run(0.1);
  EXPECT_EQ(client.configuration.deceleration, 700);
  EXPECT_EQ(client.configuration.acceleration, 300);
  EXPECT_EQ(client.configuration.turn_rate_maximum, 99);
  EXPECT_EQ(client.configuration.watchdog, 2000);
}

TEST(ArcosController, TurnsToAHeadingWhileItDrives) {
  for (const int heading : {90, -90, 180, -45}) {
    Client client;
    client.drive();
    client.send(ArcosCommand::kVelocity, 200);
    client.send(ArcosCommand::kHeading, heading);
    client.run(5.0);
    EXPECT_NEAR(wrap_angle(client.base.turned - radians(heading)), 0.0, radians(0.5)) << heading;
    EXPECT_NEAR(client.base.outputs.linear, 0.2, 1e-9);
  }
}

TEST(ArcosController, TurnsByAnAngleAndMovesByADistance) {
  Client client;
  client.drive();
  client.send(ArcosCommand::kTurnBy, -45);
  client.run(4.0);
  EXPECT_NEAR(client.base.turned, radians(-45.0), radians(0.5));
  client.send(ArcosCommand::kMove, -500);
  client.run(6.0);
  EXPECT_NEAR(client.base.travel, 0.5, 0.005);
  EXPECT_NEAR(client.base.outputs.linear, 0.0, 0.005);
}

TEST(ArcosController, UnderstandsBothEncodingsOfWheelVelocities) {
  for (const char* frame : {"FA FB 06 20 3B 05 FB 26 36", "FA FB 06 20 1B FB 04 1B 1F"}) {
    Client client;
    client.drive();
    client.send(hex(frame));
    client.run(3.0);
    EXPECT_NEAR(client.base.outputs.linear, 0.0, 1e-9);
    EXPECT_NEAR(client.base.outputs.angular, 0.2 / 0.33, 1e-9);
  }
}

TEST(ArcosController, StopsHarderInAnEmergency) {
  Client client;
  client.drive();
  client.send(ArcosCommand::kVelocity, 600);
  client.run(3.0);
  client.send(ArcosCommand::kEmergencyStop);
  client.run(0.25);
  EXPECT_NEAR(client.base.outputs.linear, 0.0, 1e-9);
  EXPECT_TRUE(client.base.outputs.motors_enabled);
}

TEST(ArcosController, HaltsWhenTheClientIsSilentAndResumesWithTheNextPacket) {
  Client client;
  client.drive();
  client.send(ArcosCommand::kVelocity, 300);
  client.run(1.9, false);
  EXPECT_NEAR(client.base.outputs.linear, 0.3, 1e-9);
  client.run(1.5, false);
  EXPECT_NEAR(client.base.outputs.linear, 0.0, 1e-9);
  client.send(ArcosCommand::kPulse);
  client.run(1.5, false);
  EXPECT_NEAR(client.base.outputs.linear, 0.3, 1e-9);
}

TEST(ArcosController, EndsTheSessionWithMotorsOff) {
  Client client;
  client.drive();
  client.send(ArcosCommand::kVelocity, 300);
  client.run(2.0);
  client.send(ArcosCommand::kClose, 1);
  const std::size_t packets = client.information.size();
  client.run(1.0, false);
  EXPECT_EQ(client.information.size(), packets);
  EXPECT_FALSE(client.base.outputs.motors_enabled);
  EXPECT_NEAR(client.base.outputs.linear, 0.0, 1e-9);
  client.types.clear();
  client.connect();
  EXPECT_THAT(client.types, testing::ElementsAre(0, 1, 2));
}

TEST(ArcosController, FiresItsSonarsOneByOne) {
  Client client;
  client.connect();
  client.run(32.0);
  std::array<int, 16> count{};
  for (const InformationPacket& packet : client.information) {
    std::set<int> discs;
    for (const SonarReading& reading : packet.sonar) {
      ++count[static_cast<std::size_t>(reading.disc)];
      EXPECT_EQ(reading.range_mm, 1000 + 100 * reading.disc);
      discs.insert(reading.disc);
    }
    EXPECT_GE(packet.sonar.size(), 4U - 2U);
    EXPECT_LE(packet.sonar.size(), 6U);  // two or three of each array
    EXPECT_EQ(discs.size(), packet.sonar.size());
  }
  EXPECT_THAT(count, testing::Each(testing::AllOf(testing::Ge(99), testing::Le(100))));  // each every 320 ms
}

TEST(ArcosController, PollsTheSonarsItIsTold) {
  Client client;
  client.connect();
  client.run(0.3);
  client.send(encode_command(ArcosCommand::kPolling, std::string_view("\x01\x08", 2)));
  client.send(ArcosCommand::kSonar, 4);  // array 2 off
  client.run(0.2);
  client.information.clear();
  client.run(2.0);
  std::set<int> discs;
  for (const InformationPacket& packet : client.information) {
    for (const SonarReading& reading : packet.sonar) {
      discs.insert(reading.disc);
    }
  }
  EXPECT_THAT(discs, testing::ElementsAre(0, 7));
  EXPECT_EQ(client.information.back().sonar_arrays, 1);
}

TEST(ArcosController, RefusesMotorsWhileItsStopButtonIsPressed) {
  Client client;
  client.drive();
  client.send(ArcosCommand::kVelocity, 300);
  client.run(1.5);
  client.base.inputs.stop_button = true;
  client.run(0.5);
  EXPECT_TRUE(client.information.back().stop_button);
  EXPECT_TRUE(client.information.back().stop_button_stall);
  EXPECT_FALSE(client.information.back().motors_enabled);
  EXPECT_NEAR(client.base.outputs.linear, 0.0, 1e-9);
  client.send(ArcosCommand::kEnable, 1);
  client.run(0.3);
  EXPECT_FALSE(client.information.back().motors_enabled);
  client.base.inputs.stop_button = false;
  client.run(0.3);
  EXPECT_FALSE(client.information.back().motors_enabled);
  client.send(ArcosCommand::kEnable, 1);
  client.run(0.3);
  EXPECT_TRUE(client.information.back().motors_enabled);
}

TEST(ArcosController, TogglesItsMotorsByTheButton) {
  Client client;
  client.drive();
  client.run(0.2);
  client.base.inputs.motors_button = true;
  client.run(0.5);
  EXPECT_FALSE(client.information.back().motors_enabled);
  client.base.inputs.motors_button = false;
  client.run(0.5);
  client.base.inputs.motors_button = true;
  client.run(0.5);
  EXPECT_TRUE(client.information.back().motors_enabled);
}

TEST(ArcosController, RestsItsMotorsAfterAStall) {
  Client client;
  client.drive();
  client.send(ArcosCommand::kVelocity, 300);
  client.run(1.5);
  client.base.inputs.stall_left = true;
  client.run(0.3);
  EXPECT_EQ(client.base.outputs.linear, 0.0);
  EXPECT_TRUE(client.information.back().stall_left);
  EXPECT_FALSE(client.information.back().stall_right);
  client.base.inputs.stall_left = false;
  client.run(2.0);
  EXPECT_NEAR(client.base.outputs.linear, 0.3, 1e-9);
}

TEST(ArcosController, StallsOnItsBumpersWhenAskedTo) {
  Client client;
  client.drive();
  client.send(ArcosCommand::kVelocity, 300);
  client.run(1.5);
  client.base.inputs.bumpers_front = 4;
  client.run(0.2);
  EXPECT_NEAR(client.base.outputs.linear, 0.3, 1e-9);
  EXPECT_EQ(client.information.back().bumpers_front, 4);
  client.send(ArcosCommand::kBumpStall, 1);
  client.run(0.1);
  EXPECT_EQ(client.base.outputs.linear, 0.0);
}

TEST(ArcosController, CountsEncoderTicks) {
  Client client;
  client.drive();
  client.send(ArcosCommand::kEncoder, 2);
  client.send(ArcosCommand::kVelocity, 300);
  client.run(4.0);
  ASSERT_GT(client.encoders.size(), 30U);
  EXPECT_NEAR(client.encoders.back().left, client.base.travel * 128'000, 500);
  client.send(ArcosCommand::kEncoder, 0);
  const std::size_t count = client.encoders.size();
  client.run(1.0);
  EXPECT_EQ(client.encoders.size(), count);
}

TEST(ArcosController, ServesAClientOfTheAriaKindForAnHour) {
  Client client;
  client.connect();  // OPEN with an argument that it does not take
  client.send(ArcosCommand::kConfiguration, 1);
  client.send(ArcosCommand::kBatteryInformation, 1);
  client.send(encode_packet(31, hex("3B 01 00")));
  client.send(ArcosCommand::kSound, 1);
  client.send(ArcosCommand::kEnable, 1);
  for (const int value : {500, -500}) {
    client.send(ArcosCommand::kSetAcceleration, value);
    client.send(ArcosCommand::kSetTurnAcceleration, value / 5);
  }
  std::size_t wrong_headings = 0;
  for (int leg = 0; leg < 360; ++leg) {
    const int heading = (leg * 50) % 360 - 180;  // negative degrees too
    for (int i = 0; i < 18; ++i) {               // VEL and HEAD again every half second
      client.send(ArcosCommand::kVelocity, 250);
      client.send(ArcosCommand::kHeading, heading);
      client.run(0.5, false);
    }
    wrong_headings += std::abs(wrap_angle(client.base.turned - radians(heading))) > radians(1.0) ? 1 : 0;
    client.run(1.0);  // idle, with PULSE
  }
  EXPECT_EQ(wrong_headings, 0U);
  EXPECT_EQ(client.information.size(), 36'000U);
  EXPECT_EQ(client.parser.bad_packets(), 0);
  EXPECT_EQ(client.base.controller().bad_packets(), 0);
  EXPECT_NEAR(client.base.travel, 900.0, 1.0);
  client.send(ArcosCommand::kEnable, 0);
  client.send(ArcosCommand::kClose, 1);
  EXPECT_FALSE(client.base.controller().session_open());
}

TEST(ArcosController, ForgivesWhatNormalClientsSend) {
  Client client;
  client.connect();
  for (const int number : {31, 62, 92, 36, 37, 38, 35, 66, 199, 250}) {
    client.send(encode_packet(static_cast<std::uint8_t>(number), hex("3B 01 00")));
    client.send(encode_packet(static_cast<std::uint8_t>(number)));
  }
  client.send(hex("FA FB 04 07 3B 07 3B"));  // SETO as some drivers send it, with half an argument
  client.run(1.0);
  EXPECT_EQ(client.information.size(), 10U);
}

TEST(ArcosController, ChangesOnlyTheMaskedOutputs) {
  Client client;
  client.connect();
  client.send(ArcosCommand::kDigitalOut, (0x0F << 8) | 0x05);
  client.send(ArcosCommand::kDigitalOut, (0x0F << 8) | 0x05);  // twice the same
  client.send(ArcosCommand::kDigitalOut, (0x70 << 8) | 0x30);
  client.run(0.2);
  EXPECT_EQ(client.information.back().digital_out, 0x35);
}

TEST(ArcosController, WrapsItsRegisters) {
  ArcosConfig config;
  Client client(config);
  client.drive();
  client.send(ArcosCommand::kSetMaximumVelocity, 1000);
  client.send(ArcosCommand::kSetAcceleration, 2000);
  client.send(ArcosCommand::kVelocity, 1000);
  client.run(40.0);
  ASSERT_GT(client.base.travel, 33.0);
  EXPECT_EQ((static_cast<int>(std::lround(1000.0 * client.base.travel)) - client.information.back().x_mm) / 65536, 1);
  client.send(ArcosCommand::kSetOrigin);
  client.send(ArcosCommand::kStop);
  client.run(5.0);
  EXPECT_LT(client.information.back().x_mm, 3000);
}

TEST(ArcosController, HasTheHabitsOfMobileSimWhenAsked) {
  ArcosConfig config;
  config.mobilesim = true;
  Client client(config);
  client.connect();
  client.run(0.5);
  EXPECT_TRUE(client.information.front().motors_enabled);
  EXPECT_EQ(client.information.front().sonar_arrays, 0xF);
  EXPECT_EQ(client.information.back().sonar.size(), 16U);
  client.send(ArcosCommand::kVelocity, 200);
  client.send(ArcosCommand::kTurnRate, 7);
  client.run(5.0, false);
  EXPECT_NEAR(client.base.outputs.linear, 0.2, 1e-9);  // no watchdog
  EXPECT_FALSE(client.information.back().moving);
  const double heading_deg = client.information.back().heading * 360.0 / 4096.0;
  EXPECT_NEAR(heading_deg, std::round(heading_deg), 0.05);
  client.base.controller().on_line_closed();
  client.run(1.0, false);
  EXPECT_NEAR(client.base.outputs.linear, 0.0, 1e-9);
}

TEST(ArcosController, DrivesOnWhenASerialClientVanishes) {
  Client client;
  client.drive();
  client.send(ArcosCommand::kVelocity, 200);
  client.run(1.0, false);
  client.base.controller().on_line_closed();
  client.run(0.5, false);
  EXPECT_NEAR(client.base.outputs.linear, 0.2, 1e-9);
  client.run(3.0, false);
  EXPECT_NEAR(client.base.outputs.linear, 0.0, 1e-9);  // its watchdog
}

TEST(ArcosController, PretendsABatteryVoltage) {
  Client client;
  client.connect();
  client.send(ArcosCommand::kBatteryTest, 111);
  client.run(0.2);
  EXPECT_DOUBLE_EQ(client.information.back().battery_voltage, 11.1);
  client.send(ArcosCommand::kBatteryTest, 0);
  client.run(0.2);
  EXPECT_DOUBLE_EQ(client.information.back().battery_voltage, 12.6);
}

}  // namespace
}  // namespace luminav
