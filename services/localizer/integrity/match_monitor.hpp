#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "services/common/ceiling/ceiling_view.hpp"
#include "services/common/ceiling/fixture_map.hpp"
#include "services/localizer/hypotheses/object_tracks.hpp"
#include "services/localizer/integrity/tracking_rules.hpp"
#include "services/localizer/integrity/unexpected_object.hpp"
#include "services/localizer/model/pose_belief.hpp"
#include "services/localizer/tracking/fixture_matching.hpp"

namespace luminav {

/// What speaks against a tracked pose.
struct Contradiction {
  std::string reason;
  double log_prior = 0.0;  // prior that the old pose keeps nevertheless
  bool is_misfit = false;  // something is seen that is no fixture, as opposed to a fixture that is not seen
};

/// Watches a tracked pose for signs that it is wrong: sightings that fit nothing, fixtures that vanish though the robot
/// stands still, fixtures that never come, things that come into view of a robot that stands.
class MatchMonitor {
 public:
  MatchMonitor(FixtureMap& map, const CeilingView& view, double ceiling_height, const TrackingRules& rules);

  /// One image: its sightings with their object in the scene, and those that fitted; `distance_since_match` [m].
  /// A contradiction is told once the rules' number of images showed it; with `is_suspected` images only count.
  [[nodiscard]] std::optional<Contradiction> look(const SightingFrame& frame, const std::vector<int>& objects,
                                                  const ObjectTracks& tracks, const std::vector<FixtureMatch>& matches,
                                                  const PoseBelief& belief, const Pose2& odom_from_robot,
                                                  double distance_since_match, bool is_suspected);
  /// While the motors are off a hand may move the robot: then it counts as having stood still.
  void allow_kidnapping(bool allowed) { may_be_kidnapped_ = allowed; }
  /// Restarts all counts: the pose was suspected.
  void reset();
  /// The pose is TRACKING again. With `was_suspected` it is the pose that was suspected: then the map is doubted, at
  /// the fixture that was missing or where the object was seen.
  void confirm(bool was_suspected);

 private:
  /// Restarts the counts of the images in a row.
  void forget_run();
  void note_pause(const Pose2& odom_from_robot);
  void note_match(const std::vector<FixtureMatch>& matches, const PoseBelief& belief, const Pose2& odom_from_robot);
  /// While other fixtures support the pose of a robot that drives, what fits none puts the map in doubt, not the pose.
  void note_strangers(const SightingFrame& frame, const std::vector<int>& objects, const ObjectTracks& tracks,
                      const std::vector<FixtureMatch>& matches, const PoseBelief& belief);
  /// True if the pose predicted many fixtures and the wheels have turned since its last match: nobody can have carried
  /// the robot away so quickly.
  [[nodiscard]] bool is_beyond_kidnapping(std::int64_t utime) const;
  /// Where [world] something is seen that is no fixture of the building.
  [[nodiscard]] std::optional<Eigen::Vector2d> find_unexplained(const SightingFrame& frame,
                                                                const std::vector<int>& objects,
                                                                const ObjectTracks& tracks,
                                                                const PoseBelief& belief) const;
  /// Counts what ought to be in view and is not; false = nothing.
  bool count_missing(const SightingFrame& frame, const PoseBelief& belief, const Pose2& odom_from_robot);
  /// The fixture whose absence puts the pose in doubt.
  [[nodiscard]] std::optional<int> missing_too_long(double distance_since_match) const;
  /// So many images contradict that a robot which may have been carried was.
  [[nodiscard]] bool was_kidnapped() const;

  FixtureMap& map_;
  const CeilingView& view_;
  double ceiling_height_;  // [m]
  TrackingRules rules_;
  UnexpectedObject newcomers_;
  int misfit_run_ = 0;                     // images since the last match that show what fits nothing
  int contradicting_ = 0;                  // since it stood still: that, or lack what they ought to show
  std::set<int> predicted_;                // fixtures that came where the pose has them
  bool halted_ = false;                    // the wheels stood for a moment since the last match
  std::int64_t match_utime_ = 0;           // [us] of the last match
  std::map<int, int> missed_frames_;       // images since the last match that ought to show a fixture and do not
  std::optional<int> vanished_;            // fixture that is no longer seen from where it was seen
  int missed_fixture_ = -1;                // whose absence put the pose in doubt; -1 = something else
  std::optional<Eigen::Vector2d> misfit_;  // [world] what put the pose in doubt by being seen there
  std::map<int, int> strange_images_;      // of objects that fitted nothing while others supported the pose
  std::map<int, double> seen_lately_;      // fixtures of the last match, and which share of them was in view
  Pose2 odom_at_frame_;                    // odom_from_robot at the image before
  int still_frames_ = 0;                   // images in a row without wheel motion
  bool may_be_kidnapped_ = false;          // the motors are off
  bool paused_ = false;                    // it stood still for a while since the last match
  Pose2 odom_at_match_;                    // odom_from_robot at the last match
};

}  // namespace luminav
