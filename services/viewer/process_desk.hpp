#pragma once

#include <cstdint>
#include <deque>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "services/launcher/instant.hpp"
#include "services/launcher/sheriff/script_run.hpp"
#include "services/launcher/sheriff/sheriff.hpp"
#include "services/viewer/request_text.hpp"

namespace luminav {

/// What runs on which machine, by the sheriff's protocol, and people's orders to start, stop and restart it. Only
/// watches, until somebody orders something: then a sheriff commands for as long as that takes, and hands back to the
/// one that commanded before. `order` may be called from any thread, the rest from the one that handles messages.
class ProcessDesk {
 public:
  /// `procman` is the network of the deputies, `data` the robot's.
  ProcessDesk(lcm::LCM& procman, lcm::LCM& data, std::optional<CommandKey> key = {});

  /// Takes an order and returns its id. Throws RequestError when no deputy was heard, or none runs that process.
  std::int64_t order(const ProcessOrder& order, std::int64_t now);
  /// To be called about twenty times a second, after the messages were handled.
  void tick(const launcher::Instant& now);

  /// {"deputies": [...], "commands": [...], "order": what became of the last one}.
  [[nodiscard]] std::string json() const;

 private:
  struct Pending {
    ProcessOrder order;
    std::int64_t id = 0;
  };
  /// An order in work: a sheriff of its own that commands until it is carried out.
  struct Work {
    Pending pending;
    std::unique_ptr<launcher::Sheriff> sheriff;
    std::optional<launcher::ScriptRun> run;
    std::int64_t begun = 0;  // [us] steady
  };
  struct Outcome {
    Pending pending;
    std::string fate;  // "waiting", "done" or "failed"
    std::string said;
  };
  void begin_next(const launcher::Instant& now);
  void go_on(const launcher::Instant& now);
  void finish(const std::string& fate, const std::string& said);

  lcm::LCM& procman_;
  lcm::LCM& data_;
  std::optional<CommandKey> key_;
  launcher::Sheriff watcher_;
  std::unique_ptr<Work> work_;
  std::optional<Outcome> outcome_;
  mutable std::mutex mutex_;  // of what follows
  std::vector<std::string> known_;
  std::deque<Pending> pending_;
  std::int64_t last_id_ = 0;
};

}  // namespace luminav
