// The whole robot on two machines, each a network namespace of its own: simulator, driver, camera and detector on the
// robot, the rest on the desk, whose clock is ten seconds ahead. While it drives the wire is pulled out for five
// seconds, processes move from one machine to the other and the desk's clock is set by an hour. Exit status 77 where
// the kernel allows no network namespaces.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>

#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/process/command_line.hpp"
#include "tests/evaluation/runs/mission.hpp"
#include "tests/system/faults/fleet.hpp"
#include "tests/system/faults/robot_watch.hpp"
#include "tests/system/faults/truth_watch.hpp"

namespace luminav {
namespace {

constexpr double kCommandTimeout = 0.3;  // [s] without commands, then the driver brakes
constexpr double kMargin = 0.15;         // [s]
constexpr double kDriving = 0.35;        // [m/s]
constexpr double kResumeWithin = 3.0;    // [s] of the wire being whole, or a process being ready
constexpr double kWatchdog = 2.0;        // [s] of the robot
constexpr double kDrivesWithin = 30.0;   // [s] also when it has just come to a goal, or has to find its pose first
constexpr double kPatience = 20.0;       // [s] for what has to happen on a machine that others use too

/// The wall clock of one machine, that its processes see through the preloaded library.
class WallClockShift {
 public:
  explicit WallClockShift(const std::filesystem::path& file) : file_(file) {
    const int descriptor = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (descriptor < 0 || ftruncate(descriptor, sizeof(std::int64_t)) != 0) {
      throw std::runtime_error(fmt::format("{}: cannot be written", file.string()));
    }
    shift_ = static_cast<volatile std::int64_t*>(
        mmap(nullptr, sizeof(std::int64_t), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0));
    close(descriptor);
  }
  void set(double seconds) { *shift_ = static_cast<std::int64_t>(seconds * 1e6); }
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
  volatile std::int64_t* shift_;
};

struct Checks {
  int failed = 0;
  void expect(bool holds, const std::string& what) {
    fmt::print("{} {}\n", holds ? "  ok  " : "FAILED", what);
    std::fflush(stdout);
    failed += holds ? 0 : 1;
  }
};

class TwoHosts {
 public:
  TwoHosts(const Scenario& scenario, const std::filesystem::path& folder)
      : cable_(robot_, desk_),
        desk_clock_((std::filesystem::create_directories(folder / "desk"), folder / "desk/clock-shift")),
        fleet_({.scenario = scenario,
                .folder = folder,
                .network = &robot_,
                .lcm_url = "udpm://239.255.76.67:7667?ttl=1",
                .image_url = "udpm://239.255.76.67:7667?ttl=0",
                .procman_url = "udpm://239.255.76.67:7668?ttl=1",
                .placed = {{"localizer", "desk"}, {"mapper", "desk"}, {"planner", "desk"}, {"controller", "desk"}},
                .preload = {}}),
        truth_(fleet_.lcm()),
        robot_says_(fleet_.lcm(), fleet_.clock()),
        mission_(std::make_unique<Mission>(fleet_.lcm(), scenario, true)),
        limits_(read_robot(scenario.robot_file).limits) {
    desk_clock_.set(10.0);
    fleet_.add_host("robot", &robot_, {});
    fleet_.add_host("desk", &desk_,
                    {{"XDG_RUNTIME_DIR", (folder / "desk/run").string()},
                     {"LD_PRELOAD", LUMINAV_SHIFTED_CLOCK},
                     {"LUMINAV_CLOCK_SHIFT", desk_clock_.file().string()}});
  }

  int run() {
    const std::int64_t begun = fleet_.clock().utime();
    if (!fleet_.run_script("go")) {
      fmt::print("FAILED to start: {}\n", fleet_.failure());
      return 1;
    }
    fmt::print("all ready after {:.2f} s\n", seconds_since(begun));
    const std::int64_t counted = fleet_.clock().utime();
    const std::int64_t by_robot = cable_.sent_by(robot_);
    const std::int64_t by_desk = cable_.sent_by(desk_);
    checks_.expect(says({"10 s"}), "the sheriff says that the desk's clock is 10 s ahead");
    checks_.expect(wait_for_driving(), "drives");
    fmt::print(
        "       over the wire: {:.1f} kB/s from the robot (with the simulator's truth), {:.1f} kB/s from the desk\n",
        1e-3 * static_cast<double>(cable_.sent_by(robot_) - by_robot) / seconds_since(counted),
        1e-3 * static_cast<double>(cable_.sent_by(desk_) - by_desk) / seconds_since(counted));
    expect_in_time([&] { return cut_while_driving(); });
    expect_in_time([&] { return move_while_driving("localizer", "robot"); });
    step_clock();
    expect_in_time([&] { return move_while_driving("mapper", "robot"); });
    expect_in_time([&] { return move_while_driving("controller", "robot"); });
    expect_in_time([&] { return move_while_driving("localizer", "desk"); });
    // it is on the way to a goal still; after all that happened it has to come there, and to the next
    const std::size_t enough = mission_->results().size() + 2;
    const bool goes_on = fleet_.pump_until([&] { return mission_->results().size() >= enough; }, 150.0);
    checks_.expect(goes_on && mission_->failure().empty(),
                   fmt::format("all goals reached {}", goes_on ? mission_->failure() : "(out of time)"));
    if (!goes_on) {
      fmt::print("       {}\n", robot_says_.sentence());
    }
    for (const GoalResult& goal : mission_->final_results()) {
      fmt::print("       ({:.1f}, {:.1f}): {} after {:.0f} s, {:.2f} m beside it {}\n", goal.x, goal.y,
                 goal.reached ? "reached" : "missed", goal.time_s, goal.error_m, goal.cause);
    }
    checks_.expect(truth_.contacts() + truth_.hard_contacts() == 0, "no contact");
    checks_.expect(fleet_.run_script("stop", 30.0), "everything stops by order, " + fleet_.failure());
    return checks_.failed == 0 ? 0 : 1;
  }

 private:
  [[nodiscard]] double seconds_since(std::int64_t utime) const {
    return static_cast<double>(fleet_.clock().utime() - utime) * 1e-6;
  }
  /// Waits until the sheriff has said one of these.
  [[nodiscard]] bool says(const std::vector<std::string>& words) {
    const auto find = [&] {
      const std::vector<std::string>& notices = fleet_.notices();
      return std::find_if(notices.begin(), notices.end(), [&](const std::string& notice) {
        return std::any_of(words.begin(), words.end(),
                           [&](const std::string& word) { return notice.find(word) != std::string::npos; });
      });
    };
    if (!fleet_.pump_until([&] { return find() != fleet_.notices().end(); }, kPatience)) {
      return false;
    }
    fmt::print("       \"{}\"\n", *find());
    return true;
  }
  /// Where others use the machine a process may be woken late: in time in one of a few attempts is in time.
  void expect_in_time(const std::function<bool()>& attempt) {
    constexpr int kAttempts = 4;
    bool in_time = false;
    for (int i = 0; i < kAttempts && !in_time; ++i) {
      if (!wait_for_driving()) {
        break;
      }
      in_time = attempt();
    }
    checks_.failed += in_time ? 0 : 1;
  }
  /// Waits until it drives at speed; false, and said, when it does not.
  [[nodiscard]] bool wait_for_driving() {
    const bool drives =
        fleet_.pump_until([&] { return truth_.newest() && truth_.newest()->linear > kDriving; }, kDrivesWithin);
    if (!drives) {
      fmt::print("FAILED does not drive: {}\n", robot_says_.sentence());
    }
    return drives;
  }

  bool cut_while_driving() {
    fleet_.pump_for(1.0);
    const sim_truth_t before = *truth_.newest();
    const std::int64_t cut = fleet_.clock().utime();
    cable_.cut();
    fleet_.pump_for(5.0);
    cable_.join();
    const std::int64_t joined = fleet_.clock().utime();
    const double bound = kCommandTimeout + kMargin +
                         std::max(std::abs(before.linear) / limits_.linear_deceleration,
                                  std::abs(before.angular) / limits_.angular_acceleration);
    const auto stood = truth_.stood_at(cut);
    const double after = stood ? static_cast<double>(*stood - cut) * 1e-6 : 99.0;
    fmt::print("{} wire cut at {:.2f} m/s: stands after {:.2f} s (at most {:.2f}); {:.2f} s without truth at most\n",
               after <= bound ? "  ok  " : " late ", before.linear, after, bound, truth_.take_longest_gap());
    checks_.expect(after < kWatchdog, "and long before the robot's watchdog");
    const auto moved_before = truth_.moved_at(stood.value_or(cut));
    checks_.expect(!moved_before || *moved_before > joined, "and stays standing until the wire is whole");
    fleet_.pump_until([&] { return truth_.moved_at(joined).has_value(); }, kPatience);
    const auto moved = truth_.moved_at(joined);
    checks_.expect(moved.has_value(), "goes on by itself");
    const double resumed = moved ? static_cast<double>(*moved - joined) * 1e-6 : 99.0;
    fmt::print("{} goes on after {:.2f} s (at most 3)\n", resumed <= kResumeWithin ? "  ok  " : " late ", resumed);
    return after <= bound && resumed <= kResumeWithin;
  }

  bool move_while_driving(const std::string& process, const std::string& host) {
    if (!fleet_.move(process, host)) {
      checks_.expect(false, fleet_.failure());
      return false;
    }
    const std::int64_t moved = fleet_.clock().utime();
    const bool drives = fleet_.pump_until([&] { return truth_.moved_at(moved).has_value(); }, kPatience);
    checks_.expect(drives, fmt::format("{} moved to {}, drives on", process, host));
    const double after = seconds_since(moved);
    fmt::print("{} after {:.2f} s (at most 3)\n", after <= kResumeWithin ? "  ok  " : " late ", after);
    return after <= kResumeWithin;
  }

  void step_clock() {
    checks_.expect(wait_for_driving(), "drives before the desk's clock is set");
    desk_clock_.set(3600.0);
    const std::int64_t stepped = fleet_.clock().utime();
    fleet_.pump_for(3.0);
    const auto drives = [&] {
      const auto stood = truth_.stood_at(stepped);
      return !stood || truth_.moved_at(*stood).has_value();
    };
    checks_.expect(fleet_.pump_until(drives, kPatience), "drives on when the desk's clock is set by an hour");
    checks_.expect(says({"3600 s"}), "and the sheriff says so");
  }

  NetworkHost robot_;
  NetworkHost desk_;
  Cable cable_;
  WallClockShift desk_clock_;
  Fleet fleet_;
  TruthWatch truth_;
  RobotWatch robot_says_;
  std::unique_ptr<Mission> mission_;
  MotionLimits limits_;
  Checks checks_;
};

int run_two_hosts(const std::string& scenario_file) {
  std::string folder = (std::filesystem::temp_directory_path() / "luminav-two-hosts-XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) {
    throw std::runtime_error(fmt::format("{}: cannot be made", folder));
  }
  try {
    NetworkHost attempt;
  } catch (const std::runtime_error& error) {
    fmt::print("skipped: {}\n", error.what());
    return 77;
  }
  int status = 0;
  {
    TwoHosts test(read_scenario(scenario_file), folder);
    status = test.run();
  }
  if (std::getenv("LUMINAV_KEEP") == nullptr) {
    std::filesystem::remove_all(folder);
  } else {
    fmt::print("kept {}\n", folder);
  }
  return status;
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  return luminav::run_guarded("two_hosts", [&] {
    return luminav::run_two_hosts(argc > 1 ? argv[1] : LUMINAV_SOURCE_DIR "/tests/system/faults/two_hosts.toml");
  });
}
