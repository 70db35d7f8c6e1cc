#pragma once

#include <cmath>
#include <luminav/odometry_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "drivers/contract/check_base_node.hpp"
#include "drivers/create2/create2_node.hpp"
#include "drivers/simulator/base_board.hpp"
#include "drivers/simulator/create2/create2_board.hpp"
#include "services/common/process/channels.hpp"

namespace luminav {

/// A controller that answers each ROBOT_STATUS with the same wish.
class Create2Commander {
 public:
  explicit Create2Commander(lcm::LCM& lcm) : lcm_(lcm), inbox_(lcm) {
    inbox_.on(channels::kRobotStatus, &Create2Commander::on_status, this);
  }
  std::optional<DriveVelocity> wanted;  // nothing: says nothing

 private:
  void on_status(const robot_status_t& message) {
    if (!wanted) {
      return;
    }
    session_ = session_ == 0 ? message.utime : session_;
    velocity_command_t command{};
    command.utime = message.utime;
    command.robot = "create2";
    command.session = session_;
    command.sequence = ++sequence_;
    command.linear_x = wanted->linear;
    command.angular_z = wanted->angular;
    lcm_.publish(channels::kVelocityCommand, &command);
  }
  lcm::LCM& lcm_;
  Subscriber inbox_;
  std::int64_t session_ = 0;
  std::int32_t sequence_ = 0;
};

/// The real driver and a simulated Create 2 on wheels that do as they are told, in an empty world, on one memory line.
/// Virtual time in steps of 10 ms.
class Create2Bench {
 public:
  explicit Create2Bench(const Create2Config& config = robot_config())
      : board(config.robot.wheel_base),
        lcm("memq://"),
        node(lcm, config, clock, pipe.driver_opener()),
        wheel_base_(config.robot.wheel_base),
        inbox_(lcm),
        commander_(lcm) {
    inbox_.on(channels::kOdometry, &Create2Bench::on_odometry, this);
    inbox_.on(channels::kRobotStatus, &Create2Bench::on_status, this);
  }

  static Create2Config robot_config() {
    Create2Config config;
    config.robot.name = "create2";
    config.robot.wheel_base = 0.235;
    config.robot.limits = {.linear = 0.2,
                           .angular = 1.0,
                           .linear_acceleration = 0.4,
                           .linear_deceleration = 0.6,
                           .angular_acceleration = 2.0};
    return config;
  }

  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds * 100.0)); ++i) {
      clock.advance(10'000);
      exchange();
      step_wheels();
      node.poll();
      exchange();
      while (lcm.handleTimeout(0) > 0) {
      }
      exchange();
      say_alive();
    }
  }

  /// From now on a controller answers each ROBOT_STATUS with this.
  void drive(double linear, double angular) { commander_.wanted = DriveVelocity{linear, angular}; }
  void send_motors(std::int64_t id, bool enable) {
    motors_command_t command{};
    command.utime = clock.utime();
    command.id = id;
    command.enable = enable ? 1 : 0;
    lcm.publish(channels::kMotorsCommand, &command);
  }
  [[nodiscard]] double speed() const { return outputs.motors_enabled ? outputs.linear : 0.0; }

  VirtualClock clock;
  Create2Board board;
  MemoryPipe pipe;
  lcm::LCM lcm;
  Create2Node node;
  BoardInputs inputs;
  BoardOutputs outputs;
  double travel = 0.0;  // [m] forward
  bool plugged = true;
  std::vector<odometry_t> odometry;
  std::vector<robot_status_t> status;

 private:
  void exchange() {
    if (!line_ || !line_->is_open()) {
      if (!plugged) {
        return;
      }
      line_ = pipe.open_robot_end();
    }
    std::uint8_t buffer[512];
    while (const std::size_t count = line_->read(buffer)) {
      board.receive({buffer, count});
    }
    line_->write(board.take_output());
  }
  void step_wheels() {
    constexpr double kStep = 0.01;  // [s]
    const double turning = 0.5 * wheel_base_ * outputs.angular;
    inputs.left_travel = outputs.motors_enabled ? kStep * (outputs.linear - turning) : 0.0;
    inputs.right_travel = outputs.motors_enabled ? kStep * (outputs.linear + turning) : 0.0;
    travel += 0.5 * (inputs.left_travel + inputs.right_travel);
    outputs = board.step(kStep, inputs);
  }
  void say_alive() {
    if (clock.utime() - last_alive_ >= 1'000'000) {
      last_alive_ = clock.utime();
      node_status_t alive{};
      alive.utime = last_alive_;
      alive.process = "create2";
      alive.robot = "create2";
      lcm.publish(channels::kNodeStatus, &alive);
    }
  }
  void on_odometry(const odometry_t& message) { odometry.push_back(message); }
  void on_status(const robot_status_t& message) { status.push_back(message); }

  double wheel_base_;
  std::unique_ptr<ByteStream> line_;
  Subscriber inbox_;
  Create2Commander commander_;
  std::int64_t last_alive_ = 0;  // [us]
};

}  // namespace luminav
