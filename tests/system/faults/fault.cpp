#include "tests/system/faults/fault.hpp"

#include <algorithm>

namespace luminav {
namespace {

using Targets = std::vector<const char*>;

const Targets& processes() {
  static const Targets kProcesses = {"p3dx", "camera", "detector", "localizer", "mapper", "planner", "controller"};
  return kProcesses;
}

enum class Stands { kAlways, kNever, kInChain };  // kInChain: where the target passes on what moves the robot

/// All that is to be known of a kind of fault before it is injected.
struct KindOfFault {
  FaultKind kind;
  const char* word;
  Stands stands;
  Targets targets;            // each is drawn; none: it comes by the scenario
  double shortest = 0.0;      // [s]
  double longest = shortest;  // [s]
  bool FaultMeans::*needs = nullptr;
};

const std::vector<KindOfFault>& kinds() {
  static const std::vector<KindOfFault> kKinds = {
      {FaultKind::kKill, "kill", Stands::kInChain, processes()},
      {FaultKind::kFreeze, "freeze", Stands::kInChain, processes(), 1.2, 4.0},
      {FaultKind::kRestart, "restart", Stands::kInChain, processes()},
      {FaultKind::kUnplug, "unplug", Stands::kInChain, {}},
      {FaultKind::kDeadSense, "sense:", Stands::kNever, {}},
      {FaultKind::kKillDeputy, "kill the deputy", Stands::kAlways, {""}},
      {FaultKind::kKillSheriff, "kill the sheriff", Stands::kNever, {""}},
      {FaultKind::kKillAll, "kill all processes", Stands::kAlways, {""}},
      {FaultKind::kKillGuardian, "kill the guardian of", Stands::kAlways, {"p3dx"}},
      {FaultKind::kKillViewer, "STOP, kill the viewer", Stands::kAlways, {""}, 2.0},
      {FaultKind::kStarve, "starve the processor", Stands::kNever, {""}, 5.0},
      {FaultKind::kKillLossy, "10 % loss, kill", Stands::kInChain, processes(), 1.0, 1.0, &FaultMeans::packet_loss},
      {FaultKind::kStrangers, "strangers on the wire", Stands::kNever, {""}, 6.0, 6.0, &FaultMeans::second_host},
      {FaultKind::kReadOnly,
       "read-only state, kill",
       Stands::kInChain,
       {"p3dx", "planner"},
       4.0,
       4.0,
       &FaultMeans::full_disk},
      {FaultKind::kDiskFull,
       "full disk, kill",
       Stands::kNever,
       {"planner", "mapper"},
       6.0,
       6.0,
       &FaultMeans::full_disk},
      {FaultKind::kLeak, "leak in", Stands::kNever, {"mapper", "detector"}, 20.0}};
  return kKinds;
}

const KindOfFault& kind_of(const Fault& fault) {
  return *std::find_if(kinds().begin(), kinds().end(),
                       [&](const KindOfFault& each) { return each.kind == fault.kind; });
}

}  // namespace

std::string to_string(const Fault& fault) {
  const std::string word = kind_of(fault).word;
  return fault.target.empty() ? word : word + " " + fault.target;
}

bool breaks_the_chain(const Fault& fault) {
  const Targets chain = {"p3dx", "localizer", "controller", "serial"};
  const Stands stands = kind_of(fault).stands;
  return stands == Stands::kAlways ||
         (stands == Stands::kInChain && std::find(chain.begin(), chain.end(), fault.target) != chain.end());
}

Fault FaultDeck::draw() {
  if (left_.empty()) {
    for (const KindOfFault& each : kinds()) {
      for (const char* target : each.targets) {
        if (each.needs == nullptr || means_.*each.needs) {
          std::uniform_real_distribution<double> duration(each.shortest, each.longest);
          left_.push_back({each.kind, target, duration(random_)});
        }
      }
    }
    std::shuffle(left_.begin(), left_.end(), random_);
  }
  const Fault fault = left_.back();
  left_.pop_back();
  return fault;
}

bool FaultResult::resumes_in_time() const {
  const double within = fault.kind == FaultKind::kKillLossy ? kResumeAmidLoss : kResumeWithin;
  return needs_no_resume || (resumed && *resumed <= within);
}

bool passed(const std::vector<FaultResult>& results, const GoalTally& goals) {
  return !results.empty() && goals.missed == 0 && goals.reached > 0 && goals.contacts_between_faults == 0 &&
         std::all_of(results.begin(), results.end(), [](const FaultResult& result) { return result.good(); });
}

}  // namespace luminav
