#pragma once

#include <cstdint>
#include <luminav_procman/procman_command_desired_t.hpp>
#include <luminav_procman/procman_command_status_t.hpp>
#include <memory>
#include <optional>

#include "services/launcher/deputy/processes/process_runner.hpp"
#include "services/launcher/deputy/respawn_policy.hpp"
#include "services/launcher/deputy/rotating_log.hpp"

namespace luminav::launcher {

/// What an order asks a deputy to do about one command, by procman's rules for run ids.
enum class OrderStep { kStart, kStop, kNote };

/// Rule (a): stopped, another run than the last, and wanted: start. Rule (b): running and not wanted, or wanted anew:
/// stop step. Rule (c): nothing to do but to take over the run id, unless it is 0.
[[nodiscard]] inline OrderStep step_for(bool running, std::int32_t actual_runid, std::int32_t desired_runid,
                                        bool force_quit) {
  if (!running && actual_runid != desired_runid && !force_quit) {
    return OrderStep::kStart;
  }
  if (running && (force_quit || (desired_runid != actual_runid && desired_runid != 0))) {
    return OrderStep::kStop;
  }
  return OrderStep::kNote;
}

/// A command as a deputy knows it.
struct ManagedCommand {
  explicit ManagedCommand(const RespawnParams& params) : respawn(params) {}

  luminav_procman::procman_command_t command{};
  std::int32_t desired_runid = 0;
  std::int32_t actual_runid = 0;
  bool should_run = false;
  bool removing = false;  // missing from the orders: forgotten once it is dead
  bool refused = false;   // does not stand in the deputy's configuration

  int pid = 0;                            // 0 = stopped
  int exit_code = 0;                      // raw wait status
  std::int64_t started = 0;               // [us] steady
  std::optional<std::int64_t> stop_sent;  // [us] steady, of the first stop signal
  bool kill_sent = false;
  bool too_big = false;                    // being ended because of the memory it uses
  std::optional<std::int64_t> respawn_at;  // [us] steady
  RespawnPolicy respawn;

  ProcessUsage usage;
  float cpu_usage = 0.0F;  // 0..1 of the whole machine
  std::unique_ptr<RotatingLog> log;

  [[nodiscard]] bool running() const { return pid != 0; }
  [[nodiscard]] luminav_procman::procman_command_status_t status() const;
};

}  // namespace luminav::launcher
