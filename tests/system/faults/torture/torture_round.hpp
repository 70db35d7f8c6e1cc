#pragma once

#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "services/common/configuration/robot_file.hpp"
#include "tests/evaluation/runs/mission.hpp"
#include "tests/system/faults/fault.hpp"
#include "tests/system/faults/fleet.hpp"
#include "tests/system/faults/hosts/network_host.hpp"
#include "tests/system/faults/robot_watch.hpp"
#include "tests/system/faults/torture/torture_injection.hpp"
#include "tests/system/faults/truth_watch.hpp"

namespace luminav {

struct RoundPlan {
  int number = 1;
  std::uint64_t seed = 1;
  double minutes = 5.0;
  bool pty = false;
  std::string only;  // only faults whose name holds this
  FaultMeans means;  // full_disk: the robot's state lies on a small file system, which can be filled
  const Neighbour* neighbour = nullptr;  // where strangers speak from
  std::filesystem::path folder;
};

/// One start of the whole system in a world of its own, that is driven and broken until its time is over.
class TortureRound {
 public:
  /// Writes the scenario and, where the plan has one, makes the small file system of the robot's state. Throws
  /// std::runtime_error when it cannot be mounted.
  explicit TortureRound(const RoundPlan& plan);
  ~TortureRound();

  /// Throws std::runtime_error when the system does not even start.
  void run(FaultDeck& deck, std::vector<FaultResult>& results, GoalTally& goals);

 private:
  friend class FaultInjection;

  /// The next fault with a name that was asked for; nothing where only the world's own were.
  [[nodiscard]] std::optional<Fault> draw(FaultDeck& deck) const;
  /// Waits until it drives well, and until a fault of the world or the time for this one has come; false: time is over.
  bool wait_for(const std::optional<Fault>& next);
  /// What has gone wrong and how that went; takes the next fault unless the world's own came first.
  FaultResult break_something(std::optional<Fault>& next);
  FaultResult begin(const Fault& fault);
  /// False where its process has died so often that its deputy would take it for a crash loop.
  [[nodiscard]] bool is_settled(const std::string& process) const;
  void judge_unplug(FaultResult& result);
  /// Waits until a process names the sense that died, and the robot stands where it has to; then until it is well
  /// again.
  void judge_dead_sense(FaultResult& result, const ScenarioEvent& event);
  void judge_standing(FaultResult& result);
  void settle(FaultResult& result, std::int64_t back);
  [[nodiscard]] std::optional<std::int64_t> ready_after(const Victims& victims) const;
  [[nodiscard]] bool time_is_over() const;
  [[nodiscard]] bool unplugged() const;
  /// The event of a sense that is dead now.
  [[nodiscard]] const ScenarioEvent* dead_sense() const;
  /// [s] since the simulator began.
  [[nodiscard]] double simulated_time() const;
  void request_motors();
  /// How fast it is, and so how long it may take to stand.
  void measure_speed(FaultResult& result) const;
  void print(const FaultResult& result) const;
  void count_goals(GoalTally& goals) const;

  RoundPlan plan_;
  Scenario scenario_;
  std::mt19937_64 random_;
  std::unique_ptr<Fleet> fleet_;
  std::unique_ptr<TruthWatch> truth_;
  std::unique_ptr<RobotWatch> robot_;
  std::unique_ptr<Mission> mission_;
  MotionLimits limits_;
  std::int64_t fault_at_ = 0;  // [us]
  int contacts_seen_ = 0;
};

/// True when a small file system can be mounted on a folder below this one.
bool can_mount_small_disk(const std::filesystem::path& folder);

}  // namespace luminav
