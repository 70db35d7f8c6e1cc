#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "drivers/simulator/arcos/arcos_controller.hpp"
#include "drivers/simulator/simulator_node.hpp"
#include "tests/unit/simulator/text_world.hpp"

namespace luminav {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// The wire as a client of another maker knows it, written from the protocol's description alone: nothing here shares
/// code with our codec, so that an error common to our two sides shows.
namespace wire {

int checksum(const Bytes& bytes, std::size_t begin, std::size_t end) {
  int sum = 0;
  std::size_t i = begin;
  for (; i + 1 < end; i += 2) {
    sum = (sum + (bytes[i] << 8) + bytes[i + 1]) & 0xFFFF;
  }
  return i < end ? sum ^ bytes[i] : sum;
}

Bytes frame(int command, const Bytes& data = {}) {
  Bytes bytes = {0xFA, 0xFB, static_cast<std::uint8_t>(data.size() + 3), static_cast<std::uint8_t>(command)};
  bytes.insert(bytes.end(), data.begin(), data.end());
  const int sum = checksum(bytes, 3, bytes.size());
  bytes.push_back(static_cast<std::uint8_t>(sum >> 8));
  bytes.push_back(static_cast<std::uint8_t>(sum & 0xFF));
  return bytes;
}

Bytes integer(int command, int value) {
  const int magnitude = std::abs(value);
  return frame(command, {static_cast<std::uint8_t>(value < 0 ? 0x1B : 0x3B),
                         static_cast<std::uint8_t>(magnitude & 0xFF), static_cast<std::uint8_t>(magnitude >> 8)});
}

Bytes text(int command, const std::string& value) {
  Bytes data = {0x2B, static_cast<std::uint8_t>(value.size())};
  data.insert(data.end(), value.begin(), value.end());
  return frame(command, data);
}

Bytes three_words(int command, std::array<std::int32_t, 3> words) {
  Bytes data = {0x00};
  for (const std::int32_t word : words) {
    for (int shift = 0; shift < 32; shift += 8) {
      data.push_back(static_cast<std::uint8_t>((word >> shift) & 0xFF));
    }
  }
  return frame(command, data);
}

int word(const Bytes& bytes, std::size_t at) {
  return static_cast<std::int16_t>(bytes[at] | (bytes[at + 1] << 8));
}

enum : int {
  kPulse = 0,
  kOpen = 1,
  kClose = 2,
  kEnable = 4,
  kSetAcceleration = 5,
  kSetMaximumVelocity = 6,
  kSetMaximumTurnRate = 10,
  kVelocity = 11,
  kHeading = 12,
  kConfiguration = 18,
  kSetTurnAcceleration = 23,
  kStop = 29,
  kBatteryInformation = 62,
  kSound = 92,
  kSimSetPose = 224,
  kSimReset = 225,
  kSimLast = 239,
};

}  // namespace wire

/// Reads the robot's stream strictly: each byte must belong to a whole packet with a right checksum.
class StrictReader {
 public:
  void take(const Bytes& bytes) {
    rest_.insert(rest_.end(), bytes.begin(), bytes.end());
    while (rest_.size() >= 3 && rest_.size() >= rest_[2] + std::size_t{3}) {
      const std::size_t length = rest_[2] + std::size_t{3};
      const Bytes packet(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(length));
      rest_.erase(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(length));
      const int sum = (packet[length - 2] << 8) | packet[length - 1];
      if (packet[0] != 0xFA || packet[1] != 0xFB || wire::checksum(packet, 3, length - 2) != sum) {
        ++broken;
        continue;
      }
      packets.push_back(packet);
    }
  }
  std::vector<Bytes> packets;
  int broken = 0;

 private:
  Bytes rest_;
};

/// The simulated robot in a hall, and that client on its line; the steps of 10 ms are the simulator's own.
class ForeignClient : public testing::Test {
 protected:
  void build(const ArcosConfig& config) {
    controller_ = std::make_unique<ArcosController>(config);
    node_ = std::make_unique<SimulatorNode>(lcm_, 1, exact_truth(map_from_text(hall(80, 80)), {20.0, 20.0, 0.0}),
                                            *controller_);
    node_->advance_to(now_);
  }

  void say(const Bytes& bytes) { controller_->receive(bytes); }

  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds * 100.0)); ++i) {
      now_ += SimulatorNode::kTick;
      node_->advance_to(now_);
      reader_.take(controller_->take_output());
      for (const Bytes& packet : reader_.packets) {
        on_packet(packet);
      }
      reader_.packets.clear();
    }
  }

  void on_packet(const Bytes& packet) {
    if (packet[3] == 0x32 || packet[3] == 0x33) {
      ++information_;
      if (last_information_ != 0) {
        cadences_.insert(now_ - last_information_);
      }
      last_information_ = now_;
      heading_ = wire::word(packet, 8) * 2.0 * std::numbers::pi / 4096.0;
      motors_ = (wire::word(packet, 19) & 1) != 0;
      sonars_ += packet[22];
      battery_ = packet[14];
    } else {
      other_.push_back(packet);
    }
  }

  /// As ARIA begins: the greeting of its radio modem, three SYNCs, and arguments where the manual has none.
  void connect() {
    say({'W', 'M', 'S', '2', '\r'});
    for (const int sync : {0, 1, 2}) {
      say(wire::frame(sync));
      run(0.1);
    }
    ASSERT_EQ(other_.size(), 3U);
    EXPECT_EQ(other_[0], wire::frame(0));
    EXPECT_EQ(other_[1], wire::frame(1));
    EXPECT_EQ(std::string(other_[2].begin() + 4, other_[2].end() - 3), std::string("robot\0Pioneer\0p3dx-sh", 21));
    other_.clear();
    say(wire::integer(wire::kOpen, 1));
    say(wire::integer(wire::kConfiguration, 1));
    run(0.2);
    ASSERT_EQ(other_.size(), 1U);
    EXPECT_EQ(other_[0][3], 0x20);
    EXPECT_EQ(std::string(other_[0].begin() + 4, other_[0].begin() + 12), std::string("Pioneer\0", 8));
    other_.clear();
    say(wire::integer(wire::kBatteryInformation, 1));
    say(wire::integer(31, 1));
    say(wire::integer(wire::kSound, 1));
    say(wire::integer(wire::kEnable, 1));
    say(wire::integer(wire::kSetMaximumVelocity, 500));
    say(wire::integer(wire::kSetMaximumTurnRate, 100));
    for (const int sign : {1, -1}) {
      say(wire::integer(wire::kSetAcceleration, sign * 500));
      say(wire::integer(wire::kSetTurnAcceleration, sign * 100));
    }
    run(0.3);
    EXPECT_TRUE(motors_);
  }

  static ArcosConfig robot(bool mobilesim) {
    ArcosConfig config;
    config.flash.name = "robot";
    config.mobilesim = mobilesim;
    return config;
  }

  [[nodiscard]] double heading_error(int heading_deg) const {
    return std::abs(std::remainder(heading_ - heading_deg * std::numbers::pi / 180.0, 2.0 * std::numbers::pi));
  }

  void drive_for_an_hour() {
    const std::int64_t begin = now_;
    const int heard_before = information_;
    std::mt19937 rng(7);
    int wrong_headings = 0;
    int heading = 0;  // [degrees]
    bool returns = false;
    while (now_ - begin < 3'600'000'000) {
      heading = returns ? (heading > 0 ? heading - 180 : heading + 180) : static_cast<int>(rng() % 361) - 180;
      returns = !returns;
      for (int i = 0; i < 16; ++i) {  // VEL and HEAD, said again each half second
        say(wire::integer(wire::kVelocity, 200));
        say(wire::integer(wire::kHeading, heading));
        run(0.5);
      }
      wrong_headings += heading_error(heading) > 0.03 ? 1 : 0;
      say(wire::frame(wire::kStop));
      for (int i = 0; i < 4; ++i) {  // idle
        say(wire::frame(wire::kPulse));
        run(0.5);
      }
    }
    const auto periods = static_cast<int>((now_ - begin) / 100'000);
    EXPECT_EQ(information_ - heard_before, periods);
    EXPECT_EQ(cadences_, std::set<std::int64_t>{100'000});
    EXPECT_EQ(reader_.broken, 0);
    EXPECT_EQ(controller_->bad_packets(), 0);
    EXPECT_TRUE(other_.empty());
    EXPECT_EQ(wrong_headings, 0);
    EXPECT_GT(sonars_, 0);
    EXPECT_LT(battery_, 126);  // [0.1 V] drained by then, and not yet empty
    EXPECT_GT(battery_, 115);
    say(wire::integer(wire::kEnable, 0));
    run(0.1);
    say(wire::integer(wire::kClose, 1));
    const int heard = information_;
    run(1.0);
    EXPECT_EQ(information_, heard);
    EXPECT_FALSE(controller_->session_open());
  }

  lcm::LCM lcm_{"memq://"};
  std::unique_ptr<ArcosController> controller_;
  std::unique_ptr<SimulatorNode> node_;
  StrictReader reader_;
  std::int64_t now_ = 1'000'000'000;   // [us]
  std::int64_t last_information_ = 0;  // [us]
  std::set<std::int64_t> cadences_;    // [us] between information packets
  std::vector<Bytes> other_;
  int information_ = 0;
  int sonars_ = 0;
  int battery_ = 0;       // [0.1 V]
  double heading_ = 0.0;  // [rad]
  bool motors_ = false;
};

TEST_F(ForeignClient, DrivesForAnHourWithoutALostPacket) {
  build(robot(false));
  connect();
  drive_for_an_hour();
}

TEST_F(ForeignClient, DrivesARobotWithTheHabitsOfMobileSimForAnHour) {
  build(robot(true));
  connect();
  drive_for_an_hour();
}

TEST_F(ForeignClient, IsNotDisturbedByCommandsThatTheRobotDoesNotKnow) {
  for (const bool mobilesim : {false, true}) {
    build(robot(mobilesim));
    connect();
    say(wire::integer(wire::kVelocity, 100));
    run(2.0);
    const Pose2 before = node_->world().state().world_from_robot;
    const int heard_before = information_;
    // Those of simulators, of the gyro, and whatever else has no meaning here: bare, with each kind of argument, cut.
    for (int command = wire::kSimSetPose; command <= wire::kSimLast; ++command) {
      say(wire::frame(command));
      say(wire::integer(command, 1));
      say(wire::integer(command, -2));
      say(wire::text(command, "office.map"));
      say(wire::three_words(command, {1000, -500, 90}));
      say(wire::frame(command, {0x3B}));
    }
    for (const int command : {31, 36, 37, 38, 56, 58, 59, 63, 66, 67, 68, 69, 82, 87, 88, 89, 93, 200, 254}) {
      say(wire::integer(command, 1));
      say(wire::integer(command, 0));
    }
    run(1.0);
    const Pose2 after = node_->world().state().world_from_robot;
    EXPECT_EQ(information_ - heard_before, 10);
    EXPECT_EQ(cadences_, std::set<std::int64_t>{100'000});
    EXPECT_EQ(reader_.broken, 0);
    EXPECT_TRUE(motors_);
    EXPECT_NEAR(std::hypot(after.x - before.x, after.y - before.y), 0.1, 0.02);  // drove on
    last_information_ = 0;
    other_.clear();
  }
}

}  // namespace
}  // namespace luminav
