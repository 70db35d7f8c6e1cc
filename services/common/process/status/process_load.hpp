#pragma once

#include <algorithm>
#include <cstdint>
#include <luminav/node_status_t.hpp>

#include "services/common/process/clock.hpp"

namespace luminav {

/// What this process takes of the machine, from one NODE_STATUS to the next.
class ProcessLoad {
 public:
  /// Runs a step, which nothing else of this process can interrupt.
  template <typename Step>
  void measure(const Step& step) {
    const std::int64_t start = read_clock(CLOCK_MONOTONIC);
    step();
    worst_step_ = std::max(worst_step_, read_clock(CLOCK_MONOTONIC) - start);
  }
  /// Says the longest step, the memory, and the share of the processor, and begins anew.
  void report(node_status_t& status);

 private:
  std::int64_t worst_step_ = 0;  // [us] since the last report
  std::int64_t last_cpu_ = 0;    // [us]
  std::int64_t last_share_ = 0;  // [us] monotonic
  double cpu_fraction_ = 0.0;
};

}  // namespace luminav
