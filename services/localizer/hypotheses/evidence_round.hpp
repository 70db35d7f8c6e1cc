#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/common/ceiling/fixture_sighting.hpp"
#include "services/localizer/hypotheses/object_tracks.hpp"
#include "services/localizer/hypotheses/sonar_evidence.hpp"
#include "services/localizer/model/pose_belief.hpp"

namespace luminav {

/// What the robot did between the beginnings of two rounds.
struct RoundMotion {
  bool has_moved = false;
  PoseBelief step{{}, Eigen::Matrix3d::Zero()};  // in the robot frame at the first
  double distance = 0.0;                         // [m] of it
  bool settles = false;                          // the scene before is over: relative motion to it is unknown
};

/// What all hypotheses are compared with in one round: an image, and what was driven and heard since the round before.
/// It stays as it is until the last of them has seen it, however many images pass meanwhile.
struct EvidenceRound {
  static constexpr int kMaxImages = 2;  // that one stands for: chance is not averaged out as by many

  bool has_image = false;
  SightingFrame frame;
  OdometryReading odometry;              // at the image's time
  double odometer = 0.0;                 // [m] likewise
  double share = 1.0;                    // of the image's constant errors that are drawn anew
  ObjectTracks scene;                    // with this image
  std::vector<ObjectTrack> forgotten;    // since the round before
  std::vector<int> images_of_sighting;   // images that this one stands for
  int images = 1;                        // likewise, whatever they show
  std::vector<PlacedEcho> echoes;        // in the robot frame of the image
  std::vector<Eigen::Vector2d> stretch;  // driven last [m, robot frame of the image]
  RoundMotion motion;                    // since the round before
};

}  // namespace luminav
