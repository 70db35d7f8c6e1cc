#include "services/localizer/calibration/drive_log.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <luminav/fixture_detections_t.hpp>
#include <luminav/odometry_t.hpp>
#include <stdexcept>

#include "services/common/ceiling/ceiling_view.hpp"
#include "services/common/ceiling/detection_conversion.hpp"
#include "services/common/ceiling/fixture_map.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/lcm_conversions.hpp"
#include "services/common/process/subscriber.hpp"
#include "services/localizer/model/wheel_correction.hpp"

namespace luminav {
namespace {

constexpr double kSurelyNear = 0.4;  // [m] between a fixture and where the tracked pose sees it

std::vector<KnownSighting> recognise(const SightingFrame& frame, const Pose2& pose, const FixtureMap& map) {
  std::vector<KnownSighting> known;
  std::vector<int> near;
  for (const FixtureSighting& sighting : frame.sightings) {
    near.clear();
    map.find_near(pose * sighting.robot_from_fixture.position(), kSurelyNear, near);
    if (near.size() == 1 && fits_kind_and_size(sighting, map[near.front()], KindGate{})) {
      known.push_back({near.front(), sighting});
    }
  }
  return known;
}

}  // namespace

DriveLog read_drive_log(const std::string& file) {
  lcm::LogFile log(file, "r");
  if (!log.good()) {
    throw std::runtime_error(file + ": cannot be read as an LCM log");
  }
  DriveLog drive;
  long whole = 0;  // [bytes] of events
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    whole = std::ftell(log.getFilePtr());
    if (event->channel == channels::kOdometry) {
      odometry_t message{};
      if (message.decode(event->data, 0, event->datalen) > 0 && is_possible(message) &&
          (drive.odometry.empty() || message.utime > drive.odometry.back().utime)) {
        drive.odometry.push_back(
            {message.utime, message.session, odom_from_robot(message), message.linear, message.angular});
      }
    } else if (event->channel == channels::kFixtureDetections) {
      fixture_detections_t message{};
      if (message.decode(event->data, 0, event->datalen) <= 0) {
        continue;
      }
      SightingFrame frame;
      frame.utime = message.utime;
      for (const fixture_detection_t& detection : message.detections) {
        if (is_possible(detection) && detection.shape != fixture_detection_t::SHAPE_ELEMENT) {
          frame.sightings.push_back(to_sighting(detection));
        }
      }
      drive.frames.push_back(frame);
    }
  }
  std::fseek(log.getFilePtr(), 0, SEEK_END);
  drive.is_cut = std::ftell(log.getFilePtr()) != whole;
  // a stamp from the future must not hold up the frames behind it
  std::stable_sort(drive.frames.begin(), drive.frames.end(),
                   [](const SightingFrame& a, const SightingFrame& b) { return a.utime < b.utime; });
  return drive;
}

namespace {

/// The drive's odometry as the localizer takes it: wheels corrected as the robot's file says.
std::vector<OdometryReading> corrected(const std::vector<OdometryReading>& odometry, const LocalizerConfig& config) {
  CorrectedOdometry wheels(config.wheels, config.robot.wheel_base);
  std::vector<OdometryReading> result = odometry;
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (i > 0 && odometry[i].session != odometry[i - 1].session) {
      wheels.restart();
    }
    result[i].odom_from_robot = wheels.correct(odometry[i].odom_from_robot);
  }
  return result;
}

}  // namespace

FollowedDrive follow_drive(const DriveLog& log, const LocalizerConfig& config, double spacing, double turn) {
  LocalizerConfig modern = config;
  modern.mode = LocalizerMode::kModern;
  const std::unique_ptr<Localizer> localizer = make_localizer(modern);
  const FixtureMap map(config.building.fixtures);
  const CeilingView view(config.robot.camera);
  const std::vector<OdometryReading> odometry = corrected(log.odometry, config);
  const auto offset = static_cast<std::int64_t>(std::lround(1e6 * config.robot.camera.time_offset));
  FollowedDrive followed;
  std::vector<Pose2> steps;
  Pose2 last_kept;
  bool has_kept = false;
  std::size_t next_frame = 0;
  for (std::size_t i = 1; i < odometry.size(); ++i) {
    const OdometryReading& before = odometry[i - 1];
    const OdometryReading& now = odometry[i];
    if (i == 1) {
      localizer->add_odometry(before);
    }
    if (now.session != before.session) {
      steps.clear();
      has_kept = false;
    }
    // Frames reach the localizer with the odometry after them. What it believes then is carried back to each.
    std::vector<SightingFrame> arrived;
    for (; next_frame < log.frames.size() && log.frames[next_frame].utime + offset <= now.utime; ++next_frame) {
      SightingFrame frame = log.frames[next_frame];
      frame.utime += offset;
      if (frame.utime > before.utime) {
        localizer->add_frame(frame);
        arrived.push_back(frame);
      }
    }
    localizer->add_odometry(now);
    const LocalizerEstimate estimate = localizer->estimate();
    const Pose2 step = before.odom_from_robot.inverse() * now.odom_from_robot;
    const Pose2 told = log.odometry[i - 1].odom_from_robot.inverse() * log.odometry[i].odom_from_robot;
    Pose2 done;  // of what the wheels told
    for (const SightingFrame& raw : arrived) {
      const double share =
          static_cast<double>(raw.utime - before.utime) / static_cast<double>(now.utime - before.utime);
      const Pose2 part = interpolate(Pose2{}, step, share);
      OdometryReading at = now;
      at.utime = raw.utime;
      at.odom_from_robot = before.odom_from_robot * part;
      at.linear = before.linear + share * (now.linear - before.linear);
      at.angular = before.angular + share * (now.angular - before.angular);
      const Pose2 since = has_kept ? last_kept.inverse() * at.odom_from_robot : Pose2{};
      const bool is_apart = !has_kept || std::hypot(since.x, since.y) > spacing || std::abs(since.theta) > turn;
      if (estimate.state != LocalizerState::kTracking) {
        ++followed.unused.not_tracking;
        continue;
      }
      if (raw.sightings.empty() || !is_apart) {
        ++(raw.sightings.empty() ? followed.unused.without_fixture : followed.unused.too_near);
        continue;
      }
      SightingFrame frame;
      for (const FixtureSighting& sighting : raw.sightings) {
        frame.sightings.push_back(
            view.without_rolling_shutter(sighting, config.building.ceiling_height, at.linear, at.angular));
      }
      const Pose2 pose = estimate.belief.pose * (part.inverse() * step).inverse();
      std::vector<KnownSighting> sightings = recognise(frame, pose, map);
      if (sightings.empty()) {
        ++followed.unused.without_fixture;
        continue;
      }
      const Pose2 told_part = interpolate(Pose2{}, told, share);
      steps.push_back(done.inverse() * told_part);
      done = told_part;
      followed.frames.push_back({at, pose, std::move(sightings), has_kept ? steps : std::vector<Pose2>{}});
      steps.clear();
      last_kept = at.odom_from_robot;
      has_kept = true;
    }
    steps.push_back(done.inverse() * told);
  }
  return followed;
}

}  // namespace luminav
