#pragma once

#include <string>

#include "services/localizer/hypotheses/hypothesis_bank.hpp"
#include "services/localizer/hypotheses/object_tracks.hpp"
#include "services/localizer/integrity/integrity_model.hpp"
#include "services/localizer/integrity/pose_monitor.hpp"
#include "services/localizer/model/observation_model.hpp"
#include "services/localizer/model/pose_belief.hpp"
#include "services/localizer/tracking/tracking_filter.hpp"

namespace luminav {

/// Says whether one pose is known (TRACKING), several are possible (AMBIGUOUS) or none is (LOST), and why. The pose
/// that the filter follows is the leader among the hypotheses; what speaks against it makes it one of many again, with
/// a head start, and what it predicts gives it its place back. See integrity_model.hpp.
class TrackingSupervisor {
 public:
  /// Everything given must outlive this. The map learns where the building's file is wrong.
  TrackingSupervisor(FixtureMap& map, ObjectTracks& tracks, HypothesisBank& bank, TrackingFilter& filter,
                     PoseMonitor& monitor, const TrackingRules& rules);

  /// Judges the hypotheses after an image, or after odometry alone (an empty frame); `distance_since_fixture` [m]. True
  /// when the filter was started at another pose and is to be corrected by this very image.
  [[nodiscard]] bool decide(const SightingFrame& frame, double distance_since_fixture);

  /// Puts the filter's pose in doubt: it becomes the only hypothesis, and the search begins.
  void suspect(const Contradiction& contradiction);
  /// The pose is right in spite of it: the map is doubted, at the fixture that was missing or where something was seen.
  void doubt_map(const Contradiction& contradiction);
  /// While somebody moves the robot nothing is known.
  void suspend(const std::string& why);
  /// That is over, and what was seen before says nothing of where the robot is now. With `was_followed` the filter saw
  /// fixtures where it predicted them all the time.
  void resume(bool was_followed);
  /// Gives a doubted pose more weight once it predicted a fixture.
  void favour_predicting_pose();
  /// While TRACKING or blind, after an image whose fixtures the filter matched: a leader that matched none of them
  /// goes where the filter is.
  void keep_leader_at_filter(const SightingFrame& frame);
  /// A user's guess while TRACKING: as good as the tracked pose for now.
  void add_rival(const PoseBelief& belief);

  [[nodiscard]] LocalizerState state() const { return state_; }
  [[nodiscard]] bool is_tracking() const { return state_ == LocalizerState::kTracking; }
  [[nodiscard]] const std::string& reason() const { return reason_; }
  /// The filter follows a pose.
  [[nodiscard]] bool has_leader() const { return leader_id_ != 0; }
  [[nodiscard]] bool is_suspected() const { return phase_ == Phase::kDoubted || phase_ == Phase::kDisplaced; }

 private:
  enum class Phase { kSearching, kFollowing, kBlind, kDoubted, kDisplaced };

  void enter(Phase phase, LocalizerState state, std::string reason);
  /// What was seen says nothing any more of where the robot is; no pose is followed.
  void search_anew(const std::string& why);
  /// A leader that is refuted is one no more.
  void drop_refuted_leader();
  [[nodiscard]] bool is_unexplained(const SightingFrame& frame);
  void judge_tracked_pose(double distance_since_fixture);
  /// What a known pose tells of the building's file: how many places are in doubt, and which fixtures hang elsewhere.
  [[nodiscard]] std::string describe_doubts() const;
  [[nodiscard]] bool may_declare(const Hypothesis& best, const SightingFrame& frame) const;
  [[nodiscard]] bool declare_tracking(const Hypothesis& best);
  [[nodiscard]] std::string explain_ambiguity() const;
  /// How far [log-score] the best hypothesis is ahead of every other pose, listed or not.
  [[nodiscard]] double margin() const;
  /// Without the sonars too the best is not too far behind any other.
  [[nodiscard]] bool is_ahead_without_sonar() const;
  /// By what the best must lead.
  [[nodiscard]] double needed_margin() const;
  /// The hypothesis that the filter follows; nullptr if there is none.
  [[nodiscard]] Hypothesis* leader() const;

  FixtureMap& map_;
  ObjectTracks& tracks_;
  HypothesisBank& bank_;
  TrackingFilter& filter_;
  PoseMonitor& monitor_;
  TrackingRules rules_;

  Phase phase_ = Phase::kSearching;
  LocalizerState state_ = LocalizerState::kLost;
  std::string reason_ = "no fixture seen yet";
  bool was_tracking_ = false;  // a pose was held for true, and nobody was seen to carry the robot off since
  int leader_id_ = 0;          // hypothesis that the filter follows; 0 = none
  Contradiction suspicion_;    // why a pose was put in doubt last
  int suspected_id_ = 0;       // the hypothesis that it was
  int unexplained_run_ = 0;    // images
};

}  // namespace luminav
