#include "services/launcher/exit_status.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <cstring>

namespace luminav::launcher {

bool ended_well(std::int32_t status) {
  return status == 0;
}

bool ended_by_signal(std::int32_t status, int signal) {
  return WIFSIGNALED(status) && WTERMSIG(status) == signal;
}

std::string describe_exit(std::int32_t status) {
  if (status == kGaveUpStatus) {
    return "gave up restarting it";
  }
  if (status == kRefusedStatus) {
    return "refused";
  }
  if (WIFSIGNALED(status)) {
    const char* name = sigabbrev_np(WTERMSIG(status));
    return name != nullptr ? fmt::format("killed by SIG{}", name)
                           : fmt::format("killed by signal {}", WTERMSIG(status));
  }
  return fmt::format("exit {}", WEXITSTATUS(status));
}

}  // namespace luminav::launcher
