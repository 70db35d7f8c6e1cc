#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace luminav {

enum class FaultKind {
  kKill,
  kFreeze,
  kRestart,
  kUnplug,
  kDeadSense,
  kKillDeputy,
  kKillSheriff,
  kKillAll,
  kDiskFull,
  kLeak,
  kKillGuardian,  // of the driver, alone
  kKillLossy,     // with a tenth of all messages lost before, meanwhile and after
  kKillViewer,    // right after it was told to stop the robot
  kStarve,        // two busy loops per core
  kReadOnly,      // the state's folder
  kStrangers      // another machine on the wire says everything it can, then floods
};

/// Something that goes wrong while the robot drives.
struct Fault {
  FaultKind kind = FaultKind::kKill;
  std::string target;     // process, device or what happens to a sense; "" where the kind says all
  double duration = 0.0;  // [s] that it lasts; a leak at most
};

/// "kill controller", as a table shows it.
std::string to_string(const Fault& fault);

/// True when the robot gets no more commands that are worth executing while the fault lasts: it has to stand.
bool breaks_the_chain(const Fault& fault);

/// What this machine lets a test do.
struct FaultMeans {
  bool full_disk = false;    // there is a small file system of its own to be filled, or made read-only
  bool packet_loss = false;  // there is a network of its own
  bool second_host = false;  // and another machine can be put on its wire
};

/// Draws faults so that each comes up once before any comes up again.
class FaultDeck {
 public:
  FaultDeck(std::uint64_t seed, const FaultMeans& means) : random_(seed), means_(means) {}
  Fault draw();

 private:
  std::mt19937_64 random_;
  FaultMeans means_;
  std::vector<Fault> left_;
};

/// How one fault went, by the simulator's truth.
struct FaultResult {
  Fault fault;
  int round = 0;
  double at = 0.0;                     // [s] since the round began
  double linear = 0.0, angular = 0.0;  // [m/s], [rad/s] when it happened
  double bound = 0.0;                  // [s] within which the robot has to stand
  bool must_stand = false;
  std::optional<double> said;     // [s] after the fault a process named it, for a sense that died
  double say_bound = 0.0;         // [s] within which one has to; 0 = none
  double way = 0.0;               // [m] driven since, until it stood or the sense came back
  double way_bound = 0.0;         // [m] at most; 0 = any
  std::string sentence;           // what that process said
  std::optional<double> stood;    // [s] after the fault
  std::optional<double> bridged;  // [s] after the fault commands came again, in time
  std::optional<double> back;     // [s] after the fault the process was ready again
  std::optional<double> resumed;  // [s] after that the robot moved again
  bool needs_no_resume = false;   // it never stood, or had a reason in the world to wait
  int contacts = 0;
  int blind_contacts = 0;  // of these, while the robot's own line was cut and its watchdog had not yet stopped it
  double truth_gap = 0.0;  // [s] longest time without truth: how well the machine kept up
  bool violated = false;   // something else that this fault promises did not hold; the remark says what
  std::string remark;

  [[nodiscard]] bool stands_in_time() const { return !must_stand || bridged || (stood && *stood <= bound); }
  [[nodiscard]] bool resumes_in_time() const;
  [[nodiscard]] bool is_said_in_time() const { return say_bound == 0.0 || (said && *said <= say_bound); }
  [[nodiscard]] bool good() const {
    return contacts == 0 && !violated && stands_in_time() && resumes_in_time() && is_said_in_time() &&
           (way_bound == 0.0 || way <= way_bound);
  }
};

inline constexpr double kResumeWithin = 3.0;    // [s]
inline constexpr double kResumeAmidLoss = 8.0;  // [s] a planner asks every two seconds for tiles that were lost

/// What became of all goals.
struct GoalTally {
  int reached = 0;
  int missed = 0;
  int contacts_between_faults = 0;
  std::vector<std::string> causes;
};

/// A line per kind of fault, and what was wrong; JSON of all of them.
std::string to_table(const std::vector<FaultResult>& results, const GoalTally& goals);
std::string to_json(const std::vector<FaultResult>& results, const GoalTally& goals, std::uint64_t seed,
                    double minutes);
/// Something went wrong on purpose, every time well, and every goal was reached.
bool passed(const std::vector<FaultResult>& results, const GoalTally& goals);

}  // namespace luminav
