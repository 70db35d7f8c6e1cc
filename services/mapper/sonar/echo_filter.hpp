#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace luminav {

struct EchoFilterParams {
  double memory = 1.5;     ///< [s] a second echo must come within
  double distance = 0.20;  ///< [m] and lie this close to the first
};

/// Lets an echo through when another one confirms it: from the same disc or a neighbour, a moment ago, at the same
/// place. Cross-talk and double reflections rarely come twice to one place.
class EchoFilter {
 public:
  EchoFilter(const EchoFilterParams& params, int discs);

  /// True if the echo at `point` [m, world], seen by a disc at a time [us] from `range` [m] away, was confirmed. It is
  /// remembered in any case.
  [[nodiscard]] bool confirm(int disc, std::int64_t utime, const Eigen::Vector2d& point, double range);
  void clear();

 private:
  struct Echo {
    std::int64_t utime = 0;
    Eigen::Vector2d point = Eigen::Vector2d::Zero();
    double range = 0.0;
  };
  static constexpr std::size_t kRemembered = 8;  // per disc: 2.5 s at 3.1 rounds a second
  EchoFilterParams params_;
  int discs_;
  std::vector<Echo> echoes_;  // kRemembered of each disc, a ring each
  std::vector<std::size_t> next_;
};

}  // namespace luminav
