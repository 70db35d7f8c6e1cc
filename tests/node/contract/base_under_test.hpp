#pragma once

#include <functional>
#include <luminav/node_status_t.hpp>

#include "drivers/contract/check_base_node.hpp"
#include "tests/node/p3dx/p3dx_bench.hpp"

namespace luminav {

/// What a broken driver makes of a message; false = it never sends it.
template <typename Message>
using Tampering = std::function<bool(Message&)>;

/// The simulated p3dx and its driver on a network of their own, and check-base behind a relay that can spoil what is
/// said and what is heard. Virtual time.
class BaseUnderTest {
 public:
  explicit BaseUnderTest(const P3dxConfig& config = P3dxBench::robot_config(), bool drives = true)
      : bench_(ArcosConfig{}, config),
        outer_("memq://"),
        node_(outer_, config.robot, bench_.clock, {.process = "p3dx", .drives = drives, .key = {}}),
        from_driver_(bench_.lcm),
        to_driver_(outer_) {
    from_driver_.on(channels::kOdometry, &BaseUnderTest::on_odometry, this);
    from_driver_.on(channels::kSonar, &BaseUnderTest::on_sonar, this);
    from_driver_.on(channels::kRobotStatus, &BaseUnderTest::on_robot_status, this);
    to_driver_.on(channels::kVelocityCommand, &BaseUnderTest::on_velocity_command, this);
    to_driver_.on(channels::kStop, &BaseUnderTest::on_stop, this);
    to_driver_.on(channels::kMotorsCommand, &BaseUnderTest::on_motors_command, this);
  }

  Tampering<odometry_t> odometry;
  Tampering<sonar_t> sonar;
  Tampering<robot_status_t> status;
  Tampering<stop_t> stop;
  Tampering<motors_command_t> motors;
  Tampering<velocity_command_t> command;

  /// Until the exercise is over, or for `seconds` where nothing drives. The base has connected before.
  std::vector<Clause> judge(double seconds = 60.0) {
    bench_.run(3.0);
    listens_ = true;
    for (double passed = 0.0; passed < seconds && !(node_.exercise() && node_.exercise()->is_done()); passed += 0.02) {
      bench_.run(0.02);
      drain();
      say_alive();
    }
    return node_.clauses();
  }
  [[nodiscard]] std::string refusal() const { return node_.exercise()->refusal(); }
  [[nodiscard]] bool is_done() const { return node_.exercise()->is_done(); }
  P3dxBench& bench() { return bench_; }
  /// Somebody else does, where check-base listens.
  void say(const velocity_command_t& message) { outer_.publish(channels::kVelocityCommand, &message); }

 private:
  void drain() {
    while (outer_.handleTimeout(0) > 0) {
    }
  }
  template <typename Message>
  void relay(lcm::LCM& to, const char* channel, Message message, const Tampering<Message>& tamper) {
    if (listens_ && (!tamper || tamper(message))) {
      to.publish(channel, &message);
    }
  }
  void on_odometry(const odometry_t& message) { relay(outer_, channels::kOdometry, message, odometry); }
  void on_sonar(const sonar_t& message) { relay(outer_, channels::kSonar, message, sonar); }
  void on_robot_status(const robot_status_t& message) { relay(outer_, channels::kRobotStatus, message, status); }
  void on_velocity_command(const velocity_command_t& message) {
    relay(bench_.lcm, channels::kVelocityCommand, message, command);
  }
  void on_stop(const stop_t& message) { relay(bench_.lcm, channels::kStop, message, stop); }
  void on_motors_command(const motors_command_t& message) {
    relay(bench_.lcm, channels::kMotorsCommand, message, motors);
  }
  void say_alive() {
    constexpr std::int64_t kPeriod = 1'000'000;  // [us]
    if (bench_.clock.utime() - last_alive_ >= kPeriod) {
      last_alive_ = bench_.clock.utime();
      node_status_t alive{};
      alive.utime = last_alive_;
      alive.process = "p3dx";
      alive.robot = P3dxBench::robot_config().robot.name;
      outer_.publish(channels::kNodeStatus, &alive);
    }
  }

  P3dxBench bench_;
  lcm::LCM outer_;
  CheckBaseNode node_;
  Subscriber from_driver_;
  Subscriber to_driver_;
  bool listens_ = false;
  std::int64_t last_alive_ = 0;  // [us]
};

/// The texts of the clauses with that verdict.
inline std::vector<std::string> with_verdict(const std::vector<Clause>& clauses, Clause::Verdict verdict) {
  std::vector<std::string> texts;
  for (const Clause& clause : clauses) {
    if (clause.verdict() == verdict) {
      texts.push_back(clause.text());
    }
  }
  return texts;
}

}  // namespace luminav
