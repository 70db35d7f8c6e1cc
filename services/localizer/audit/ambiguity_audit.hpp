#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/building/occupancy_grid.hpp"
#include "services/common/ceiling/fixture_map.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/localizer/audit/resolving_walk.hpp"
#include "services/localizer/model/wall_field.hpp"

namespace luminav {

struct AuditParams {
  double cell = 0.25;                      // [m] between places looked at
  double clearance = 0.25;                 // [m] that the robot's middle keeps from walls
  double alias_clearance = 0.10;           // [m] nearer to a wall nobody can be: such a alias is refuted
  double position_tolerance = 0.25;        // [m] fixtures nearer than this to each other's images are alike
  double heading_tolerance = radians(12);  // [rad] likewise
  double never_distance = 50.0;            // [m] that a place which never resolves counts in means
  bool with_elements = false;              // vents, detectors and the like count as landmarks
};

/// One place where the robot may be switched on.
struct AuditPlace {
  Eigen::Vector2d point;
  bool is_blind = false;      // no fixture in view
  int aliases = 0;            // other poses that look the same, half turns included
  double min_distance = 0.0;  // [m] to drive until the farthest alias is refuted; infinite: never. More: ResolvingWalk
};

/// What one change would do.
struct AuditChange {
  int fixture = 0;                 // id of the fixture to be made another kind, or beside which a vent would be seen
  double mean_min_distance = 0.0;  // [m] over all places after it
  double never_share = 0.0;        // of the places after it
};

/// From where in a building the ceiling does not tell the pose, and how far the robot must drive until it does. A pose
/// and its alias differ by a motion of the plane that lays a fixture on another of its kind; robot and alias drive side
/// by side until one of them sees what the other does not, or the alias stands in a wall. Headings are left out: the
/// view is taken for a disc as large as the image.
class AmbiguityAudit {
 public:
  AmbiguityAudit(const Building& building, const PriorMap& walls, const CameraDescription& camera,
                 const AuditParams& params);

  [[nodiscard]] const std::vector<AuditPlace>& places() const { return places_; }
  [[nodiscard]] const AuditParams& params() const { return params_; }
  [[nodiscard]] double view_radius() const { return view_radius_; }
  /// Which aliases are possible where: ResolvingWalk finds the ways on it. In large buildings those are left out that
  /// are refuted soonest.
  [[nodiscard]] const RivalGround& ground() const { return ground_; }
  [[nodiscard]] double mean_min_distance() const { return mean_min_distance_; }
  /// Share of the places that never resolve.
  [[nodiscard]] double never_share() const { return never_share_; }
  /// The single changes that help most, best first; empty when nothing needs help.
  [[nodiscard]] std::vector<AuditChange> best_changes(std::size_t max) const;

 private:
  /// Way from a place to where a motion is refuted; places that are not named need none.
  struct PlaceDistance {
    std::int32_t place = 0;
    float distance = 0.0F;  // [m]
  };
  struct Motion {
    Pose2 alias_from_true;
    double sum = 0.0;  // [m] of ways over all places
  };
  /// What a motion does to the fixtures. Large buildings have millions of motions: it is made anew for each use.
  struct MotionImage {
    Pose2 alias_from_true;
    std::vector<bool> is_hit;  // some fixture lies on fixture i afterwards
    std::vector<int> image;    // fixture of its kind on which fixture i lies afterwards; -1 = none
  };
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  void find_places(const PriorMap& walls);
  void find_motions();
  void find_rivals();
  void add_rivals(std::int32_t motion, const std::vector<PlaceDistance>& distances);
  [[nodiscard]] MotionImage image_of(const Pose2& alias_from_true) const;
  [[nodiscard]] bool is_alike(const Fixture& a, const Pose2& world_from_a, const Fixture& b) const;
  /// Looks the same at a place under a motion; `changed` is a fixture that became another kind, -1 = none.
  [[nodiscard]] bool is_alias(const MotionImage& motion, std::size_t place, int changed) const;
  /// Ways from all places where a motion is not refuted.
  enum class AliasKind : std::uint8_t { kUntouched, kAlias, kRefuted };
  /// Places from which the motion's image looks alike and that are connected, without a refutation between, with one
  /// that sees a fixture which finds its like. `kind`: of each place that was looked at.
  [[nodiscard]] std::vector<std::int32_t> connected_aliases(const MotionImage& motion, int changed,
                                                            std::vector<AliasKind>& kind) const;
  [[nodiscard]] std::vector<PlaceDistance> distances(const MotionImage& motion, int changed) const;
  void add_blind_distances(std::vector<double>& distance) const;
  [[nodiscard]] std::vector<int> costly_fixtures(const std::vector<MotionImage>& images) const;
  [[nodiscard]] double mean_of(const std::vector<double>& distance) const;

  AuditParams params_;
  FixtureMap map_;
  WallField walls_;
  double view_radius_;
  GridGeometry grid_;
  std::vector<std::int32_t> place_of_cell_;           // -1 = not free
  RivalGround ground_;                                // a motion is a rival
  std::vector<std::vector<int>> in_view_;             // fixtures by place
  std::vector<std::vector<std::int32_t>> places_of_;  // from which a fixture is in view
  std::vector<AuditPlace> places_;
  std::vector<Motion> motions_;
  double mean_min_distance_ = 0.0;
  double never_share_ = 0.0;
};

}  // namespace luminav
