#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <queue>
#include <utility>
#include <vector>

namespace luminav {

/// Shortest paths from the robot over a square lattice of places around it: Dijkstra, one place at a time, so that
/// the caller may stop. The lattice stands still in its frame while the robot moves.
class PathLattice {
 public:
  struct Visit {
    int node = 0;
    double distance = 0.0;  // [m] as priced
  };

  /// Around `place`, as far as `reach` along both axes, every `step` [m].
  PathLattice(const Eigen::Vector2d& place, double reach, double step);

  /// The nearest place not yet returned; nothing when all that can be reached was.
  [[nodiscard]] std::optional<Visit> next();
  /// Goes on from a place to its neighbours. `price` says what a metre counts for at a place, infinite = blocked; it is
  /// asked once for each.
  void expand(const Visit& visit, const std::function<double(const Eigen::Vector2d&)>& price);

  [[nodiscard]] Eigen::Vector2d place_of(int node) const;
  /// From the robot on, without where it stands.
  [[nodiscard]] std::vector<Eigen::Vector2d> path_to(int node) const;

 private:
  struct IsFarther {
    bool operator()(const Visit& a, const Visit& b) const {
      return a.distance != b.distance ? a.distance > b.distance : a.node > b.node;
    }
  };
  double step_;  // [m]
  int columns_;
  int start_;
  Eigen::Vector2d corner_;  // [m]
  std::vector<double> distance_;
  std::vector<double> price_;  // negative = not yet asked
  std::vector<int> from_;
  std::priority_queue<Visit, std::vector<Visit>, IsFarther> open_;
};

}  // namespace luminav
