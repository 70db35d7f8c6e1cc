#pragma once

#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <luminav/node_status_t.hpp>
#include <luminav_procman/procman_deputy_info_t.hpp>
#include <luminav_procman/procman_discovery_t.hpp>
#include <luminav_procman/procman_orders_t.hpp>
#include <luminav_procman/procman_output_t.hpp>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "services/common/process/subscriber.hpp"
#include "services/launcher/instant.hpp"
#include "services/launcher/pmd_file.hpp"
#include "services/launcher/sheriff/tracked_command.hpp"

namespace luminav::launcher {

struct SheriffConfig {
  std::string id;                      // "host:pid:utime", see make_sheriff_id
  bool observe = false;                // only listens
  std::optional<CommandKey> key = {};  // seals its orders; others' without it are not heard
};

/// An id as procman makes them; the utime says who started last.
std::string make_sheriff_id(const Instant& now);

/// [s] by which a deputy's clock may differ before a person is told; procman's deputies refuse orders a minute old.
inline constexpr double kClockTolerance = 5.0;

/// A deputy as the sheriff knows it.
struct DeputyState {
  std::string id;
  bool heard = false;                              // within the last five seconds
  double clock_ahead = 0.0;                        // [s] of its clock before ours
  double cpu_load = 0.0;                           // 0..1
  std::int64_t memory_total = 0, memory_free = 0;  // [bytes]
};

/// Says what each deputy should be running and watches what it does. Repeats all of it once a second, so that lost
/// messages and restarted deputies do not matter; takes over what already runs without touching it; yields to a sheriff
/// that started later, and takes command back when that one is gone.
///
///     Sheriff sheriff(*procman, read_pmd(file), {.id = make_sheriff_id(Instant::read())});
///     sheriff.listen_for_readiness(*data);
///     sheriff.start({});                       // everything
///     while (!sheriff.all_ready({})) { handle messages of both networks; sheriff.tick(Instant::read()); }
class Sheriff {
 public:
  /// `procman` is the network of the deputies. An empty configuration commands what the deputies were found running.
  Sheriff(lcm::LCM& procman, const PmdFile& file, const SheriffConfig& config);

  /// Without this, a process is ready when it has run for a second. The network may be the same one.
  void listen_for_readiness(lcm::LCM& data);

  // Orders. They go out with the next tick, and wait for deputies that are not heard yet. Throw ConfigurationError when
  // no command is meant.
  void start(const Target& target);
  void stop(const Target& target);
  void restart(const Target& target);
  /// Stops a command and makes its deputy forget it.
  void remove(const Target& target);

  /// To be called about twenty times a second, after the messages were handled.
  void tick(const Instant& now);

  /// All commands, those of the configuration first and in its order.
  [[nodiscard]] std::vector<CommandState> states() const { return states({}); }
  [[nodiscard]] std::vector<CommandState> states(const Target& target) const;
  [[nodiscard]] std::vector<DeputyState> deputies() const;
  /// Commands that strangers ordered and deputies refused.
  [[nodiscard]] const std::map<std::string, std::vector<std::string>>& refused_strangers() const { return refused_; }

  [[nodiscard]] bool all_ready(const Target& target) const;
  [[nodiscard]] bool all_stopped(const Target& target) const;
  [[nodiscard]] bool knows(const Target& target) const;
  /// True when every deputy that the target needs has been heard.
  [[nodiscard]] bool deputies_heard(const Target& target) const;
  /// True while a sheriff that started later is in command.
  [[nodiscard]] bool yielding() const;

  /// Sentences for a person: deputies come and go, clocks differ, another sheriff.
  void report_notices(std::function<void(const std::string&)> notice) { notice_ = std::move(notice); }
  /// What the commands print.
  using OutputHandler =
      std::function<void(const std::string& deputy, const std::string& command, const std::string& text)>;
  void report_output(OutputHandler output) { output_ = std::move(output); }
  [[nodiscard]] std::int64_t dropped() const { return procman_subscriber_.dropped(); }

 private:
  struct Deputy {
    std::int64_t heard = 0;        // [us] steady
    std::int64_t clock_ahead = 0;  // [us]
    std::int64_t ordered = 0;      // [us] steady
    bool orders_due = true;
    bool silent = false;
    std::optional<std::int64_t> clock_reported;             // [us] ahead, when a person was last told
    std::map<std::string, std::set<std::string>> heard_on;  // processes of its commands in NODE_STATUS, by host
    float cpu_load = 0.0F;
    std::int64_t memory_total = 0, memory_free = 0;
  };
  void on_info(const luminav_procman::procman_deputy_info_t& info);
  void on_orders(const luminav_procman::procman_orders_t& orders);
  void on_output(const luminav_procman::procman_output_t& output);
  void on_node_status(const node_status_t& status);

  void locate_commands();
  void discover();
  void watch_deputies();
  void check_clock(const std::string& id, Deputy& deputy);
  void send_orders(const std::string& id, Deputy& deputy);
  void forget_removed();
  [[nodiscard]] TrackedCommand* find(const std::string& deputy, const std::string& name);
  [[nodiscard]] bool is_meant(const TrackedCommand& command, const Target& target) const;
  [[nodiscard]] std::vector<TrackedCommand*> select(const Target& target);
  [[nodiscard]] bool is_heard(const std::string& deputy) const;
  void mark_due(const TrackedCommand& command);

  lcm::LCM& procman_;
  SheriffConfig config_;
  CommandPublisher orders_;
  Subscriber procman_subscriber_;
  std::unique_ptr<Subscriber> data_subscriber_;
  std::function<void(const std::string&)> notice_ = [](const std::string&) {};
  OutputHandler output_ = [](const std::string&, const std::string&, const std::string&) {};

  Instant now_;
  std::optional<std::int64_t> discovered_;  // [us] steady
  std::vector<std::unique_ptr<TrackedCommand>> commands_;
  std::map<std::string, Deputy> deputies_;
  std::map<std::string, std::vector<std::string>> refused_;  // by deputy
  std::string other_sheriff_;
  std::int64_t other_sheriff_heard_ = 0;  // [us] steady
};

}  // namespace luminav::launcher
