#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace luminav {

/// Places, and which lead to which in a straight line.
struct WalkGround {
  std::vector<Eigen::Vector2d> points;                // [m]
  std::vector<std::vector<std::int32_t>> neighbours;  // by place

  [[nodiscard]] double step(std::int32_t from, std::int32_t to) const {
    return (points[static_cast<std::size_t>(to)] - points[static_cast<std::size_t>(from)]).norm();
  }
};

/// Shortest paths from where it begins (Dijkstra 1959) over those that its user lets it through. The next search uses
/// its memory again.
class GroundSearch {
 public:
  /// The ground must outlive it.
  explicit GroundSearch(const WalkGround& ground);

  void begin(const std::vector<std::int32_t>& from);
  /// The nearest place not given yet; nothing when all that can be reached were.
  [[nodiscard]] std::optional<std::int32_t> next();
  /// Paths may lead through a place that was given.
  void pass(std::int32_t place);
  /// Length [m] of the path to a place that was given.
  [[nodiscard]] double distance(std::int32_t place) const { return reached_[static_cast<std::size_t>(place)].distance; }
  /// All places that were given or come next to one that was passed.
  [[nodiscard]] const std::vector<std::int32_t>& touched() const { return touched_; }
  /// Appends the path to a place that was given, without the place where it begins.
  void append_path(std::int32_t to, std::vector<std::int32_t>& path) const;

 private:
  struct Reached {
    double distance = -1.0;  // [m] negative: not reached
    std::int32_t from = -1;
  };
  void reach(std::int32_t place, double distance, std::int32_t from);

  const WalkGround& ground_;
  std::vector<Reached> reached_;  // by place
  std::vector<std::int32_t> touched_;
  std::vector<std::pair<double, std::int32_t>> queue_;  // heap: nearest first
};

}  // namespace luminav
