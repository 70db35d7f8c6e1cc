#pragma once

#include <cstdint>
#include <optional>

#include "services/planner/goals/issued_path.hpp"

namespace luminav {

/// Where the building's map has the robot walled in, the pose is wrong rather than the goal out of reach: the robot
/// stands still, since somebody may be carrying it, then looks round. Every doubt ends in bounded time.
class DoubtfulStart {
 public:
  static constexpr double kTime = 25.0;  // [s] before the goal is refused

  /// `max_doubts` on the way to a stop.
  explicit DoubtfulStart(int max_doubts) : max_doubts_(max_doubts) {}

  /// A new stop.
  void reset() { doubts_ = 0; }
  /// False if it has doubted too often.
  [[nodiscard]] bool begin(std::int64_t now);
  /// The robot may not move: its time begins anew. Also when the clock does.
  void begin_anew(std::int64_t now);
  /// A turn on the spot, when it is time for one.
  [[nodiscard]] std::optional<PathOrder> look_round(const Pose2& world_from_robot, std::int64_t now);
  [[nodiscard]] bool is_over(std::int64_t now) const;

 private:
  int max_doubts_;
  int doubts_ = 0;
  std::int64_t since_ = 0;  // [us]
  int turns_ = 0;           // thirds of a turn, in this doubt
};

}  // namespace luminav
