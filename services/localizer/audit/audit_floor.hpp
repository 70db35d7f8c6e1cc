#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/building/occupancy_grid.hpp"
#include "services/common/ceiling/fixture_map.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/localizer/audit/walk_ground.hpp"
#include "services/localizer/model/wall_field.hpp"

namespace luminav {

/// A motion of the plane from the true pose to an alias.
struct AliasMotion {
  explicit AliasMotion(const Pose2& motion)
      : alias_from_true(motion), true_from_alias(PointTransform::inverse_of(motion)), theta(motion.theta) {}
  PointTransform alias_from_true;
  PointTransform true_from_alias;
  double theta;  // [rad] that it turns by
};

/// A floor where robots may stand, what of its ceiling is in view from there, and from where else the same is. A pose
/// and its alias differ by a motion of the plane that lays what is in view on others of its kind. Headings are left
/// out: the view is taken for a disc as large as the image. Whoever asks may do so from any thread.
class AuditFloor {
 public:
  static constexpr double kCell = 0.25;  ///< [m] between places looked at
  static constexpr double kPositionTolerance =
      0.25;  ///< [m] fixtures nearer than this to each other's images are alike

  AuditFloor(const Building& building, const PriorMap& walls, const CameraDescription& camera);

  [[nodiscard]] double view_radius() const { return view_radius_; }
  /// Where a robot may stand, `kCell` apart, and which places are next to which.
  [[nodiscard]] const WalkGround& ground() const { return ground_; }
  /// Fixtures in view from a place, as indices.
  [[nodiscard]] const std::vector<int>& in_view(std::int32_t place) const {
    return in_view_[static_cast<std::size_t>(place)];
  }
  [[nodiscard]] bool is_blind(std::int32_t place) const { return in_view(place).empty(); }
  [[nodiscard]] const Fixture& fixture(int index) const { return map_[index]; }

  /// All motions that lead from a place to where the ceiling looks the same; none where nothing is in view. `changed`
  /// is a fixture that became of another kind, -1 = none. A round fixture alone leaves the heading open: the ring round
  /// it is cut into turns, and it may lie on any of its kind in such a way that some neighbour of both agrees.
  [[nodiscard]] std::vector<AliasMotion> aliases(std::int32_t place, int changed = -1) const;
  /// Somebody could stand where a motion leads from a place, and would see the same there.
  [[nodiscard]] bool is_alias(const AliasMotion& motion, std::int32_t place, int changed = -1) const;

 private:
  void find_places(const PriorMap& walls);
  /// Which fixture in view is laid on others: one that has a heading if there is any.
  [[nodiscard]] int anchor(std::int32_t place) const;
  /// Headings [rad] of motions that lay the anchor of a place on a fixture of its kind.
  [[nodiscard]] std::vector<double> turns(int anchor, const std::vector<int>& partners, int to) const;
  /// Fixtures by which a round anchor's heading is told: one in view with it, else those that may come into view next.
  [[nodiscard]] std::vector<int> partners(int anchor, std::int32_t place) const;
  /// A fixture, moved to where its centre lies and turned, would be taken for another one.
  [[nodiscard]] bool is_alike(int index, const Eigen::Vector2d& moved, double turn, int other, int changed) const;
  /// A fixture, moved, would be taken for one that hangs there.
  [[nodiscard]] bool has_image(const PointTransform& motion, double turn, int index, int changed) const;

  FixtureMap map_;
  WallField walls_;
  double view_radius_;  // [m]
  WalkGround ground_;
  std::vector<std::vector<int>> in_view_;  // by place
};

}  // namespace luminav
