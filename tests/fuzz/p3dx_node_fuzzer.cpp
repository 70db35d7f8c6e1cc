#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <lcm/lcm-cpp.hpp>
#include <luminav/odometry_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/sonar_t.hpp>

#include "drivers/p3dx/arcos_commands.hpp"
#include "drivers/p3dx/p3dx_node.hpp"
#include "services/common/process/channels.hpp"

using namespace luminav;

namespace {

void require(bool claim) {
  if (!claim) {
    std::abort();
  }
}

/// What a reader of the driver may rely on, whatever the robot sends.
class Reader {
 public:
  explicit Reader(lcm::LCM& lcm) : inbox_(lcm) {
    inbox_.on(channels::kOdometry, &Reader::on_odometry, this);
    inbox_.on(channels::kSonar, &Reader::on_sonar, this);
    inbox_.on(channels::kRobotStatus, &Reader::on_status, this);
  }

 private:
  void on_odometry(const odometry_t& message) {
    require(all_finite({message.x, message.y, message.theta, message.linear, message.angular}));
    if (message.session == last_.session) {
      require(message.sequence == last_.sequence + 1 && message.utime > last_.utime);
    }
    last_ = message;
  }
  void on_sonar(const sonar_t& message) {
    require(message.count == 16);
    for (const float range : message.range) {
      require(range >= 0.0F && range <= 5.0F);
    }
  }
  void on_status(const robot_status_t& message) {
    require(all_finite({message.battery_voltage, message.linear, message.angular, message.deceleration}));
    require(message.connected == 0 || message.session != 0);
  }
  Subscriber inbox_;
  odometry_t last_{};
};

/// Commands that reach the robot must be those that were asked for.
void check_commands(ByteStream& robot, PacketParser& parser) {
  std::uint8_t bytes[512];
  const std::size_t count = robot.read(bytes);
  parser.push(std::span(bytes).first(count));
  while (const auto packet = parser.next()) {
    const int value = decode_argument(packet->payload).value;
    const auto command = static_cast<ArcosCommand>(packet->type);
    require(command != ArcosCommand::kVelocity || value == 0 || value == 100);
    require(command != ArcosCommand::kTurnRate || (value >= 0 && value <= 6));
  }
}

}  // namespace

/// The first byte says how to begin. Then packets from the robot: a byte for the steps that go by, the type, the length
/// of the payload, the payload.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::span input(data, size);
  const auto take = [&] {
    const std::uint8_t byte = input.empty() ? 0 : input.front();
    input = input.empty() ? input : input.subspan(1);
    return byte;
  };
  lcm::LCM lcm("memq://");
  VirtualClock clock;
  MemoryPipe pipe;
  auto robot = pipe.open_robot_end();
  P3dxConfig config;
  config.robot.sonar.robot_from_sonar.resize(16);
  P3dxNode node(lcm, config, clock, pipe.driver_opener());
  const Reader reader(lcm);
  PacketParser heard;
  const auto step = [&] {
    clock.advance(10'000);
    node.poll();
    while (lcm.handleTimeout(0) > 0) {
    }
    check_commands(*robot, heard);
  };
  const std::uint8_t beginning = take();
  if ((beginning & 1) != 0) {
    step();
    for (const auto& answer : {encode_packet(0), encode_packet(1), encode_identity({"a", "Pioneer", "p3dx-sh"}),
                               encode_configuration({}), encode_information({})}) {
      robot->write(answer);
      step();
      step();
    }
  }
  std::int32_t sequence = 0;
  int steps = 0;
  while (!input.empty() && steps < 300) {
    const std::uint8_t control = take();
    const std::uint8_t type = take();
    const std::size_t length = std::min<std::size_t>(take(), input.size());
    const auto payload = input.first(length);
    input = input.subspan(length);
    if ((control & 0x80) != 0) {
      robot->write(payload);
    } else {
      robot->write(encode_packet(type, payload));
    }
    if ((control & 0x40) != 0) {
      velocity_command_t command{};
      command.utime = clock.utime();
      command.session = 1;
      command.sequence = ++sequence;
      command.linear_x = 0.1;
      command.angular_z = 0.1;
      lcm.publish(channels::kVelocityCommand, &command);
    }
    for (int i = 0; i <= (control & 0x1F); ++i, ++steps) {
      step();
    }
  }
  require(node.health().dropped_inputs <= sequence);
  node.shut_down();
  return 0;
}
