#pragma once

#include <poll.h>

#include <cstdint>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <luminav/node_status_t.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/common/network/lcm_network.hpp"
#include "services/common/process/role_watch.hpp"
#include "services/common/process/running_system.hpp"
#include "services/common/process/status/given_files.hpp"
#include "services/common/process/status/process_identity.hpp"
#include "services/common/process/status/process_load.hpp"
#include "services/common/process/subscriber.hpp"

namespace luminav {

/// Opens an LCM network with a receive buffer large enough for images, shut against strangers as
/// receive_from_peers_only says. Throws std::runtime_error with one sentence that says what to do, for instance when no
/// route for multicast exists.
std::unique_ptr<lcm::LCM> open_lcm(const LcmNetwork& network);

/// Makes memory run out at so many megabytes: what is damaged or hostile is then dropped like any other message instead
/// of filling the machine. Sanitizers need more and get it.
void limit_memory(std::size_t megabytes);

/// What a process says of itself in NODE_STATUS.
struct Health {
  bool degraded = false;
  bool fault = false;
  std::string reason;
  std::int64_t dropped_inputs = 0;
};

/// Runs a process: one poll waits on LCM, on devices and on timers; handlers run one after another on this thread.
/// Limits the memory of the process, see limit_memory: to 512 MB. Publishes NODE_STATUS when it starts to run, when its
/// state changes and at 1 Hz. SIGINT and SIGTERM end it.
class EventLoop {
 public:
  /// `network`: where `lcm` is open, to join it again should its interface go and come.
  EventLoop(lcm::LCM& lcm, std::string process, std::string robot, LcmNetwork network = "memq://");
  ~EventLoop();
  EventLoop(const EventLoop&) = delete;
  EventLoop& operator=(const EventLoop&) = delete;

  /// Calls back when a descriptor can be read or has an error; the descriptor may change between calls (-1 = none).
  void watch(std::function<int()> descriptor, std::function<void()> on_readable);
  /// Calls back with a period [us]; periods that were missed are skipped.
  /// Up to `slack` [us] early when the process is awake anyway: each waking costs more than most callbacks.
  void every(std::int64_t period, std::function<void()> callback, std::int64_t slack = 0);
  /// Calls back when `left` [us] is no more than 0. It is asked before each wait, nothing = not now; the callback has
  /// to change the answer.
  void when_due(std::function<std::optional<std::int64_t>()> left, std::function<void()> callback);
  void report_health(std::function<Health()> health) { health_ = std::move(health); }
  /// Says in NODE_STATUS which robot's file this process was given, and is at fault as long as another process was
  /// given another. Throws ConfigurationError or std::runtime_error.
  void belong_to(const std::filesystem::path& robot_file);
  /// The same of the building that this file says, now and after its zones or places were changed: when NODE_STATUS of
  /// another process has the sum of a newer file, which must be this one. Calls back with it, at once and after each
  /// change. "" = no building. Throws ConfigurationError or std::runtime_error.
  void follow_building(const std::filesystem::path& file, std::function<void(const Building&)> take = {});
  /// This process has changed the file: takes it over, and says so to all.
  void building_has_changed();
  /// Which process has other files, in one sentence; "" = none.
  [[nodiscard]] std::string objection() const;
  /// Looks at the health now, and says so at once if the state is another: else it takes up to 50 ms.
  void check_health();

  /// Runs until SIGINT, SIGTERM or stop(); returns 0, or 1 when LCM failed.
  int run();
  void stop() { stopping_ = true; }
  /// "two controllers on this network: desk, robot": why the robot should stand, of whatever role; "" when all is well.
  [[nodiscard]] std::string conflict() const;

 private:
  struct Watch {
    std::function<int()> descriptor;
    std::function<void()> on_readable;
  };
  struct Timer {
    std::int64_t period;  // [us]
    std::int64_t due;     // [us] monotonic
    std::function<void()> callback;
    std::int64_t slack;  // [us]
  };
  struct Deadline {
    std::function<std::optional<std::int64_t>()> left;  // [us]
    std::function<void()> callback;
  };
  void run_due_timers();
  [[nodiscard]] std::int64_t microseconds_to_next_timer() const;
  void wait_for_descriptors();
  [[nodiscard]] Health current_health() const;
  void on_node_status(const node_status_t& status);
  void listen_to_itself();
  [[nodiscard]] bool is_deaf() const;
  void publish_status();

  lcm::LCM& lcm_;
  LcmNetwork network_;
  ProcessIdentity self_;
  std::vector<Watch> watches_;
  std::vector<pollfd> descriptors_;  // LCM, signals, then the watches
  std::vector<Timer> timers_;
  std::vector<Deadline> deadlines_;
  std::function<Health()> health_;
  GivenFiles given_;
  RunningSystem others_;
  ProcessLoad load_;
  std::int8_t published_state_ = -1;  // none yet
  bool stopping_ = false;
  RoleWatch roles_;
  std::int64_t heard_itself_ = 0;  // [us] monotonic
  Subscriber subscriber_;          // last: no handler may run on a half-built loop
};

}  // namespace luminav
