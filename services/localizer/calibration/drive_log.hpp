#pragma once

#include <string>
#include <vector>

#include "services/common/ceiling/fixture_sighting.hpp"
#include "services/localizer/localizer_config.hpp"

namespace luminav {

/// What a drive left behind, in the order of time: odometry as the wheels told it, frames with the image's own stamp,
/// no time offset added.
struct DriveLog {
  std::vector<OdometryReading> odometry;
  std::vector<SightingFrame> frames;
  bool is_cut = false;  // the log ends inside a message
};

/// ODOMETRY and FIXTURE_DETECTIONS of an LCM log; a log cut in the middle gives what is whole. Throws
/// std::runtime_error when there is no such file.
DriveLog read_drive_log(const std::string& file);

/// A sighting that is surely one of the building's fixtures.
struct KnownSighting {
  int fixture = 0;  // index into the building's fixtures
  FixtureSighting sighting;
};

/// An image with the pose that the localizer held for true.
struct KnownFrame {
  OdometryReading odometry;  // at the image's time, wheels corrected as the robot's file says
  Pose2 world_from_robot;
  std::vector<KnownSighting> sightings;
  std::vector<Pose2> steps;  // odometry since the frame before, reading by reading, as the wheels told it
};

/// Where the images of a drive went. The localizer begins anew, whatever was known while the drive was recorded.
struct FrameTally {
  std::size_t not_tracking = 0;     // the pose was not known yet, or not any more
  std::size_t too_near = 0;         // to one that is used
  std::size_t without_fixture = 0;  // nothing in it is surely a fixture of the building
};

struct FollowedDrive {
  std::vector<KnownFrame> frames;
  FrameTally unused;
};

/// Follows the drive with the localizer and keeps frames at least `spacing` [m] or `turn` [rad] apart, while TRACKING.
FollowedDrive follow_drive(const DriveLog& log, const LocalizerConfig& config, double spacing, double turn);

}  // namespace luminav
