#include "services/launcher/deputy/managed_command.hpp"

namespace luminav::launcher {

luminav_procman::procman_command_status_t ManagedCommand::status() const {
  luminav_procman::procman_command_status_t status{};
  status.cmd = command;
  status.pid = pid;
  status.actual_runid = actual_runid;
  status.exit_code = exit_code;
  status.cpu_usage = running() ? cpu_usage : 0.0F;
  status.mem_vsize_bytes = running() ? usage.virtual_bytes : 0;
  status.mem_rss_bytes = running() ? usage.resident_bytes : 0;
  return status;
}

}  // namespace luminav::launcher
