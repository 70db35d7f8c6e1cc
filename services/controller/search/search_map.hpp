#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "services/common/configuration/robot_file.hpp"
#include "services/controller/safety/echo_memory.hpp"

namespace luminav {

/// What the sonars say of a place.
enum class Ground { kUnknown, kFree, kStands };

/// A coarse map of the surroundings by sonar, in the odometry frame, and of where the robot has been. It gives the path
/// to the nearest free ground that the robot has not been near: through a room, out by its door and on.
class SearchMap {
 public:
  static constexpr std::int8_t kShutFor = 6;  ///< fadings after which what was shut may be tried again

  explicit SearchMap(const SonarRing& ring);

  void clear();
  /// Takes up what was not taken up before of each disc's newest firing.
  void add(std::span<const SonarFiring> newest);
  /// The robot is there [m, odom].
  void visit(const Eigen::Vector2d& place);
  /// Trusts what echoes drew a little less, until they are heard again: odometry drifts, and a wall that is entered
  /// twice closes the doors beside it. What was shut is forgotten after some of these.
  void fade();
  /// A place could not be reached: it is new ground no more.
  void block(const Eigen::Vector2d& place);
  /// No path led through a place, whatever the sonars say of it: for a while it counts as occupied.
  void shut(const Eigen::Vector2d& place);
  /// Path to the nearest new ground [m, odom], from the robot on; nothing if all that can be reached is known.
  [[nodiscard]] std::optional<std::vector<Eigen::Vector2d>> path_to_new_ground(const Eigen::Vector2d& place) const;

  /// It has been near [m, odom], or knows that it cannot go there.
  [[nodiscard]] bool is_near_trail(const Eigen::Vector2d& place) const;
  /// True where no path led through, see `shut`.
  [[nodiscard]] bool is_shut(const Eigen::Vector2d& place) const;
  [[nodiscard]] Ground ground_at(const Eigen::Vector2d& place) const;
  /// Something stands within `radius` [m] of a place; outside of the map nothing does.
  [[nodiscard]] bool stands_within(const Eigen::Vector2d& place, double radius) const;

 private:
  struct Cell {
    std::int8_t occupied = 0;  // > 0: something stands there; < 0: free
    std::int8_t heard = 0;     // direction [1/256 turn] of the last ray that ended there
    std::int8_t shut = 0;      // fadings for which no path leads through
    bool is_seen = false;
  };
  [[nodiscard]] int index_of(const Eigen::Vector2d& place) const;
  [[nodiscard]] Eigen::Vector2d centre_of(int index) const;
  /// Moves the square until its middle is near a place; what stays inside is kept.
  void go_along(const Eigen::Vector2d& place);
  void add(const SonarFiring& firing);
  [[nodiscard]] std::vector<int> free_cells(const Pose2& odom_from_sonar, double free) const;
  void mark_seen(const Eigen::Vector2d& place, double radius);
  [[nodiscard]] std::vector<int> disc_offsets(double radius) const;
  [[nodiscard]] std::optional<std::vector<Eigen::Vector2d>> search(const Eigen::Vector2d& place,
                                                                   double clearance) const;

  SonarRing ring_;
  int columns_ = 0;
  std::optional<Eigen::Vector2d> origin_;  // [m] odom, lower left corner
  std::vector<Cell> cells_;
  std::vector<std::int64_t> taken_up_;  // [us] per disc
};

}  // namespace luminav
