#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <utility>
#include <vector>

namespace luminav {

/// How often the robot set out for which floor. It keeps to the world, whatever grid that is drawn on.
class TriedFloor {
 public:
  /// A goal came to an end, good or bad, that was for the floor around some points [m, world].
  void add(const std::vector<Eigen::Vector2d>& points);
  [[nodiscard]] int tries(const Eigen::Vector2d& point) const;

 private:
  friend TriedFloor read_tried_floor(const std::filesystem::path& file);
  friend void write_tried_floor(const std::filesystem::path& file, const TriedFloor& tried);

  std::map<std::pair<long, long>, int> tries_;  // by cell
};

/// What a run before kept; nothing where there is no file, and as much as is whole of one that was damaged.
TriedFloor read_tried_floor(const std::filesystem::path& file);
/// A line for each cell: column, row, how often. Throws std::runtime_error where it cannot be written.
void write_tried_floor(const std::filesystem::path& file, const TriedFloor& tried);

}  // namespace luminav
