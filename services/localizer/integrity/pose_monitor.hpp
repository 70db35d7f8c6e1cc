#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <vector>

#include "services/localizer/hypotheses/object_tracks.hpp"
#include "services/localizer/integrity/integrity_model.hpp"
#include "services/localizer/integrity/kidnap_opportunity.hpp"
#include "services/localizer/model/observation_model.hpp"
#include "services/localizer/model/pose_belief.hpp"
#include "services/localizer/model/sighting_model.hpp"

namespace luminav {

/// Sums what the images since the last match say against a tracked pose: sightings that fit nothing, fixtures that
/// vanish from a robot that stands, fixtures that never come.
class PoseMonitor {
 public:
  /// The model must outlive this; its map learns where the building's file is wrong.
  PoseMonitor(ObservationModel& model, const TrackingRules& rules) : model_(model), rules_(rules) {}

  /// One image, the scene with it, and the sightings that fitted. Tells what contradicts the pose once that is enough.
  [[nodiscard]] std::optional<Contradiction> look(const SightingFrame& frame, const ObjectTracks& tracks,
                                                  const std::vector<FixtureMatch>& matches, const PoseBelief& belief,
                                                  const Pose2& odom_from_robot);
  /// While the motors are off a hand may move the robot.
  void allow_kidnapping(bool allowed) { kidnap_.set_motors_off(allowed); }
  /// Since the last match somebody may have carried the robot off.
  [[nodiscard]] bool may_be_kidnapped() const { return kidnap_.was_given(); }
  /// Restarts the sum.
  void restart();
  /// Another pose is followed from now on: nothing speaks for it yet.
  void begin_anew();

 private:
  void match(const std::vector<FixtureMatch>& matches, const PoseBelief& belief);
  /// While other fixtures support the pose of a robot that drives, what fits none puts the map in doubt, not the pose.
  void note_strangers(const SightingFrame& frame, const ObjectTracks& tracks, const std::vector<FixtureMatch>& matches,
                      const PoseBelief& belief);
  /// Adds the evidence of fixtures that ought to be in view and are not seen.
  void add_missing(const SightingFrame& frame, const PoseBelief& belief);
  /// So much of a fixture must be in view, and so far inside the image, that an image without it misses it.
  [[nodiscard]] bool is_missing(int index, const Pose2& robot_from_fixture, const PoseBelief& belief) const;
  /// Where [world] two images show something and no fixture hangs; one image is enough if somebody may carry the robot.
  [[nodiscard]] std::optional<Eigen::Vector2d> find_misfit(const SightingFrame& frame, const ObjectTracks& tracks,
                                                           const PoseBelief& belief) const;

  ObservationModel& model_;
  TrackingRules rules_;
  KidnapOpportunity kidnap_;
  double misfit_ = 0.0;                // log-evidence of what fits nothing
  std::map<int, double> missing_;      // log-evidence of fixtures that are not seen
  std::map<int, double> seen_;         // fixtures of the last match, and which share of them was in view
  std::map<int, int> strange_images_;  // of objects that fitted nothing while others supported the pose
};

}  // namespace luminav
