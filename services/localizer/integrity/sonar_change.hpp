#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "services/common/geometry/pose2.hpp"
#include "services/localizer/model/fixture_sighting.hpp"

namespace luminav {

/// Watches by the sonars whether somebody carries a robot whose wheels stand still: then all that it hears moves, on
/// all sides, where people who pass move a few echoes at a time.
class SonarChange {
 public:
  /// True when since the wheels stand still, some seconds ago at most, most discs have come to hear things elsewhere.
  /// It begins anew then.
  [[nodiscard]] bool look(const SonarScan& scan, const Pose2& odom_from_robot);

 private:
  /// What a disc heard first and last.
  struct Disc {
    std::optional<SonarEcho> first;
    std::optional<SonarEcho> last;
  };

  void begin(std::int64_t utime);
  [[nodiscard]] bool has_moved() const;

  Pose2 odom_from_robot_;
  int still_scans_ = 0;     // in a row without wheel motion
  std::int64_t begun_ = 0;  // [us]
  std::vector<Disc> discs_;
};

}  // namespace luminav
