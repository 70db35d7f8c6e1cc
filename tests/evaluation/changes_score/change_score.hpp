#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/caretaker/ceiling_changes.hpp"

namespace luminav {

/// A difference between the building that the robot is told and the one that it drives in.
struct TrueChange {
  CeilingChange change;  // as it ought to be proposed
  int passes = 0;        // visits until it was proposed first; all of them where it never was
  bool was_proposed = false;
  bool is_proposed = false;  // now
  double offset = 0.0;       // [m] of the place that was proposed last from the true one
};

/// What `propose_changes` says beside the truth, visit after visit.
class ChangeScore {
 public:
  /// Both files share one frame; a fixture keeps its id.
  ChangeScore(Building told, const Building& truth);

  /// Looks at the proposals after a visit.
  void look(const LampLedger& ledger);

  [[nodiscard]] const std::vector<TrueChange>& changes() const { return changes_; }
  /// Proposals, as sentences, that the truth does not bear out: each once, also if it was taken back.
  [[nodiscard]] const std::vector<std::string>& false_proposals() const { return false_; }
  [[nodiscard]] std::string to_json() const;

 private:
  Building told_;
  std::vector<TrueChange> changes_;
  std::vector<CeilingChange> wrong_;
  std::vector<std::string> false_;
};

}  // namespace luminav
