#pragma once

#include <filesystem>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <luminav_procman/procman_discovery_t.hpp>
#include <luminav_procman/procman_orders_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "services/common/process/subscriber.hpp"
#include "services/launcher/deputy/child_supervisor.hpp"
#include "services/launcher/deputy/deputy_journal.hpp"
#include "services/launcher/deputy/name_claim.hpp"
#include "services/launcher/deputy/processes/process_runner.hpp"
#include "services/launcher/deputy/sheriff_lease.hpp"
#include "services/launcher/instant.hpp"
#include "services/launcher/pmd_file.hpp"

namespace luminav::launcher {

struct DeputyConfig {
  std::string id = "localhost";
  std::vector<Command> allowed;      // of the deputy's own configuration; those of other deputies are skipped
  bool allow_any = false;            // run whatever anybody on the network orders
  std::filesystem::path log_folder;  // "" = no log files
  RespawnParams respawn;
  RotatingLogParams log;
  OutputPacerParams output;
  std::int64_t memory_limit = 0;  // [bytes] resident; a process that uses more is ended, 0 = none
  std::int64_t nonce = 1;         // tells two deputies of one name apart
  std::optional<CommandKey> key;  // orders without its seal are not obeyed
  Environment environment = [](const std::string&) { return std::nullopt; };
};

/// Starts, stops and watches the processes of one host by order of a sheriff, in procman's protocol: the orders hold
/// all that should run and the answers all that does, both once a second and at every change, so nothing lost matters
/// for long. Only commands of its own configuration are run (unless told otherwise), whoever orders.
class Deputy {
 public:
  Deputy(lcm::LCM& lcm, const DeputyConfig& config, ProcessRunner& runner);

  /// To be called about twenty times a second, and after every message and event of a child.
  void tick(const Instant& now);

  /// Says what is wrong when another deputy of this name is on the network (found in the first half second).
  [[nodiscard]] const std::optional<std::string>& conflict() const { return name_.conflict(); }

  /// Stops all children and obeys no more orders.
  void begin_shutdown();
  [[nodiscard]] bool all_stopped() const { return children_.all_stopped(); }

  /// What a person at the terminal should see; also sent on PM_OUTPUT and written to deputy.log.
  void report_notices(std::function<void(const std::string&)> notice) { journal_.report_notices(std::move(notice)); }
  [[nodiscard]] std::int64_t dropped() const { return subscriber_.dropped(); }

 private:
  void on_orders(const luminav_procman::procman_orders_t& orders);
  void on_discovery(const luminav_procman::procman_discovery_t& discovery);

  /// As it stands in the deputy's own configuration; null = not there, or with other words.
  [[nodiscard]] const Command* find_own(const luminav_procman::procman_command_t& command) const;
  void refuse(const luminav_procman::procman_command_desired_t& ordered, const std::string& sheriff_id);
  void stop_whatever_its_words(ManagedCommand& command, std::int32_t desired_runid);
  [[nodiscard]] ManagedCommand* list_refused(const luminav_procman::procman_command_t& ordered,
                                             const std::string& sheriff_id);
  void obey(const luminav_procman::procman_command_desired_t& ordered);
  [[nodiscard]] ManagedCommand* list_ordered(const std::string& id);
  void drop_missing(const luminav_procman::procman_orders_t& orders);

  void publish_info();
  void publish_output();

  lcm::LCM& lcm_;
  DeputyConfig config_;
  Instant now_;                   // of the last tick
  std::int64_t last_info_ = 0;    // [us] steady
  std::int64_t last_output_ = 0;  // [us] steady
  bool shutting_down_ = false;
  SheriffLease lease_;
  DeputyJournal journal_;
  ChildSupervisor children_;
  NameClaim name_;
  Subscriber subscriber_;
};

}  // namespace luminav::launcher
