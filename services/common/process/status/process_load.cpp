#include "services/common/process/status/process_load.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

namespace luminav {
namespace {

constexpr std::int64_t kShortestShare = 500'000;  // [us] over which a share of the processor says something

std::int64_t cpu_used() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return (usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) * 1'000'000 + usage.ru_utime.tv_usec + usage.ru_stime.tv_usec;
}

std::int64_t memory_resident() {
  std::int64_t total = 0;
  std::int64_t resident = 0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}

}  // namespace

void ProcessLoad::report(node_status_t& status) {
  const std::int64_t now = read_clock(CLOCK_MONOTONIC);
  const std::int64_t cpu = cpu_used();
  const std::int64_t interval = now - last_share_;
  if (last_share_ == 0 || interval > kShortestShare) {
    cpu_fraction_ = last_share_ == 0 ? 0.0 : static_cast<double>(cpu - last_cpu_) / static_cast<double>(interval);
    last_cpu_ = cpu;
    last_share_ = now;
  }
  status.cpu_fraction = cpu_fraction_;
  status.memory_bytes = memory_resident();
  status.worst_step_us = static_cast<std::int32_t>(std::min<std::int64_t>(worst_step_, 2'000'000'000));
  worst_step_ = 0;
}

}  // namespace luminav
