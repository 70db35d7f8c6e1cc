#include "services/common/process/urgency.hpp"

#include <sched.h>

#include <fstream>

namespace luminav {

void claim_urgency() {
  sched_param priority{};
  priority.sched_priority = 10;  // of 1 to 99; interrupts of the kernel have 50
  [[maybe_unused]] const int status = sched_setscheduler(0, SCHED_FIFO, &priority);
  std::ofstream("/proc/self/oom_score_adj") << -900;  // -1000: not even when it is the one that leaks
}

}  // namespace luminav
