#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "drivers/simulator/geometry/distance_field.hpp"
#include "drivers/simulator/geometry/shapes.hpp"
#include "drivers/simulator/world/world_truth.hpp"

namespace luminav {

inline constexpr double kPersonRadius = 0.25;  // [m]

/// What the robot can touch; contacts are counted per kind.
enum class SolidKind { kWall, kBox, kHard, kPerson };
inline constexpr std::size_t kSolidKinds = 4;

/// What a sonar pulse meets.
enum class Surface { kSmooth, kGlass, kCloth, kThin };

/// Distances from the robot's outline to the nearest thing of each kind.
struct Separation {
  static constexpr double kNoneNear = 10.0;                                        // [m]
  std::array<double, kSolidKinds> of{kNoneNear, kNoneNear, kNoneNear, kNoneNear};  // [m] by SolidKind

  [[nodiscard]] double to(SolidKind kind) const { return of[static_cast<std::size_t>(kind)]; }
  [[nodiscard]] double nearest() const;
};

/// Where a ray ends.
struct SurfaceHit {
  double distance = 0.0;                             // [m]
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();  // unit, out of the surface
  Surface surface = Surface::kSmooth;
};

/// A convex corner that bends a little sound back.
struct Edge {
  Eigen::Vector2d point = Eigen::Vector2d::Zero();  // [m] world
};

/// Everything solid at the height of the robot: walls, closed doors, obstacles, people. Costs do not depend on the
/// size of the building.
class Scene {
 public:
  explicit Scene(const WorldTruth& truth);

  void set_door_closed(std::size_t door, bool closed) { doors_[door].closed = closed; }
  [[nodiscard]] const Polygon& door_leaf(std::size_t door) const { return doors_[door].leaf; }
  [[nodiscard]] bool is_door_closed(std::size_t door) const { return doors_[door].closed; }
  [[nodiscard]] std::size_t doors() const { return doors_.size(); }
  void set_person(std::size_t person, const Eigen::Vector2d& position) { people_[person].centre = position; }
  /// As many people; new ones stand where `set_person` puts them next.
  void set_people(std::size_t count) { people_.resize(count, {Eigen::Vector2d::Zero(), kPersonRadius}); }
  [[nodiscard]] const std::vector<Disc>& people() const { return people_; }

  /// Exact where something is nearer than four cells of the map; walls farther away within a cell.
  [[nodiscard]] Separation separation(const Polygon& outline) const;
  /// The part of it that changes while the robot stands.
  [[nodiscard]] double person_distance(const Polygon& outline) const;

  /// Obstacles that are hard for sonar; each is heard or not for a whole pulse.
  [[nodiscard]] std::size_t hard_obstacles() const { return hard_count_; }
  /// First thing that a ray meets within `range` [m]; `heard` says for each hard obstacle whether this pulse sees its
  /// legs and edges (glass is always there).
  [[nodiscard]] std::optional<SurfaceHit> cast_ray(const Eigen::Vector2d& origin, const Eigen::Vector2d& direction,
                                                   double range, const std::vector<char>& heard) const;
  /// Corners of boxes within `range` [m].
  void edges_near(const Eigen::Vector2d& point, double range, std::vector<Edge>& edges) const;

 private:
  struct Body {
    ObstacleKind kind = ObstacleKind::kBox;
    Polygon outline;
    std::array<Disc, 4> legs;  // of legs and tables
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();
    double radius = 0.0;         // [m] of a circle round it
    std::size_t hard_index = 0;  // among the hard ones
  };
  struct DoorLeaf {
    Polygon leaf;
    bool closed = false;
  };

  static Body make_body(const Obstacle& obstacle);
  [[nodiscard]] double wall_distance(const Polygon& outline) const;
  [[nodiscard]] double exact_wall_distance(const Polygon& outline, double reach) const;
  [[nodiscard]] bool is_wall(const Cell& cell) const {
    return walls_->geometry.contains(cell) && walls_->cells[walls_->geometry.index(cell)] == Prior::kOccupied;
  }
  [[nodiscard]] std::optional<SurfaceHit> cast_ray_at_walls(const Eigen::Vector2d& origin,
                                                            const Eigen::Vector2d& direction, double range) const;
  [[nodiscard]] Eigen::Vector2d wall_normal(const Eigen::Vector2d& point) const;

  const PriorMap* walls_;
  DistanceField wall_field_;
  std::vector<Body> bodies_;
  std::vector<DoorLeaf> doors_;
  std::vector<Disc> people_;
  std::size_t hard_count_ = 0;
};

}  // namespace luminav
