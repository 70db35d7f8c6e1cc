#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <functional>
#include <memory>
#include <string>

#include "drivers/base/base_driver.hpp"
#include "drivers/base/safety/guardian.hpp"
#include "drivers/p3dx/p3dx_node.hpp"
#include "drivers/p3dx/safety/arcos_guard.hpp"
#include "drivers/simulator/board_server.hpp"
#include "services/common/process/channels.hpp"
#include "tests/node/p3dx/p3dx_bench.hpp"

namespace luminav {
namespace {

constexpr double kSpeed = 0.4;         // [m/s]
constexpr double kDeceleration = 1.0;  // [m/s^2]
constexpr double kMargin = 0.15;       // [s]
constexpr double kWatchdog = 2.0;      // [s]

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
    command.robot = P3dxBench::robot_config().robot.name;
    command.session = 1;
    command.sequence = ++sequence_;
    command.linear_x = kSpeed;
    lcm_.publish(channels::kVelocityCommand, &command);
  }
  lcm::LCM& lcm_;
  Subscriber inbox_;
  std::int32_t sequence_ = 0;
};

/// A driver's process with its guardian, that drives until it is killed. Tells who its guardian is.
[[noreturn]] void run_driver(const std::string& device, int fast_baud, int tell) {
  const GuardianParams guarding{.silence = 0.3, .brake_time = kSpeed / kDeceleration + 0.3};
  Guardian guardian(guarding, guarded_arcos());
  const pid_t guardian_process = guardian.process();
  if (write(tell, &guardian_process, sizeof guardian_process) != sizeof guardian_process) {
    _exit(1);
  }
  close(tell);
  lcm::LCM lcm("memq://");
  const HostClock clock;
  P3dxConfig config = P3dxBench::robot_config();
  config.fast_baud = fast_baud;
  config.guardian_silence = guarding.silence;
  config.guardian_done_after = guarding.silence + guarding.brake_time + 0.15;
  P3dxNode p3dx(lcm, config, clock, stream_opener(device, config.baud));
  BaseDriver& node = p3dx;  // as the process around it knows it
  node.report_life([&] { guardian.beat(); });
  const Commander commander(lcm);
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

/// A line, and what kind of robot is at its end.
struct Kind {
  const char* name;
  bool network;
  int fast_baud;  // [bit/s] to switch to; 0 = stay at 9600
  bool mobilesim;
};
constexpr std::array<Kind, 6> kKinds = {{
    {"network", true, 0, false},
    {"serial line at 9600", false, 0, false},
    {"serial line at 115200", false, 115200, false},
    {"MobileSim on a network", true, 0, true},
    {"MobileSim on a serial line at 9600", false, 0, true},
    {"MobileSim on a serial line at 115200", false, 115200, true},
}};

ArcosConfig arcos_config(const Kind& kind) {
  ArcosConfig config;
  config.mobilesim = kind.mobilesim;
  return config;
}

/// A simulated robot in real time, and a driver's process that is about to fail.
class Rig {
 public:
  explicit Rig(const Kind& its_kind) : kind(its_kind), base(arcos_config(its_kind)) {
    server_ = kind.network ? BoardServer::on_tcp(base.controller(), 0) : BoardServer::on_pty(base.controller());
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) {
      throw std::runtime_error("no pipe");
    }
    const std::string device = server_->address();
    driver_ = fork();
    if (driver_ == 0) {
      close(ends[0]);
      run_driver(device, kind.fast_baud, ends[1]);
    }
    close(ends[1]);
    EXPECT_EQ(read(ends[0], &guardian_, sizeof guardian_), sizeof guardian_);
    close(ends[0]);
  }
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;
  ~Rig() {
    kill(driver_, SIGKILL);
    waitpid(driver_, nullptr, 0);
  }

  void poll() { server_->poll(); }
  void step() {
    base.step(nullptr, false);
    server_->poll();
    ++steps_;
    if (stood_after_ < 0 && standing()) {
      stood_after_ = steps_;
    }
  }
  void add_descriptors(std::vector<pollfd>& to) const {
    for (const int descriptor : server_->descriptors()) {
      to.push_back({descriptor, POLLIN, 0});
    }
  }
  void signal_driver(int number) const { kill(driver_, number); }
  void kill_both() const {
    kill(guardian_, SIGKILL);
    kill(driver_, SIGKILL);
  }
  void start_to_measure() {
    steps_ = 0;
    stood_after_ = -1;
  }

  [[nodiscard]] bool standing() const { return std::abs(base.outputs.linear) < 0.02; }
  [[nodiscard]] bool driving() const { return base.outputs.linear >= kSpeed - 1e-9; }
  /// The outputs are those of the last step, which may lie before the CLOSE.
  [[nodiscard]] bool left() const { return !base.controller().session_open() && !base.outputs.motors_enabled; }
  /// [s] of the robot's time from the start of the measurement to standing; -1 = never.
  [[nodiscard]] double stood_after() const { return stood_after_ < 0 ? -1.0 : 0.01 * stood_after_; }

  Kind kind;
  SimulatedBase base;

 private:
  std::unique_ptr<BoardServer> server_;
  pid_t driver_ = -1;
  pid_t guardian_ = -1;
  int steps_ = 0;
  int stood_after_ = -1;
};

using Rigs = std::vector<std::unique_ptr<Rig>>;

/// Lets all robots go on in real time until the condition holds for each of them; false after `limit` [s].
bool run_until(Rigs& rigs, const std::function<bool(const Rig&)>& condition, double limit) {
  const auto all = [&] {
    return std::all_of(rigs.begin(), rigs.end(), [&](const std::unique_ptr<Rig>& rig) { return condition(*rig); });
  };
  const double begin = now_seconds();
  for (int steps = 0; !all() && 0.01 * steps < limit; ++steps) {
    while (now_seconds() < begin + 0.01 * steps) {
      std::vector<pollfd> descriptors;
      for (const auto& rig : rigs) {
        rig->poll();
        rig->add_descriptors(descriptors);
      }
      poll(descriptors.data(), descriptors.size(), 2);
    }
    for (const auto& rig : rigs) {
      rig->step();
    }
  }
  return all();
}

/// Breaks the drivers of robots that drive, and measures how long each robot drives on. Where others use the machine a
/// guardian may be woken late: in time in one of a few attempts is in time, and in each attempt long before the robot's
/// own watchdog would have had it standing.
void expect_stops_in_time(const std::function<void(Rig&)>& break_driver, const std::function<void(Rigs&)>& afterwards) {
  constexpr double kLimit = 0.3 + kSpeed / kDeceleration + kMargin;
  constexpr int kAttempts = 5;
  std::vector<Kind> kinds(kKinds.begin(), kKinds.end());
  for (int attempt = 0; attempt < kAttempts && !kinds.empty(); ++attempt) {
    Rigs rigs;
    for (const Kind& kind : kinds) {
      rigs.push_back(std::make_unique<Rig>(kind));
    }
    ASSERT_TRUE(run_until(rigs, &Rig::driving, 20.0)) << "one never drove";
    for (const auto& rig : rigs) {
      rig->start_to_measure();
      break_driver(*rig);
    }
    ASSERT_TRUE(run_until(rigs, &Rig::standing, 4.0)) << "one never stood";
    EXPECT_TRUE(run_until(rigs, &Rig::left, 3.0)) << "session left open or motors left on";
    EXPECT_TRUE(run_until(rigs, &Rig::standing, 0.1)) << "drove again";
    kinds.clear();
    for (const auto& rig : rigs) {
      std::printf("%s: stands after %.2f s of at most %.2f s\n", rig->kind.name, rig->stood_after(), kLimit);
      EXPECT_LT(rig->stood_after(), kWatchdog) << rig->kind.name;
      if (rig->stood_after() > kLimit) {
        kinds.push_back(rig->kind);
      }
    }
    afterwards(rigs);
  }
  EXPECT_TRUE(kinds.empty()) << kinds.front().name << ": never stopped in time";
}

TEST(GuardedDriver, IsStoppedInTimeWhenKilled) {
  expect_stops_in_time([](Rig& rig) { rig.signal_driver(SIGKILL); }, [](Rigs&) {});
}

TEST(GuardedDriver, IsStoppedInTimeWhenFrozenAndDrivesOnWhenItWakes) {
  expect_stops_in_time([](Rig& rig) { rig.signal_driver(SIGSTOP); },
                       [](Rigs& rigs) {
                         for (const auto& rig : rigs) {
                           rig->signal_driver(SIGCONT);
                         }
                         EXPECT_TRUE(run_until(rigs, &Rig::driving, 20.0)) << "one never drove again";
                       });
}

TEST(GuardedDriver, IsStoppedByTheRobotsWatchdogWhenKilledWithItsGuardian) {
  Rigs rigs;
  for (const Kind& kind : kKinds) {
    if (!kind.mobilesim) {  // that one has no watchdog
      rigs.push_back(std::make_unique<Rig>(kind));
    }
  }
  ASSERT_TRUE(run_until(rigs, &Rig::driving, 20.0)) << "one never drove";
  for (const auto& rig : rigs) {
    rig->start_to_measure();
    rig->kill_both();
  }
  ASSERT_TRUE(run_until(rigs, &Rig::standing, 4.0)) << "one never stood";
  for (const auto& rig : rigs) {
    std::printf("%s: stands after %.2f s\n", rig->kind.name, rig->stood_after());
    EXPECT_LE(rig->stood_after(), kWatchdog + kSpeed / kDeceleration + kMargin) << rig->kind.name;
    EXPECT_GE(rig->stood_after(), kWatchdog - 0.5) << rig->kind.name << ": somebody else has stopped it";
  }
}

}  // namespace
}  // namespace luminav
