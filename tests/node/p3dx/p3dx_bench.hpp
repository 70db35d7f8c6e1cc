#pragma once

#include <lcm/lcm-cpp.hpp>
#include <luminav/odometry_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/sonar_t.hpp>
#include <memory>
#include <vector>

#include "drivers/p3dx/p3dx_node.hpp"
#include "services/common/process/channels.hpp"
#include "tests/node/p3dx/noisy_stream.hpp"
#include "tests/node/p3dx/simulated_base.hpp"

namespace luminav {

/// The real driver and the simulated robot on one memory line, in virtual time.
class P3dxBench {
 public:
  explicit P3dxBench(const ArcosConfig& arcos = {}, const P3dxConfig& config = robot_config())
      : base(arcos),
        lcm("memq://"),
        line_(pipe.open_robot_end()),
        node(lcm, config, clock, [this] { return std::make_unique<NoisyStream>(pipe.open_driver_end(), noise); }),
        inbox_(lcm) {
    node.report_life([this] { last_beat = clock.utime(); });
    inbox_.on(channels::kOdometry, &P3dxBench::on_odometry, this);
    inbox_.on(channels::kSonar, &P3dxBench::on_sonar, this);
    inbox_.on(channels::kRobotStatus, &P3dxBench::on_status, this);
  }

  static P3dxConfig robot_config() {
    P3dxConfig config;
    config.robot.footprint = {{0.21, -0.2}, {0.21, 0.2}, {-0.3, 0.2}, {-0.3, -0.2}};
    config.robot.sonar.robot_from_sonar.resize(16);
    return config;
  }

  /// Lets time go on in steps of 10 ms.
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds * 100.0)); ++i) {
      clock.advance(10'000);
      if (!line_ || !line_->is_open()) {
        line_.reset();
        if (plugged) {
          line_ = pipe.open_robot_end();
        }
      }
      base.step(line_.get());
      if (!asleep) {
        node.poll();
      }
      while (lcm.handleTimeout(0) > 0) {
      }
    }
  }

  /// The robot hears what was written, and no time goes by.
  void hear() { base.receive(line_.get()); }

  void unplug() {
    plugged = false;
    pipe.unplug();
  }
  void plug_in() {
    plugged = true;
    pipe.plug_in();
  }

  /// From now on a controller answers each ROBOT_STATUS with this.
  void drive(double linear, double angular) {
    driving = true;
    linear_ = linear;
    angular_ = angular;
  }
  std::string addressee = robot_config().robot.name;  // of the commands sent from now on
  void send_command(std::int64_t utime, std::int64_t session, std::int32_t sequence, double linear,
                    double angular = 0.0) {
    velocity_command_t command{};
    command.utime = utime;
    command.robot = addressee;
    command.session = session;
    command.sequence = sequence;
    command.linear_x = linear;
    command.angular_z = angular;
    lcm.publish(channels::kVelocityCommand, &command);
  }
  void send_stop(std::int64_t id, bool engaged, const std::string& sender = "test") {
    stop_t stop{};
    stop.utime = clock.utime();
    stop.id = id;
    stop.engaged = engaged ? 1 : 0;
    stop.sender = sender;
    lcm.publish(channels::kStop, &stop);
  }
  void send_motors(std::int64_t id, bool enable) {
    motors_command_t command{};
    command.utime = clock.utime();
    command.id = id;
    command.enable = enable ? 1 : 0;
    lcm.publish(channels::kMotorsCommand, &command);
  }
  [[nodiscard]] bool standing() const {
    return std::abs(base.outputs.linear) < 0.02 && std::abs(base.outputs.angular) < 0.02;
  }

  SimulatedBase base;
  MemoryPipe pipe;
  VirtualClock clock;
  LineNoise noise;
  lcm::LCM lcm;

 private:
  std::unique_ptr<ByteStream> line_;

 public:
  P3dxNode node;
  bool plugged = true;
  bool asleep = false;  // the driver's process does not run
  bool driving = false;
  std::int64_t last_beat = 0;  // [us] when its guardian heard of the driver
  std::vector<odometry_t> odometry;
  std::vector<sonar_t> sonar;
  std::vector<robot_status_t> status;

 private:
  void on_odometry(const odometry_t& message) { odometry.push_back(message); }
  void on_sonar(const sonar_t& message) { sonar.push_back(message); }
  void on_status(const robot_status_t& message) {
    status.push_back(message);
    if (driving) {
      session_ = session_ == 0 ? message.utime : session_;
      send_command(message.utime, session_, ++sequence_, linear_, angular_);
    }
  }

  Subscriber inbox_;
  std::int64_t session_ = 0;
  std::int32_t sequence_ = 0;
  double linear_ = 0.0;
  double angular_ = 0.0;
};

}  // namespace luminav
