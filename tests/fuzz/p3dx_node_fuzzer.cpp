#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <lcm/lcm-cpp.hpp>
#include <luminav/odometry_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/sonar_t.hpp>

#include "drivers/p3dx/arcos/arcos_commands.hpp"
#include "drivers/p3dx/p3dx_node.hpp"
#include "services/common/process/channels.hpp"

using namespace luminav;

namespace {

void require(bool claim) {
  if (!claim) {
    std::abort();
  }
}

/// One handle for all runs: opening one costs a thousand times what a run costs.
lcm::LCM& network() {
  static lcm::LCM lcm("memq://");
  return lcm;
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

/// A memory line that has rates, as a serial one.
class RatedStream final : public ByteStream {
 public:
  RatedStream(std::unique_ptr<ByteStream> line, int baud) : line_(std::move(line)), baud_(baud) {}
  std::size_t read(std::span<std::uint8_t> bytes) override { return line_->read(bytes); }
  std::size_t write(std::span<const std::uint8_t> bytes) override { return line_->write(bytes); }
  [[nodiscard]] int descriptor() const override { return -1; }
  [[nodiscard]] bool is_open() const override { return line_->is_open(); }
  void close() override { line_->close(); }
  [[nodiscard]] std::string failure() const override { return line_->failure(); }
  bool set_baud(int bits_per_second) override {
    baud_ = bits_per_second;
    return true;
  }
  [[nodiscard]] int baud() const override { return baud_; }

 private:
  std::unique_ptr<ByteStream> line_;
  int baud_;
};

/// Driver, robot's end of the line, and somebody who commands.
class Session {
 public:
  explicit Session(bool serial)
      : reader_(network()), node_(network(), config(), clock_, [this, serial]() -> std::unique_ptr<ByteStream> {
          auto line = pipe_.open_driver_end();
          return serial ? std::make_unique<RatedStream>(std::move(line), 9600) : std::move(line);
        }) {}

  void write(std::span<const std::uint8_t> bytes) { robot_->write(bytes); }

  void step(std::int64_t microseconds) {
    clock_.advance(microseconds);
    node_.poll();
    deliver();
    check_commands();
  }

  void greet() {
    step(10'000);
    for (const auto& answer : {encode_packet(0), encode_packet(1), encode_identity({"a", "Pioneer", "p3dx-sh"}),
                               encode_configuration({}), encode_information({})}) {
      write(answer);
      step(10'000);
      step(10'000);
    }
  }

  void cut_the_line() {
    pipe_.unplug();
    step(10'000);
    pipe_.plug_in();
    robot_ = pipe_.open_robot_end();
    heard_.clear();
  }

  void command() {
    velocity_command_t message{};
    message.utime = clock_.utime();
    message.robot = config().robot.name;
    message.session = 1;
    message.sequence = ++sequence_;
    message.linear_x = 0.1;
    message.angular_z = 0.1;
    network().publish(channels::kVelocityCommand, &message);
  }

  /// Engages the stop and releases it in turn; motors are requested with the release.
  void toggle_stop() {
    stop_t stop{};
    stop.utime = clock_.utime();
    stop.id = ++id_;
    stop.engaged = stopped_ ? 0 : 1;
    network().publish(channels::kStop, &stop);
    if (stopped_) {
      motors_command_t motors{};
      motors.utime = clock_.utime();
      motors.id = id_;
      motors.enable = static_cast<std::int8_t>(id_ % 4 == 2 ? 1 : 0);
      network().publish(channels::kMotorsCommand, &motors);
    }
    deliver();
    check_commands();  // what left before the stop
    stopped_ = !stopped_;
    stopped_at_ = clock_.utime();
  }

  void end() {
    require(node_.health().dropped_inputs <= sequence_);
    node_.shut_down();
  }

 private:
  static P3dxConfig config() {
    P3dxConfig config;
    config.robot.sonar.robot_from_sonar.resize(16);
    config.fast_baud = 115200;
    return config;
  }

  static void deliver() {
    while (network().handleTimeout(0) > 0) {
    }
  }

  /// Commands that reach the robot must be those that were asked for, or less where the robot says it can do less.
  void check_commands() {
    std::array<std::uint8_t, 512> bytes;
    heard_.push(std::span(bytes).first(robot_->read(bytes)));
    constexpr std::int64_t kOnTheWay = 500'000;  // [us] for what was queued before the stop
    const bool stands = stopped_ && clock_.utime() - stopped_at_ > kOnTheWay;
    while (const auto packet = heard_.next()) {
      const int value = decode_argument(packet->payload).value;
      const auto command = static_cast<ArcosCommand>(packet->type);
      require(command != ArcosCommand::kVelocity || (value >= 0 && value <= (stands ? 0 : 100)));
      require(command != ArcosCommand::kTurnRate || (value >= 0 && value <= (stands ? 0 : 6)));
    }
    require(heard_.bad_packets() == 0);
  }

  VirtualClock clock_;
  MemoryPipe pipe_;
  std::unique_ptr<ByteStream> robot_ = pipe_.open_robot_end();
  Reader reader_;
  P3dxNode node_;
  PacketParser heard_;
  std::int32_t sequence_ = 0;
  std::int64_t id_ = 0;
  bool stopped_ = false;
  std::int64_t stopped_at_ = 0;  // [us]
};

}  // namespace

/// The first byte says how to begin. Then packets from the robot: a byte for what else happens and the time that goes
/// by, the type, the length of the payload, the payload.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::span input(data, size);
  const auto take = [&] {
    const std::uint8_t byte = input.empty() ? 0 : input.front();
    input = input.empty() ? input : input.subspan(1);
    return byte;
  };
  const std::uint8_t beginning = take();
  Session session((beginning & 2) != 0);
  if ((beginning & 1) != 0) {
    session.greet();
  }
  constexpr int kMaxSteps = 100;
  constexpr std::array<std::int64_t, 8> kTimes = {1'000, 5'000, 10'000, 20'000, 50'000, 120'000, 400'000, 2'600'000};
  int steps = 0;
  while (!input.empty() && steps < kMaxSteps) {
    const std::uint8_t control = take();
    const std::uint8_t type = take();
    const std::size_t length = std::min<std::size_t>(take(), input.size());
    const auto payload = input.first(length);
    input = input.subspan(length);
    if ((control & 0x80) == 0) {
      session.write(encode_packet(type, payload));
    } else if (!payload.empty()) {
      session.write(payload);
    } else {
      session.cut_the_line();
    }
    if ((control & 0x40) != 0) {
      session.command();
    }
    if ((control & 0x20) != 0) {
      session.toggle_stop();
    }
    for (int i = 0; i <= (control & 3); ++i, ++steps) {
      session.step(kTimes[(control >> 2) & 7]);
    }
  }
  session.end();
  return 0;
}
