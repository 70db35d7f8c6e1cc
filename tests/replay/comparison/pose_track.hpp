#pragma once

#include <cstdint>
#include <luminav/pose_t.hpp>
#include <luminav/sim_truth_t.hpp>
#include <optional>
#include <vector>

#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// What the poses of one drive are measured against: the truth, or poses recorded while TRACKING.
class ReferenceTrack {
 public:
  void add(std::int64_t utime, const Pose2& pose, bool excused);

  [[nodiscard]] bool empty() const { return points_.empty(); }
  /// Interpolated; nothing more than `kLongestGap` away from any point, or while the robot is carried and for
  /// `kGraceAfterCarry` behind it.
  [[nodiscard]] std::optional<Pose2> at(std::int64_t utime) const;

 private:
  struct Point {
    std::int64_t utime;
    Pose2 pose;
    bool excused;
  };
  static constexpr std::int64_t kLongestGap = 300'000;         // [us]
  static constexpr std::int64_t kGraceAfterCarry = 3'000'000;  // [us] within which it must have noticed
  std::vector<Point> points_;
  std::int64_t excused_until_ = 0;
};

struct PoseSample {
  std::int64_t utime = 0;  // [us]
  Pose2 pose;
  int state = 0;      // pose_t::STATE_*
  int estimator = 0;  // pose_t::ESTIMATOR_*
};

PoseSample sample_of(const pose_t& message);

/// How good the poses of one drive are.
struct TrackFigures {
  int poses = 0;
  int compared = 0;             // while TRACKING, with a reference
  double localized_s = -1.0;    // first TRACKING since the first pose; -1 = never
  double tracking_ratio = 0.0;  // after it
  int state_changes = 0;
  double position_rms = 0.0;     // [m] while TRACKING
  double position_p95 = 0.0;     // [m]
  double position_max = 0.0;     // [m]
  double heading_rms = 0.0;      // [rad]
  double heading_p95 = 0.0;      // [rad]
  double wrong_s = 0.0;          // TRACKING more than 0.5 m or 20 degrees off
  std::int64_t wrong_utime = 0;  // [us] when that first was so; 0 = never
};

TrackFigures measure(const std::vector<PoseSample>& track, const ReferenceTrack& reference);

/// First stamp [us] at which both are TRACKING and more than `limit` [m] apart, or their states differ for more than a
/// second; nothing when that never happens.
std::optional<std::int64_t> first_departure(const std::vector<PoseSample>& recorded,
                                            const std::vector<PoseSample>& replayed, double limit);

}  // namespace luminav
