// The whole robot on one machine, a stranger on another at the same wire. With ttl 0 nothing that he sends moves,
// changes, stops or kills anything or makes it late; with ttl 1 and a key nothing that he commands does, but that he
// may stop the robot. Without a key he is obeyed: that shows that the attack is one. Exit status 77 where the kernel
// allows no network namespaces.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>

#include "services/common/configuration/building_file.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/command_line.hpp"
#include "tests/system/faults/fleet.hpp"
#include "tests/system/faults/robot_watch.hpp"
#include "tests/system/faults/stranger.hpp"
#include "tests/system/faults/truth_watch.hpp"

namespace luminav {
namespace {

constexpr double kAttack = 6.0;            // [s]
constexpr double kFlood = 3.0;             // [s]
constexpr std::int64_t kSlow = 1'000'000;  // [us] a handler may take on a machine that others use too
constexpr double kSilence = 4.0;           // [s] a process may be silent, which speaks once a second
constexpr std::int64_t kRepeat = 100'000;  // [us] an order is repeated as a person's program would, each a new one
constexpr double kPatience = 10.0;         // [s] until it has its effect: a job waits until nobody touches the robot

/// What a stranger could have changed.
struct Condition {
  std::map<std::string, pid_t> pids;
  std::map<std::string, std::int64_t> dropped;
  bool motors = false;
  bool stopped = false;
  std::int64_t motors_id = 0;
  std::int64_t goal_id = 0;
  std::int64_t initial_pose_id = 0;
  double driven = 0.0;  // [m]
  bool operator==(const Condition&) const = default;
};

std::string describe(const Condition& condition) {
  return fmt::format("processes {}, dropped {}, motors {} by {}, stopped {}, goal {}, guess {}, driven {:.3f} m",
                     condition.pids, condition.dropped, condition.motors, condition.motors_id, condition.stopped,
                     condition.goal_id, condition.initial_pose_id, condition.driven);
}

class Siege {
 public:
  enum class Network { kThisMachine, kKeyed, kOpen };

  Siege(const Scenario& scenario, const std::filesystem::path& folder, Network kind)
      : is_open_(kind != Network::kThisMachine),
        has_key_(kind == Network::kKeyed),
        cable_(robot_, elsewhere_),
        fleet_({.scenario = scenario,
                .folder = folder,
                .network = &robot_,
                .lcm_url = is_open_ ? "udpm://239.255.76.67:7667?ttl=1" : "udpm://239.255.76.67:7667?ttl=0",
                .procman_url = is_open_ ? "udpm://239.255.76.67:7668?ttl=1" : "udpm://239.255.76.67:7668?ttl=0",
                .key_file = has_key_ ? write_key(folder) : "",
                .placed = {},
                .preload = {}}),
        truth_(fleet_.lcm()),
        watch_(fleet_.lcm(), fleet_.clock()),
        stranger_(elsewhere_, "10.77.0.1"),
        state_folder_(folder / "robot") {
    fleet_.add_host("robot", &robot_, {});
  }

  int run() {
    fmt::print("{}\n", !is_open_ ? "ttl 0" : has_key_ ? "ttl 1, with a key" : "ttl 1, without a key");
    if (!fleet_.run_script("go")) {
      fmt::print("FAILED to start: {}\n", fleet_.failure());
      return 1;
    }
    const bool ready = fleet_.pump_until(
        [&] { return watch_.pose() && watch_.robot() && watch_.robot()->motors_enabled != 0 && truth_.newest(); },
        30.0);
    expect(ready, "the robot stands ready, " + watch_.sentence());
    fleet_.pump_for(2.0);
    if (is_open_ && !has_key_) {
      check_obedience();
      return failed_;
    }
    const Condition before = condition();
    attack_for(kAttack, [&] {
      stranger_.command_everything(fleet_.clock().utime());
      if (!is_open_) {
        stranger_.engage_stop(fleet_.clock().utime());
        stranger_.send_every_type();
        stranger_.send_rubbish(50);
      }
    });
    compare(before, is_open_ ? "commands" : "commands, every type, rubbish");
    if (is_open_) {
      check_stop();
    } else {
      flood(before);
    }
    expect(!has_intruder(), "no map is written for him");
    expect(fleet_.run_script("stop", 30.0), "everything stops by order, " + fleet_.failure());
    return failed_;
  }

 private:
  void expect(bool holds, const std::string& what) {
    fmt::print("{} {}\n", holds ? "  ok  " : "FAILED", what);
    std::fflush(stdout);
    failed_ += holds ? 0 : 1;
  }

  /// Every order alone has its effect where nothing keeps him out: else that it has none elsewhere would say nothing.
  void check_obedience() {
    for (const Stranger::Order& order : Stranger::orders()) {
      if (order.channel == channels::kStop) {
        stranger_.engage_stop(fleet_.clock().utime());
        (void)fleet_.pump_until([&] { return watch_.robot()->stop_engaged != 0; }, 5.0);
      }
      const Condition before = condition();
      std::int64_t given = 0;
      const bool obeyed = fleet_.pump_until(
          [&] {
            if (const std::int64_t now = fleet_.clock().utime(); now - given >= kRepeat) {
              given = now;
              stranger_.give(order, now);
            }
            return is_obeyed(order.channel, before);
          },
          kPatience);
      expect(obeyed, "an open network obeys his " + order.channel);
    }
  }

  [[nodiscard]] bool is_obeyed(const std::string& channel, const Condition& before) const {
    const Condition now = condition();
    const std::map<std::string, bool> effects = {
        {channels::kVelocityCommand, now.driven > before.driven + 0.1},
        {channels::kTeleopCommand, now.driven > before.driven + 0.1},
        {channels::kInitialPose, now.initial_pose_id != before.initial_pose_id},
        {channels::kMapCommand, has_intruder()},
        {channels::kJob, now.goal_id != before.goal_id},
        {channels::kGoal, now.goal_id != before.goal_id},
        {channels::kStop, before.stopped && !now.stopped},
        {channels::kMotorsCommand, now.motors_id != before.motors_id && !now.motors},
        {channels::kProcmanOrders, now.pids != before.pids}};
    return effects.at(channel);
  }

  [[nodiscard]] bool has_intruder() const {
    const std::filesystem::recursive_directory_iterator files(state_folder_);
    return std::any_of(begin(files), end(files), [](const std::filesystem::directory_entry& entry) {
      return entry.path().filename().string().find("intruder") != std::string::npos;
    });
  }

  template <typename Step>
  void attack_for(double seconds, const Step& step) {
    const std::int64_t end = fleet_.clock().utime() + static_cast<std::int64_t>(seconds * 1e6);
    while (fleet_.clock().utime() < end) {
      step();
      fleet_.pump();
    }
  }

  void compare(const Condition& before, const std::string& attack) {
    const std::int64_t now = fleet_.clock().utime();
    fleet_.pump_for(2.0);
    const Condition after = condition();
    expect(after == before, fmt::format("{} change nothing", attack));
    if (after != before) {
      fmt::print("       before: {}\n       after:  {}\n", describe(before), describe(after));
    }
    for (const auto& [process, status] : fleet_.statuses()) {
      const auto heard = fleet_.heard_after(process, now - static_cast<std::int64_t>(kSilence * 1e6));
      expect(heard.has_value() && status.worst_step_us < kSlow,
             fmt::format("{} speaks on time, its longest step {} us", process, status.worst_step_us));
    }
  }

  void flood(const Condition& before) {
    const std::int64_t sent = stranger_.sent();
    attack_for(kFlood, [&] { stranger_.send_rubbish(5'000); });
    compare(before, fmt::format("{:.0f} packets/s", static_cast<double>(stranger_.sent() - sent) / kFlood));
  }

  static std::filesystem::path write_key(const std::filesystem::path& folder) {
    const std::filesystem::path file = folder / "network.key";
    std::ofstream(file) << std::string(64, '5') << '\n';
    std::filesystem::permissions(file, std::filesystem::perms::owner_read);
    return file;
  }

  /// Engaging is everybody's right, releasing is not.
  void check_stop() {
    const auto is_stopped = [&] { return watch_.robot()->stop_engaged != 0; };
    stranger_.engage_stop(fleet_.clock().utime());
    expect(fleet_.pump_until(is_stopped, 5.0), "anybody stops the robot");
    attack_for(1.0, [&] { stranger_.command_everything(fleet_.clock().utime()); });
    expect(is_stopped(), "and cannot release it");
  }

  [[nodiscard]] Condition condition() const {
    Condition now;
    for (const std::string& process : fleet_.processes()) {
      now.pids[process] = fleet_.pid(process);
      const auto status = fleet_.statuses().find(process);
      const bool counts = !is_open_ && status != fleet_.statuses().end();  // what is heard and refused is counted
      now.dropped[process] = counts ? status->second.dropped_inputs : 0;
    }
    now.motors = watch_.robot()->motors_enabled != 0;
    now.stopped = watch_.robot()->stop_engaged != 0;
    now.motors_id = watch_.robot()->motors_command_id;
    now.goal_id = watch_.navigation() ? watch_.navigation()->goal_id : 0;
    now.initial_pose_id = watch_.pose() ? watch_.pose()->initial_pose_id : 0;
    now.driven = 1e-2 * std::round(1e2 * truth_.driven());
    return now;
  }

  bool is_open_;
  bool has_key_;
  NetworkHost robot_;
  NetworkHost elsewhere_;
  Cable cable_;
  Fleet fleet_;
  TruthWatch truth_;
  RobotWatch watch_;
  Stranger stranger_;
  std::filesystem::path state_folder_;
  int failed_ = 0;
};

int run_strangers(const std::string& scenario_file) {
  try {
    NetworkHost attempt;
  } catch (const std::runtime_error& error) {
    fmt::print("skipped: {}\n", error.what());
    return 77;
  }
  std::string folder = (std::filesystem::temp_directory_path() / "luminav-strangers-XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) {
    throw std::runtime_error(fmt::format("{}: cannot be made", folder));
  }
  int failed = 0;
  for (const Siege::Network kind : {Siege::Network::kThisMachine, Siege::Network::kKeyed, Siege::Network::kOpen}) {
    const std::filesystem::path round = std::filesystem::path(folder) / std::to_string(static_cast<int>(kind));
    std::filesystem::create_directories(round);
    failed += Siege(read_scenario(scenario_file), round, kind).run();
  }
  if (std::getenv("LUMINAV_KEEP") == nullptr) {
    std::filesystem::remove_all(folder);
  } else {
    fmt::print("kept {}\n", folder);
  }
  return failed == 0 ? 0 : 1;
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  return luminav::run_guarded("strangers", [&] {
    return luminav::run_strangers(argc > 1 ? argv[1] : LUMINAV_SOURCE_DIR "/tests/system/faults/two_hosts.toml");
  });
}
