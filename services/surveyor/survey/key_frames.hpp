#pragma once

#include <cstdint>
#include <vector>

#include "services/common/ceiling/fixture_sighting.hpp"
#include "services/common/configuration/robot_file.hpp"

namespace luminav {

/// Where a localizer said that the robot was, and was sure of it.
struct ToldPose {
  std::int64_t utime = 0;  // [us]
  Pose2 world_from_robot;  // in the world of the building that it was told
};

/// What a survey drive left behind, in the order of time: odometry as the wheels told it, images with their own stamp,
/// no time offset added.
struct SurveyDrive {
  std::vector<OdometryReading> odometry;
  std::vector<SightingFrame> frames;
  std::vector<SonarEcho> echoes;
  std::vector<ToldPose> told;  // none: no localizer ran
  bool has_lengths = false;    // the length of a bar that is whole in view is measured, and not its kind's
};

/// An image of the drive and how the robot got there.
struct KeyFrame {
  std::int64_t utime = 0;                  // [us] time offset added
  int part = 0;                            // of the drive: between two parts nobody measured the motion
  double travelled = 0.0;                  // [m] since the drive began
  Pose2 odom_from_robot;                   // as the wheels told it
  double linear = 0.0;                     // [m/s]
  double angular = 0.0;                    // [rad/s]
  std::vector<Pose2> steps;                // odometry since the key frame before; none: the first of its part
  bool has_lengths = false;                // as the drive
  std::vector<FixtureSighting> sightings;  // as a camera without rolling shutter had seen them
};

inline constexpr double kKeyFrameSpacing = 0.10;       // [m] between two key frames,
inline constexpr double kKeyFrameTurn = radians(4.0);  // [rad] or that

/// Images of the drive at least so far apart, and the last one of each part, with or without anything in them.
/// `ceiling_height` [m]. A new part begins where odometry begins anew, where the robot drove on for more than two
/// seconds without it, and at each of `breaks` [us], in the order of time.
std::vector<KeyFrame> choose_key_frames(const SurveyDrive& drive, const CameraDescription& camera,
                                        double ceiling_height, const std::vector<std::int64_t>& breaks = {});

/// Length [m] of a step of odometry, negative backwards.
double signed_length(const Pose2& step);

}  // namespace luminav
