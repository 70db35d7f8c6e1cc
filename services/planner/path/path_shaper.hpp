#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "services/planner/path/path_shaping.hpp"

namespace luminav {

/// Shapes one chain of cells after another, and keeps what it can use again. A long chain is cut into sections, counted
/// from its end, each shaped by itself and then once more where two meet. So far from a change, and from the robot, the
/// points of a path stay as they were to the last bit, and cost nothing.
class PathShaper {
 public:
  static constexpr double kSection = 40.0;               // [m] along the chain, were all its steps straight ones
  static constexpr double kLongestWhole = 3 * kSection;  // [m] what is shorter is shaped as a whole

  explicit PathShaper(const PathShapingParams& params) : params_(params) {}

  /// As `shape_path` does. What is kept must be of this space: see `forget`.
  Polyline shape(const ConfigurationSpace& space, const Polyline& chain);
  /// The space has changed in a window of its cells.
  void forget(const GridGeometry& geometry, const CellWindow& window);
  /// It is another space.
  void forget() { kept_.clear(); }

  /// Pieces of the last long chain that are kept.
  [[nodiscard]] std::size_t kept() const { return kept_.size(); }

 private:
  struct Kept {
    Polyline chain;
    Polyline shaped;
    bool is_used = false;  // of the path that is being shaped
  };
  [[nodiscard]] Polyline shape_piece(const ConfigurationSpace& space, Polyline chain);
  /// Goes on with the next section, and shapes what lies about the point where it begins.
  void append(const ConfigurationSpace& space, const Polyline& section, Polyline& path);

  PathShapingParams params_;
  std::vector<Kept> kept_;
};

}  // namespace luminav
