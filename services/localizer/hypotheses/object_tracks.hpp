#pragma once

#include <vector>

#include "services/common/ceiling/fixture_sighting.hpp"

namespace luminav {

/// One thing on the ceiling, followed from image to image by odometry alone, whatever the world pose may be.
struct ObjectTrack {
  int id = 0;
  FixtureSighting best;      // the sharpest sighting; its pose is not used, odom_from_object is
  Pose2 odom_from_object{};  // by the newest sighting that was about as sharp as the best
  Pose2 odom_from_robot{};   // where that sighting was made
  int frames = 0;            // images that showed it
  bool is_visible = false;   // in the newest image
  double odometer = 0.0;     // [m] of the robot when last seen
  bool extends_row = false;  // hangs as far from one seen before it as that from another: a lamp of a row does
  bool seeded = false;       // hypotheses were made from it
};

/// The objects seen lately. Many images of one object are one piece of evidence, not many: its errors are the same in
/// all of them. Objects are forgotten a few metres after they were last seen, before odometry's drift could mix them
/// up.
class ObjectTracks {
 public:
  /// Takes in one image's sightings. `odometer` [m] is the way driven so far. Objects that were forgotten are moved to
  /// `forgotten()`, valid until the next call.
  void update(const SightingFrame& frame, const Pose2& odom_from_robot, double odometer);
  void clear();

  [[nodiscard]] const std::vector<ObjectTrack>& objects() const { return objects_; }
  [[nodiscard]] std::vector<ObjectTrack>& objects() { return objects_; }
  /// What a sighting of the newest image is.
  [[nodiscard]] const ObjectTrack& seen(std::size_t sighting) const { return objects_[seen_[sighting]]; }
  [[nodiscard]] const std::vector<ObjectTrack>& forgotten() const { return forgotten_; }

 private:
  std::vector<ObjectTrack> objects_;
  std::vector<ObjectTrack> forgotten_;
  std::vector<std::size_t> seen_;  // by sighting of the newest image
  int next_id_ = 1;
};

}  // namespace luminav
