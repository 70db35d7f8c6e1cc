#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "services/common/ceiling/fixture_map.hpp"
#include "services/localizer/hypotheses/object_tracks.hpp"
#include "services/localizer/integrity/kidnap_opportunity.hpp"
#include "services/localizer/integrity/missing_fixtures.hpp"
#include "services/localizer/integrity/tracking_rules.hpp"
#include "services/localizer/model/observation_model.hpp"
#include "services/localizer/model/pose_belief.hpp"
#include "services/localizer/tracking/fixture_matching.hpp"

namespace luminav {

/// What speaks against a tracked pose.
struct Contradiction {
  std::string reason;
  double log_prior = 0.0;   // prior that the old pose keeps nevertheless
  bool is_misfit = false;   // something is seen that is no fixture, as opposed to a fixture that is not seen
  int needed_fixtures = 1;  // that the old pose must fit before it is held for true again
};

/// Watches a tracked pose for signs that it is wrong: sightings that fit nothing, fixtures that vanish though the robot
/// stands still, fixtures that never come.
class MatchMonitor {
 public:
  /// The model must outlive this; its map learns where the building's file is wrong.
  MatchMonitor(ObservationModel& model, const TrackingRules& rules);

  /// One image: the scene with it, and the sightings that fitted; `distance_since_match` [m].
  /// A contradiction is told once the rules' number of images showed it; with `is_suspected` images only count.
  [[nodiscard]] std::optional<Contradiction> look(const SightingFrame& frame, const ObjectTracks& tracks,
                                                  const std::vector<FixtureMatch>& matches, const PoseBelief& belief,
                                                  const Pose2& odom_from_robot, double distance_since_match,
                                                  bool is_suspected);
  /// While the motors are off a hand may move the robot: then it counts as having stood still.
  void allow_kidnapping(bool allowed) { kidnap_.set_motors_off(allowed); }
  /// Restarts all counts: the pose was suspected.
  void reset();
  /// The pose is TRACKING again. With `was_suspected` it is the pose that was suspected: then the map is doubted, at
  /// the fixture that was missing or where the object was seen.
  void confirm(bool was_suspected);
  /// The pose was corrected by what it did not explain: that is no fault of the map.
  void forget_misfit() { misfit_.reset(); }

 private:
  /// Restarts the counts of the images in a row.
  void forget_run();
  void note_match(const std::vector<FixtureMatch>& matches, const PoseBelief& belief);
  /// While other fixtures support the pose of a robot that drives, what fits none puts the map in doubt, not the pose.
  void note_strangers(const SightingFrame& frame, const ObjectTracks& tracks, const std::vector<FixtureMatch>& matches,
                      const PoseBelief& belief);
  /// True if the pose predicted many fixtures and the wheels have turned since its last match: nobody can have carried
  /// the robot away so quickly.
  [[nodiscard]] bool is_beyond_kidnapping(std::int64_t utime) const;
  /// Where [world] something is seen that is no fixture of the building.
  [[nodiscard]] std::optional<Eigen::Vector2d> find_unexplained(const SightingFrame& frame, const ObjectTracks& tracks,
                                                                const PoseBelief& belief) const;
  /// So many images contradict that a robot which may have been carried was.
  [[nodiscard]] bool was_kidnapped() const;

  FixtureMap& map_;
  TrackingRules rules_;
  KidnapOpportunity kidnap_;
  MissingFixtures missing_;
  int misfit_run_ = 0;                     // images since the last match that show what fits nothing
  int contradicting_ = 0;                  // since it stood still: that, or lack what they ought to show
  int quiet_ = 0;                          // images in a row that do neither: then both counts begin anew
  std::set<int> predicted_;                // fixtures that came where the pose has them
  std::int64_t match_utime_ = 0;           // [us] of the last match
  int missed_fixture_ = -1;                // whose absence put the pose in doubt; -1 = something else
  std::optional<Eigen::Vector2d> misfit_;  // [world] what put the pose in doubt by being seen there
  std::map<int, int> strange_images_;      // of objects that fitted nothing while others supported the pose
};

}  // namespace luminav
