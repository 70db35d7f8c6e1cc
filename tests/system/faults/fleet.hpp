#pragma once

#include <filesystem>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <luminav/node_status_t.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/simulator/world/scenario.hpp"
#include "services/common/process/clock.hpp"
#include "services/common/process/subscriber.hpp"
#include "services/launcher/sheriff/sheriff.hpp"
#include "tests/system/faults/hosts/test_host.hpp"

namespace luminav {

/// The processes of launch/demo.pmd as a test wants them.
struct FleetPlan {
  Scenario scenario;
  std::filesystem::path folder;          // everything that is written goes there
  const NetworkHost* network = nullptr;  // where the test itself listens
  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  std::string image_url = {};  // for camera images, if not the same
  std::string procman_url = "udpm://239.255.76.67:7668?ttl=0";
  std::filesystem::path key_file = {};              // of all hosts and of the sheriff; "" = an open network
  bool pty = false;                                 // the robot's line: a terminal instead of TCP
  std::map<std::string, std::string> placed = {};   // process -> host; others: "robot"
  std::map<std::string, std::string> preload = {};  // process -> words in front of its command
};

/// Thrown when the person at the terminal wants an end.
struct Interrupted {};

/// Machines with their deputies and a sheriff over them, in real time.
class Fleet {
 public:
  explicit Fleet(FleetPlan plan);
  ~Fleet();

  /// Starts the deputy of a machine. Its state folder is FOLDER/ID.
  TestHost& add_host(const std::string& id, const NetworkHost* network, std::map<std::string, std::string> environment,
                     int memory_limit = 1000);
  /// Runs a script of the configuration; false: it failed, see failure().
  bool run_script(const std::string& name, double time_limit = 30.0);
  [[nodiscard]] const std::string& failure() const { return failure_; }

  /// Handles messages for a while (throws Interrupted after Ctrl-C), at most `milliseconds` when there are none.
  void pump(int milliseconds = 10);
  /// Pumps until `done`; false: it was not within `seconds`.
  bool pump_until(const std::function<bool()>& done, double seconds);
  void pump_for(double seconds);

  /// Stops a process where it runs and starts it on another host, by a sheriff with another configuration.
  bool move(const std::string& process, const std::string& host);
  /// The sheriff dies and another one takes over.
  void replace_sheriff();

  [[nodiscard]] lcm::LCM& lcm() { return *lcm_; }
  [[nodiscard]] launcher::Sheriff& sheriff() { return *sheriff_; }
  [[nodiscard]] const Clock& clock() const { return clock_; }
  [[nodiscard]] TestHost& host(const std::string& id) { return *hosts_.at(id); }
  /// 0 = does not run.
  [[nodiscard]] pid_t pid(const std::string& process) const;
  [[nodiscard]] std::vector<std::string> processes() const;
  /// When its deputy first listed a process under its present pid [us]; 0 = it does not run.
  [[nodiscard]] std::int64_t started(const std::string& process) const;
  /// When a process first said READY or DEGRADED after `utime` [us], on this clock.
  [[nodiscard]] std::optional<std::int64_t> heard_after(const std::string& process, std::int64_t utime) const;
  [[nodiscard]] const std::map<std::string, node_status_t>& statuses() const { return statuses_; }
  /// What the sheriff had to say, oldest first.
  [[nodiscard]] const std::vector<std::string>& notices() const { return notices_; }

 private:
  void on_node_status(const node_status_t& status);
  void make_sheriff();

  FleetPlan plan_;
  HostClock clock_;
  launcher::PmdFile commands_;
  std::unique_ptr<lcm::LCM> lcm_;
  std::unique_ptr<lcm::LCM> procman_;
  std::unique_ptr<Subscriber> subscriber_;
  std::map<std::string, std::unique_ptr<TestHost>> hosts_;
  std::unique_ptr<launcher::Sheriff> sheriff_;
  std::map<std::string, std::vector<std::int64_t>> heard_;  // [us] of the last hundred words of each process
  std::map<std::string, node_status_t> statuses_;
  std::map<std::string, std::pair<pid_t, std::int64_t>> started_;  // pid, and when it was first seen [us]
  std::vector<std::string> notices_;
  std::string failure_;
};

}  // namespace luminav
