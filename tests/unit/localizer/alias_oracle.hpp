#pragma once

#include <vector>

#include "services/common/ceiling/ceiling_view.hpp"
#include "services/common/ceiling/fixture_map.hpp"
#include "services/localizer/model/wall_field.hpp"
#include "tests/unit/localizer/synthetic_world.hpp"

namespace luminav::testing {

/// Knows the true pose and says from when on the drive so far tells it: all other poses that explain the first fixture
/// drive along, until what they ought to see differs from what is seen, or they stand in a wall. What the ambiguity
/// audit says of places, for one drive.
class AliasOracle {
 public:
  explicit AliasOracle(const SyntheticWorld& world);
  /// The true pose a little later.
  void follow(const Pose2& truth);
  /// A fixture was seen and no other pose is left.
  [[nodiscard]] bool is_resolved() const { return has_begun_ && aliases_.empty(); }

 private:
  void begin(const Pose2& truth);
  [[nodiscard]] bool is_refuted(const Pose2& truth, const Pose2& alias) const;
  /// All that is well in view from one pose is where it ought to be from the other.
  [[nodiscard]] bool explains(const Pose2& pose, const Pose2& seen_from) const;

  FixtureMap map_;
  WallField walls_;
  CeilingView view_;
  double radius_;  // [m]
  bool has_begun_ = false;
  Pose2 last_;
  std::vector<Pose2> aliases_;
};

}  // namespace luminav::testing
