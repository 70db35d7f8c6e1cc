#include "drivers/simulator/simulator_node.hpp"
#include "drivers/simulator/arcos/arcos_controller.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <lcm/lcm-cpp.hpp>
#include <luminav/sim_truth_t.hpp>
#include <optional>
#include <vector>

#include "drivers/p3dx/arcos/arcos_commands.hpp"
#include "drivers/p3dx/arcos/arcos_packet.hpp"
#include "drivers/p3dx/arcos/information_packet.hpp"
#include "drivers/simulator/world/lamp_state.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/subscriber.hpp"
#include "tests/unit/simulator/text_world.hpp"

namespace luminav {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr std::int64_t kStart = 1'000'000'000;  // [us]

/// A simulator with a client at the other end of its line and an ear on the bus.
class SimulatorNodeTest : public testing::Test {
 protected:
  SimulatorNodeTest() : SimulatorNodeTest(exact_truth(map_from_text(hall(20, 12)), {3.0, 3.0, 0.0})) {}
  explicit SimulatorNodeTest(const WorldTruth& truth)
      : controller_(ArcosConfig{}), node_(lcm_, kSeed, with_building(truth), controller_), subscriber_(lcm_) {
    subscriber_.on(channels::kSimTruth, &SimulatorNodeTest::on_truth, this);
  }

  static std::vector<ScenarioEvent> events() {
    ScenarioEvent unplug;
    unplug.at = 8.0;
    unplug.kind = EventKind::kUnplug;
    unplug.device = "serial";
    unplug.duration = 1.0;
    ScenarioEvent lamp;
    lamp.at = 8.0;
    lamp.kind = EventKind::kLamp;
    lamp.id = 2;
    lamp.pose = {0.3, -0.1, 0.0};
    return {unplug, lamp};
  }

  static WorldTruth with_building(WorldTruth truth) {
    truth.building.fixtures.resize(2);
    truth.building.fixtures[0].id = 1;
    truth.building.fixtures[1].id = 2;
    truth.building.doors.resize(1);
    truth.building.doors[0].world_from_door = {9.0, 6.0, 0.0};
    truth.lamp_states = {kLampOn, kLampHalf};
    truth.people = {{{{1.0, 6.0}, {2.0, 6.0}}, 0.5}};
    truth.events = events();
    return truth;
  }

  void send(ArcosCommand command) { controller_.receive(encode_command(command)); }
  void send(ArcosCommand command, int value) { controller_.receive(encode_command(command, value)); }

  void connect() {
    send(ArcosCommand::kPulse);
    send(ArcosCommand::kOpen);
    send(ArcosCommand::kClose);
    send(ArcosCommand::kOpen);
    send(ArcosCommand::kEnable, 1);
  }

  /// Time goes on in steps of 10 ms; the client says PULSE twice a second and listens.
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds * 100.0)); ++i) {
      if (i % 50 == 0) {
        send(ArcosCommand::kPulse);
      }
      now_ += SimulatorNode::kTick;
      node_.advance_to(now_);
      while (lcm_.handleTimeout(0) > 0) {
      }
      parser_.push(controller_.take_output());
      while (const auto packet = parser_.next()) {
        if (is_information(packet->type)) {
          information_ = decode_information(packet->type, packet->payload);
          ASSERT_TRUE(information_.has_value());
          for (const SonarReading& reading : information_->sonar) {
            sonar_.push_back(reading);
          }
        }
      }
    }
  }

  void on_truth(const sim_truth_t& truth) { truths_.push_back(truth); }

  lcm::LCM lcm_{"memq://"};
  ArcosController controller_;
  SimulatorNode node_;
  Subscriber subscriber_;
  PacketParser parser_;
  std::int64_t now_ = kStart;
  std::vector<sim_truth_t> truths_;
  std::optional<InformationPacket> information_;
  std::vector<SonarReading> sonar_;
};

TEST_F(SimulatorNodeTest, PublishesTheTruthAHundredTimesASecond) {
  node_.advance_to(kStart);
  run(2.0);
  ASSERT_EQ(truths_.size(), 201U);
  EXPECT_EQ(truths_.front().utime, kStart);
  for (std::size_t i = 1; i < truths_.size(); ++i) {
    EXPECT_EQ(truths_[i].utime - truths_[i - 1].utime, 10'000);
    EXPECT_EQ(truths_[i].sequence, truths_[i - 1].sequence + 1);
    EXPECT_EQ(truths_[i].session, kStart);
  }
  const sim_truth_t& last = truths_.back();
  EXPECT_EQ(last.x, 3.0);
  EXPECT_EQ(last.linear, 0.0);
  EXPECT_EQ(last.people, 1);
  EXPECT_NEAR(last.person_x[0], 2.0, 0.01);
  ASSERT_EQ(last.lamps, 2);
  EXPECT_EQ(last.lamp_state[1], sim_truth_t::LAMP_HALF);
  ASSERT_EQ(last.doors, 1);
  EXPECT_EQ(last.door_open[0], 1);
  EXPECT_EQ(last.moved_lamps, 0);
}

TEST_F(SimulatorNodeTest, TakesOneTickPerTenMillisecondsHoweverItIsCalled) {
  node_.advance_to(kStart);
  node_.advance_to(kStart + 9'999);
  EXPECT_EQ(node_.utime(), kStart);
  node_.advance_to(kStart + 35'000);
  EXPECT_EQ(node_.utime(), kStart + 30'000);
  node_.advance_to(kStart + 20'000);  // time does not go back
  EXPECT_EQ(node_.utime(), kStart + 30'000);
}

TEST_F(SimulatorNodeTest, DoesNotMoveBeforeTheMotorsAreOn) {
  node_.advance_to(kStart);
  send(ArcosCommand::kVelocity, 300);
  run(1.0);
  EXPECT_EQ(truths_.back().x, 3.0);
}

TEST_F(SimulatorNodeTest, DrivesByTheRobotsProtocol) {
  node_.advance_to(kStart);
  connect();
  send(ArcosCommand::kVelocity, 300);
  run(5.0);
  ASSERT_TRUE(information_.has_value());
  EXPECT_TRUE(information_->motors_enabled);
  EXPECT_GT(truths_.back().x, 4.0);
  EXPECT_NEAR(truths_.back().linear, 0.3, 0.005);
  // nothing is wrong with these wheels, so the robot's own odometry agrees, up to its last packet
  EXPECT_NEAR(information_->x_mm, 1000.0 * (truths_.back().x - 3.0), 40.0);
}

TEST_F(SimulatorNodeTest, AnswersSonarPulses) {
  node_.advance_to(kStart);
  connect();
  send(ArcosCommand::kSonar, 1);
  run(4.0);
  // disc 1 of this robot looks at the north wall, free up to 6.5 m
  std::vector<int> north;
  for (const SonarReading& reading : sonar_) {
    if (reading.disc == 1 && reading.range_mm < 5000) {
      north.push_back(reading.range_mm);
    }
  }
  ASSERT_GT(north.size(), 5U);
  int right = 0;
  for (const int range : north) {
    right += std::abs(range - 3500) < 50 ? 1 : 0;
  }
  EXPECT_GT(right, static_cast<int>(north.size()) - 3);
}

TEST_F(SimulatorNodeTest, SaysWhenTheRobotStallsAtAWall) {
  node_.advance_to(kStart);
  connect();
  send(ArcosCommand::kVelocity, -400);
  run(7.5);
  EXPECT_EQ(truths_.back().contacts, 1);
  EXPECT_EQ(truths_.back().touching, 1);
  EXPECT_NEAR(truths_.back().x - 0.301, 0.5, 0.01);
}

TEST_F(SimulatorNodeTest, ReportsEvents) {
  node_.advance_to(kStart);
  run(8.5);
  EXPECT_TRUE(node_.serial_unplugged());
  EXPECT_EQ(truths_.back().serial_unplugged, 1);
  ASSERT_EQ(truths_.back().moved_lamps, 1);
  EXPECT_EQ(truths_.back().moved_index[0], 1);
  EXPECT_NEAR(truths_.back().moved_dx[0], 0.3, 1e-6);
  run(1.0);
  EXPECT_FALSE(node_.serial_unplugged());
}

TEST_F(SimulatorNodeTest, SendsTheSameBytesTwice) {
  const auto record = [] {
    lcm::LCM lcm("memq://");
    ArcosController controller{ArcosConfig{}};
    WorldTruth truth = exact_truth(map_from_text(hall(20, 12)), {3.0, 3.0, 0.0});
    truth.wheels.noise_position = 0.01;
    truth.wheels.noise_heading = 0.01;
    SimulatorNode node(lcm, kSeed, with_building(truth), controller);
    for (const ArcosCommand command :
         {ArcosCommand::kPulse, ArcosCommand::kOpen, ArcosCommand::kClose, ArcosCommand::kOpen}) {
      controller.receive(encode_command(command));
    }
    controller.receive(encode_command(ArcosCommand::kEnable, 1));
    controller.receive(encode_command(ArcosCommand::kVelocity, 250));
    controller.receive(encode_command(ArcosCommand::kTurnRate, 20));
    std::vector<std::uint8_t> bytes;
    for (std::int64_t t = kStart; t < kStart + 10'000'000; t += 10'000) {
      if (t % 500'000 == 0) {
        controller.receive(encode_command(ArcosCommand::kPulse));
      }
      node.advance_to(t);
      const auto output = controller.take_output();
      bytes.insert(bytes.end(), output.begin(), output.end());
    }
    return bytes;
  };
  const auto first = record();
  EXPECT_GT(first.size(), 3000U);
  EXPECT_EQ(first, record());
}

}  // namespace
}  // namespace luminav
