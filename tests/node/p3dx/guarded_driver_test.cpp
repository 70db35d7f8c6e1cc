#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <memory>
#include <string>

#include "drivers/p3dx/guardian.hpp"
#include "drivers/p3dx/p3dx_node.hpp"
#include "drivers/simulator/arcos_server.hpp"
#include "services/common/process/channels.hpp"
#include "tests/node/p3dx/p3dx_bench.hpp"

namespace luminav {
namespace {

constexpr double kSpeed = 0.4;         // [m/s]
constexpr double kDeceleration = 1.0;  // [m/s^2]

double now_seconds() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Answers each ROBOT_STATUS: drive on.
class Commander {
 public:
  explicit Commander(lcm::LCM& lcm) : lcm_(lcm), inbox_(lcm) {
    inbox_.on(channels::kRobotStatus, &Commander::on_status, this);
  }

 private:
  void on_status(const robot_status_t& message) {
    velocity_command_t command{};
    command.utime = message.utime;
    command.session = 1;
    command.sequence = ++sequence_;
    command.linear_x = kSpeed;
    lcm_.publish(channels::kVelocityCommand, &command);
  }
  lcm::LCM& lcm_;
  Subscriber inbox_;
  std::int32_t sequence_ = 0;
};

/// A driver's process with its guardian, that drives until it is killed.
[[noreturn]] void run_driver(const std::string& device, int fast_baud) {
  Guardian guardian({.silence = 0.3, .brake_time = kSpeed / kDeceleration + 0.3});
  lcm::LCM lcm("memq://");
  const HostClock clock;
  P3dxConfig config = P3dxBench::robot_config();
  config.fast_baud = fast_baud;
  P3dxNode node(lcm, config, clock, stream_opener(device, config.baud));
  const Commander commander(lcm);
  int guarded = 0;
  while (true) {
    pollfd readable{node.descriptor(), POLLIN, 0};
    poll(&readable, 1, 5);
    node.poll();
    while (lcm.handleTimeout(0) > 0) {
    }
    const int openings = node.descriptor() >= 0 ? node.link().openings() : 0;
    if (openings != guarded) {
      guarded = openings;
      guardian.watch_line(node.descriptor());
    }
    guardian.beat();
  }
}

/// A simulated robot in real time, and a driver's process that is about to fail.
class GuardedDriver : public testing::Test {
 protected:
  void start(const std::string& line, int fast_baud = 0) {
    server_ = line == "tcp" ? ArcosServer::on_tcp(base_.controller(), 0) : ArcosServer::on_pty(base_.controller());
    const std::string device = server_->address();
    driver_ = fork();
    if (driver_ == 0) {
      run_driver(device, fast_baud);
    }
  }
  ~GuardedDriver() override {
    if (driver_ > 0) {
      kill(driver_, SIGKILL);
      waitpid(driver_, nullptr, 0);
    }
  }

  bool standing() const { return std::abs(base_.outputs.linear) < 0.02; }

  /// Runs until the condition holds; the robot's seconds that it took, or -1 after `limit`.
  template <typename Condition>
  double run_until(Condition condition, double limit) {
    const double begin = now_seconds();
    int steps = 0;
    for (; !condition() && 0.01 * steps < limit; ++steps) {
      while (now_seconds() < begin + 0.01 * steps) {
        server_->poll();
        std::vector<pollfd> descriptors;
        for (const int descriptor : server_->descriptors()) {
          descriptors.push_back({descriptor, POLLIN, 0});
        }
        poll(descriptors.data(), descriptors.size(), 2);
      }
      base_.step(nullptr, false);
      server_->poll();
    }
    return condition() ? 0.01 * steps : -1.0;
  }

  void expect_stop_after(int signal_number) {
    ASSERT_GE(run_until([this] { return base_.outputs.linear >= kSpeed - 1e-9; }, 15.0), 0.0) << "never drove";
    kill(driver_, signal_number);
    const double seconds = run_until([this] { return standing(); }, 3.0);
    RecordProperty("standstill_ms", static_cast<int>(1000.0 * seconds));
    std::printf("standstill after %.2f s of at most %.2f s\n", seconds, 0.3 + kSpeed / kDeceleration + 0.15);
    ASSERT_GE(seconds, 0.0) << "never stood";
    // Well before the robot's own watchdog, which needs 2 s and the way of braking.
    EXPECT_LT(seconds, 2.0);
    // the outputs are those of the last step, which may lie before the CLOSE
    const auto closed = [this] { return !base_.controller().session_open() && !base_.outputs.motors_enabled; };
    EXPECT_GE(run_until(closed, 3.0), 0.0) << "session left open or motors left on";
    EXPECT_TRUE(standing());
  }

  SimulatedBase base_;
  std::unique_ptr<ArcosServer> server_;
  pid_t driver_ = -1;
};

TEST_F(GuardedDriver, IsStoppedWhenKilledOnANetwork) {
  start("tcp");
  expect_stop_after(SIGKILL);
}

TEST_F(GuardedDriver, IsStoppedWhenKilledOnASerialLine) {
  start("pty");
  expect_stop_after(SIGKILL);
}

TEST_F(GuardedDriver, IsStoppedWhenFrozenAndDrivesOnWhenItWakes) {
  start("pty", 115200);
  expect_stop_after(SIGSTOP);
  kill(driver_, SIGCONT);
  EXPECT_GE(run_until([this] { return base_.outputs.linear >= kSpeed - 1e-9; }, 15.0), 0.0) << "never drove again";
}

}  // namespace
}  // namespace luminav
