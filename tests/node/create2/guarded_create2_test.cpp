#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <memory>

#include "drivers/base/safety/guardian.hpp"
#include "drivers/create2/safety/oi_guard.hpp"
#include "drivers/simulator/board_server.hpp"
#include "tests/node/create2/create2_bench.hpp"

namespace luminav {
namespace {

constexpr double kSpeed = 0.2;  // [m/s]

/// A driver's process with its guardian, that drives on whatever happens.
[[noreturn]] void run_driver(const std::string& device) {
  const GuardianParams guarding{.silence = 0.3, .brake_time = 0.5};
  Guardian guardian(guarding, guarded_create2());
  lcm::LCM lcm("memq://");
  const HostClock clock;
  Create2Config config = Create2Bench::robot_config();
  config.guardian_silence = guarding.silence;
  config.guardian_done_after = guarding.silence + guarding.brake_time + 0.15;
  Create2Node node(lcm, config, clock, stream_opener(device, config.baud));
  node.report_life([&] { guardian.beat(); });
  Create2Commander commander(lcm);
  commander.wanted = DriveVelocity{kSpeed, 0.0};
  int guarded = 0;
  while (true) {
    pollfd readable{node.descriptor(), POLLIN, 0};
    poll(&readable, 1, 5);
    node.poll();
    while (lcm.handleTimeout(0) > 0) {
    }
    const int openings = node.descriptor() >= 0 ? node.openings() : 0;
    if (openings != guarded) {
      guarded = openings;
      guardian.watch_line(node.descriptor());
    }
  }
}

/// A simulated robot in real time on a line, and a driver's process that is about to fail. The robot has no watchdog:
/// what it was told last it does for ever.
class GuardedCreate2 : public testing::TestWithParam<bool> {
 protected:
  GuardedCreate2() : board_(0.235) {
    server_ = GetParam() ? BoardServer::on_tcp(board_, 0) : BoardServer::on_pty(board_);
    const std::string device = server_->address();
    driver_ = fork();
    if (driver_ == 0) {
      run_driver(device);
    }
  }
  ~GuardedCreate2() override {
    kill(driver_, SIGKILL);
    waitpid(driver_, nullptr, 0);
  }

  /// Lets the robot go on until the condition holds; false when that takes too long.
  bool run_until(const std::function<bool()>& condition) {
    constexpr int kLongest = 3000;  // steps of 10 ms
    for (int i = 0; i < kLongest && !condition(); ++i) {
      server_->poll();
      BoardInputs inputs;
      inputs.left_travel = inputs.right_travel = 0.01 * speed();
      outputs_ = board_.step(0.01, inputs);
      server_->poll();
      poll(nullptr, 0, 10);
    }
    return condition();
  }
  [[nodiscard]] double speed() const { return outputs_.motors_enabled ? outputs_.linear : 0.0; }
  [[nodiscard]] bool drives() const { return speed() > 0.9 * kSpeed; }
  [[nodiscard]] bool is_left() const { return speed() == 0.0 && board_.mode() == OiMode::kPassive; }

  Create2Board board_;
  BoardOutputs outputs_;
  std::unique_ptr<BoardServer> server_;
  pid_t driver_ = -1;
};

TEST_P(GuardedCreate2, IsStoppedWhenItsDriverIsKilled) {
  ASSERT_TRUE(run_until([this] { return drives(); }));
  kill(driver_, SIGKILL);
  EXPECT_TRUE(run_until([this] { return is_left(); }));
}

TEST_P(GuardedCreate2, IsStoppedWhenItsDriverIsFrozenAndDrivesOnWhenItWakes) {
  ASSERT_TRUE(run_until([this] { return drives(); }));
  kill(driver_, SIGSTOP);
  EXPECT_TRUE(run_until([this] { return is_left(); }));
  kill(driver_, SIGCONT);
  EXPECT_TRUE(run_until([this] { return drives(); }));
}

INSTANTIATE_TEST_SUITE_P(Lines, GuardedCreate2, testing::Bool(),
                         [](const auto& line) { return line.param ? "network" : "serial"; });

}  // namespace
}  // namespace luminav
