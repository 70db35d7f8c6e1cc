#include "tests/system/faults/fault.hpp"

#include <algorithm>

namespace luminav {
namespace {

constexpr const char* kProcesses[] = {"p3dx", "camera", "detector", "localizer", "mapper", "planner", "controller"};

const char* word(FaultKind kind) {
  switch (kind) {
    case FaultKind::kKill:
      return "kill";
    case FaultKind::kFreeze:
      return "freeze";
    case FaultKind::kRestart:
      return "restart";
    case FaultKind::kUnplug:
      return "unplug";
    case FaultKind::kDeadSense:
      return "sense:";
    case FaultKind::kKillDeputy:
      return "kill the deputy";
    case FaultKind::kKillSheriff:
      return "kill the sheriff";
    case FaultKind::kKillAll:
      return "kill all processes";
    case FaultKind::kDiskFull:
      return "full disk, kill";
    case FaultKind::kKillGuardian:
      return "kill the guardian of";
    case FaultKind::kKillLossy:
      return "10 % loss, kill";
    case FaultKind::kKillViewer:
      return "STOP, kill the viewer";
    case FaultKind::kStarve:
      return "starve the processor";
    case FaultKind::kReadOnly:
      return "read-only state, kill";
    default:
      return "leak in";
  }
}

}  // namespace

std::string to_string(const Fault& fault) {
  return fault.target.empty() ? word(fault.kind) : std::string(word(fault.kind)) + " " + fault.target;
}

bool breaks_the_chain(const Fault& fault) {
  const bool in_chain = fault.target == "p3dx" || fault.target == "localizer" || fault.target == "controller";
  switch (fault.kind) {
    case FaultKind::kKill:
    case FaultKind::kFreeze:
    case FaultKind::kRestart:
    case FaultKind::kKillLossy:
    case FaultKind::kReadOnly:
      return in_chain;
    case FaultKind::kUnplug:
      return fault.target == "serial";
    case FaultKind::kKillDeputy:
    case FaultKind::kKillAll:
    case FaultKind::kKillGuardian:
    case FaultKind::kKillViewer:
      return true;
    default:
      return false;
  }
}

Fault FaultDeck::draw() {
  if (left_.empty()) {
    std::uniform_real_distribution<double> freeze(1.2, 4.0);
    for (const char* process : kProcesses) {
      left_.push_back({FaultKind::kKill, process, 0.0});
      left_.push_back({FaultKind::kFreeze, process, freeze(random_)});
      left_.push_back({FaultKind::kRestart, process, 0.0});
    }
    left_.push_back({FaultKind::kKillDeputy, "", 0.0});
    left_.push_back({FaultKind::kKillSheriff, "", 0.0});
    left_.push_back({FaultKind::kKillAll, "", 0.0});
    left_.push_back({FaultKind::kKillGuardian, "p3dx", 0.0});
    left_.push_back({FaultKind::kKillViewer, "", 2.0});
    left_.push_back({FaultKind::kStarve, "", 5.0});
    if (means_.packet_loss) {
      for (const char* process : kProcesses) {
        left_.push_back({FaultKind::kKillLossy, process, 1.0});
      }
    }
    if (means_.full_disk) {
      left_.push_back({FaultKind::kReadOnly, "p3dx", 4.0});
      left_.push_back({FaultKind::kReadOnly, "planner", 4.0});
      left_.push_back({FaultKind::kDiskFull, "planner", 6.0});
      left_.push_back({FaultKind::kDiskFull, "mapper", 6.0});
    }
    left_.push_back({FaultKind::kLeak, "mapper", 20.0});
    left_.push_back({FaultKind::kLeak, "detector", 20.0});
    std::shuffle(left_.begin(), left_.end(), random_);
  }
  const Fault fault = left_.back();
  left_.pop_back();
  return fault;
}

bool FaultResult::resumes_in_time() const {
  return needs_no_resume || (resumed && *resumed <= kResumeWithin);
}

bool passed(const std::vector<FaultResult>& results, const GoalTally& goals) {
  return !results.empty() && goals.missed == 0 && goals.reached > 0 && goals.contacts_between_faults == 0 &&
         std::all_of(results.begin(), results.end(), [](const FaultResult& result) { return result.good(); });
}

}  // namespace luminav
