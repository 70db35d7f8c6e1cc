#pragma once

#include <cstdint>
#include <optional>

namespace luminav::launcher {

struct RespawnParams {
  double first_delay = 0.05;    // [s] after the first death; doubles with each death in a row
  double longest_delay = 5.0;   // [s]
  double settled_after = 10.0;  // [s] a process that lived this long has recovered: the row ends
  int limit = 8;                // restarts in a row; after one death more it stays stopped until it is ordered to start
};

/// Decides when a process that died by itself runs again: soon after a first crash, later and later in a crash loop,
/// and in the end not at all.
class RespawnPolicy {
 public:
  /// Throws std::invalid_argument for parameters that make no sense.
  explicit RespawnPolicy(const RespawnParams& params);

  /// Delay [us] before the next start of a process that lived for `lived` [us]; nothing when the limit is reached.
  [[nodiscard]] std::optional<std::int64_t> delay_after(std::int64_t lived);
  /// A start by order: the row of deaths begins anew.
  void reset() { deaths_ = 0; }
  [[nodiscard]] int deaths_in_a_row() const { return deaths_; }

 private:
  RespawnParams params_;
  int deaths_ = 0;
};

}  // namespace luminav::launcher
