#pragma once

#include <string>
#include <vector>

#include "services/common/ceiling/fixture_map.hpp"
#include "services/localizer/hypotheses/hypothesis_bank.hpp"
#include "services/localizer/hypotheses/object_tracks.hpp"
#include "services/localizer/integrity/match_monitor.hpp"
#include "services/localizer/integrity/tracking_rules.hpp"
#include "services/localizer/model/pose_belief.hpp"
#include "services/localizer/tracking/tracking_filter.hpp"

namespace luminav {

/// Says whether one pose is known (TRACKING), several are possible (AMBIGUOUS) or none is (LOST), and why. The pose
/// that the filter follows is the leader among the hypotheses; what speaks against it makes it one of many again, with
/// a head start, and what it predicts gives it its place back.
class TrackingSupervisor {
 public:
  /// Everything given must outlive this.
  TrackingSupervisor(const FixtureMap& map, ObjectTracks& tracks, HypothesisBank& bank, TrackingFilter& filter,
                     MatchMonitor& monitor, const TrackingRules& rules);

  /// Judges the hypotheses after an image, or after odometry alone (an empty frame); `distance_since_fixture` [m]. True
  /// when the filter was started at another pose and is to be corrected by this very image.
  [[nodiscard]] bool decide(const SightingFrame& frame, double distance_since_fixture);

  /// Puts the filter's pose in doubt: it becomes the only hypothesis, and the search begins.
  void suspect(const Contradiction& contradiction);
  /// Puts it in doubt for a slip of the wheels, after which the robot is rather at `slipped`.
  void suspect_slip(const PoseBelief& slipped);
  /// Adds where a doubted robot is if it slipped or was bumped. Another fixture that this pose predicts speaks for it.
  void add_moved(const PoseBelief& belief, double log_prior);
  /// While somebody moves the robot nothing is known.
  void suspend(const std::string& why);
  /// That is over, and what was seen before says nothing of where the robot is now. With `was_followed` the filter saw
  /// fixtures where it predicted them all the time.
  void resume(bool was_followed);
  /// Gives a doubted pose, and the one it may have moved to, more weight once it predicted a fixture.
  void favour_predicting_pose();
  /// While TRACKING, after an image whose fixtures the filter matched: a leader that matched none of them goes where
  /// the filter is.
  void keep_leader_at_filter(const SightingFrame& frame);
  /// A user's guess while TRACKING: as good as the tracked pose for now.
  void add_rival(const PoseBelief& belief);

  [[nodiscard]] LocalizerState state() const { return state_; }
  [[nodiscard]] bool is_tracking() const { return state_ == LocalizerState::kTracking; }
  [[nodiscard]] const std::string& reason() const { return reason_; }
  /// The filter follows a pose.
  [[nodiscard]] bool has_leader() const { return leader_id_ != 0; }
  [[nodiscard]] bool is_suspected() const { return !suspicion_.empty(); }

 private:
  void drop_leader(LocalizerState state);
  void drop_refuted_leader();
  [[nodiscard]] bool begin_anew_if_unexplained(const SightingFrame& frame);
  void judge_tracked_pose(double distance_since_fixture);
  /// What a known pose tells of the building's file: how many places are in doubt, and which fixtures hang elsewhere.
  [[nodiscard]] std::string describe_doubts() const;
  [[nodiscard]] bool resume_tracking(const SightingFrame& frame);
  [[nodiscard]] bool may_declare(const Hypothesis& best, const SightingFrame& frame) const;
  [[nodiscard]] bool declare_tracking(const Hypothesis& best);
  void explain_ambiguity();
  /// How far [log-score] the best hypothesis is ahead of every other pose, listed or not.
  [[nodiscard]] double margin() const;
  /// Ahead by what declaring needs, and without the sonars not too far behind.
  [[nodiscard]] bool is_far_ahead() const;
  [[nodiscard]] double needed_margin() const { return was_tracking_ ? rules_.enter_margin : rules_.first_margin; }
  /// The hypothesis of that number; nullptr if there is none.
  [[nodiscard]] Hypothesis* find(int id) const;
  [[nodiscard]] Hypothesis* leader() const { return find(leader_id_); }

  const FixtureMap& map_;
  ObjectTracks& tracks_;
  HypothesisBank& bank_;
  TrackingFilter& filter_;
  MatchMonitor& monitor_;
  TrackingRules rules_;

  LocalizerState state_ = LocalizerState::kLost;
  std::string reason_ = "no fixture seen yet";
  bool was_tracking_ = false;  // a pose was held for true, and nobody was seen to carry the robot off since
  int leader_id_ = 0;          // hypothesis that the filter follows; 0 = none
  bool wide_ = false;          // the filter's covariance is too wide to call it tracking
  std::string suspicion_;      // why the leader was put in doubt; "" = it is not
  bool may_predict_ = false;   // a fixture where the doubted leader has one speaks for it
  int needed_fixtures_ = 1;    // that must fit before the doubted leader is held for true again
  int moved_id_ = 0;           // hypothesis that it slipped or was bumped, until it predicted a fixture; 0 = none
  int suspected_id_ = 0;       // hypothesis that was put in doubt last
  int unexplained_run_ = 0;    // images
};

}  // namespace luminav
