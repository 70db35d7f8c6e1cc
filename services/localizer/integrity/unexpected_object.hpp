#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "services/common/ceiling/fixture_sighting.hpp"
#include "services/localizer/integrity/tracking_rules.hpp"
#include "services/localizer/tracking/fixture_matching.hpp"

namespace luminav {

/// Detects what comes into view of a robot that stands still. Nothing on a ceiling moves, so it was hidden, the
/// detector had missed it, or somebody moved the robot. After such a move a fixture that fits the pose proves nothing:
/// it may be another one that is there by chance.
class UnexpectedObject {
 public:
  explicit UnexpectedObject(const TrackingRules& rules) : rules_(rules) {}

  /// One image, and which of its sightings fitted fixtures. Where [robot frame] a thing is seen that came into view
  /// though the wheels turned too little to bring it there, and has fitted nothing in as many images as the rules ask
  /// for, none of them long after the one before: told once for each thing.
  [[nodiscard]] std::optional<Eigen::Vector2d> look(const SightingFrame& frame,
                                                    const std::vector<FixtureMatch>& matches,
                                                    const Pose2& odom_from_robot);
  /// What is in view next was there before.
  void clear();

 private:
  struct Thing {
    Pose2 odom_from_thing;
    FixtureShape shape = FixtureShape::kRectangle;
    bool has_theta = true;
    Pose2 odom_from_robot;             // when it was last seen
    std::optional<Pose2> odom_unseen;  // odom_from_robot at the image before it was first seen
    int frames = 0;                    // images that showed it, without a long gap
    int unseen = 0;                    // images in a row that did not, so far
    bool is_explained = false;         // one showed it where the pose has a fixture
  };

  [[nodiscard]] Thing& find_or_add(const FixtureSighting& sighting, const Pose2& odom_from_robot);
  [[nodiscard]] bool has_moved(const Pose2& odom_from_before, const Pose2& odom_from_now) const;

  TrackingRules rules_;
  std::vector<Thing> things_;
  std::optional<Pose2> odom_at_frame_;  // odom_from_robot at the image before
};

}  // namespace luminav
