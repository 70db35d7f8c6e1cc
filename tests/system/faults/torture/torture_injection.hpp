#pragma once

#include <sys/types.h>
#include <cstdint>

#include <string>
#include <vector>

#include "tests/system/faults/fault.hpp"
#include "tests/system/faults/fleet.hpp"

namespace luminav {

class TortureRound;

/// Processes that a fault hits, as they were before.
struct Victims {
  std::vector<std::string> names;
  std::vector<pid_t> pids;
};

/// Does what goes wrong in a round, one function per kind of fault, and waits until it is over.
class FaultInjection {
 public:
  explicit FaultInjection(TortureRound& round) : round_(round) {}
  void inject(FaultResult& result);

 private:
  void kill_victims(FaultResult& result);
  void kill_amid_loss(FaultResult& result);
  void kill_read_only(FaultResult& result);
  void kill_on_full_disk(FaultResult& result);
  void kill_guardian(FaultResult& result);
  void kill_deputy(FaultResult& result);
  void kill_sheriff(FaultResult& result);
  void kill_viewer(FaultResult& result);
  void freeze(FaultResult& result);
  void restart(FaultResult& result);
  void leak(FaultResult& result);
  void starve(FaultResult& result);
  void besiege(FaultResult& result);

  [[nodiscard]] Victims victims_of(const Fault& fault) const;
  void await_return(FaultResult& result, const Victims& victims);
  void release_stop();
  static void violate(FaultResult& result, const std::string& how);
  [[nodiscard]] Fleet& fleet() const;
  [[nodiscard]] std::int64_t now() const;

  TortureRound& round_;
};

}  // namespace luminav
