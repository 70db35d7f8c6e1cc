#pragma once

#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/geometry/angle.hpp"
#include "services/common/geometry/camera_model.hpp"

namespace luminav {

/// Share of a fixture's area, 0..1, that the camera sees from a pose of the robot.
double visible_share(const Fixture& fixture, const Pose2& world_from_robot, const CeilingCamera& camera);

/// Two views of a fixture agree within this.
struct ViewGate {
  double distance = 0.5;        // [m] by default the bound of "confidently wrong"
  double turn = radians(20.0);  // [rad] likewise
};

/// Tells from geometry alone what a camera should see from a pose; the yardstick for "an image that contradicts".
class FixtureVisibility {
 public:
  FixtureVisibility(std::vector<Fixture> fixtures, const CeilingCamera& camera);

  /// Indices of fixtures of which at least `share` is visible.
  [[nodiscard]] std::vector<std::size_t> visible_from(const Pose2& world_from_robot, double share) const;
  /// True when an image taken at `truth` contradicts the belief: a fixture at least 30 % visible from the true pose
  /// that the believed pose does not predict, or one at least 80 % visible from the believed pose that is not there.
  [[nodiscard]] bool contradicts(const Pose2& truth, const Pose2& belief, const ViewGate& gate = {}) const;

 private:
  [[nodiscard]] bool predicts(const Pose2& in_robot, const Fixture& seen, const Pose2& world_from_robot,
                              const ViewGate& gate) const;
  std::vector<Fixture> fixtures_;
  CeilingCamera camera_;
  double reach_;  // [m] round the robot within which a fixture may be in the image
};

}  // namespace luminav
