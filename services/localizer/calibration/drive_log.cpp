#include "services/localizer/calibration/drive_log.hpp"

#include <algorithm>
#include <cmath>
#include <luminav/fixture_detections_t.hpp>
#include <luminav/odometry_t.hpp>

#include "services/common/ceiling/ceiling_view.hpp"
#include "services/common/ceiling/detection_conversion.hpp"
#include "services/common/ceiling/fixture_map.hpp"
#include "services/common/ceiling/odometry_history.hpp"
#include "services/common/log/log_file.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/lcm_conversions.hpp"
#include "services/common/process/subscriber.hpp"
#include "services/localizer/model/wheel_correction.hpp"

namespace luminav {
namespace {

constexpr double kSurelyNear = 0.4;  // [m] between a fixture and where the tracked pose sees it

std::vector<KnownSighting> recognise(const SightingFrame& frame, const OdometryReading& at, const Pose2& pose,
                                     const FixtureMap& map, const CeilingView& view, double ceiling_height) {
  std::vector<KnownSighting> known;
  for (const FixtureSighting& raw : frame.sightings) {
    const FixtureSighting sighting = view.without_rolling_shutter(raw, ceiling_height, at.linear, at.angular);
    const std::vector<int> near = map.near(pose * sighting.robot_from_fixture.position(), kSurelyNear);
    if (near.size() == 1 && fits_kind_and_size(sighting, map[near.front()], KindGate{})) {
      known.push_back({near.front(), sighting});
    }
  }
  return known;
}

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

/// Takes the frames up to `end` [us of odometry] that came after `begin`; `next` moves on behind them.
std::vector<SightingFrame> take_frames(const DriveLog& log, std::int64_t offset, std::int64_t begin, std::int64_t end,
                                       std::size_t& next) {
  std::vector<SightingFrame> taken;
  for (; next < log.frames.size() && log.frames[next].utime + offset <= end; ++next) {
    if (log.frames[next].utime + offset > begin) {
      taken.push_back(log.frames[next]);
      taken.back().utime += offset;
    }
  }
  return taken;
}

}  // namespace

DriveLog read_drive_log(const std::string& file) {
  LogReader log(file);
  log.load_only({channels::kOdometry, channels::kFixtureDetections});
  DriveLog drive;
  LogEvent event;
  while (log.next(event)) {
    if (event.channel == channels::kOdometry) {
      odometry_t message{};
      if (message.decode(event.data.data(), 0, static_cast<int>(event.data.size())) > 0 && is_possible(message) &&
          (drive.odometry.empty() || message.utime > drive.odometry.back().utime)) {
        drive.odometry.push_back(
            {message.utime, message.session, odom_from_robot(message), message.linear, message.angular});
      }
    } else if (event.channel == channels::kFixtureDetections) {
      fixture_detections_t message{};
      if (message.decode(event.data.data(), 0, static_cast<int>(event.data.size())) > 0) {
        drive.frames.push_back(to_frame(message));
      }
    }
  }
  drive.is_cut = log.is_cut();
  // a stamp from the future must not hold up the frames behind it
  std::stable_sort(drive.frames.begin(), drive.frames.end(),
                   [](const SightingFrame& a, const SightingFrame& b) { return a.utime < b.utime; });
  return drive;
}

FollowedDrive follow_drive(const DriveLog& log, const LocalizerConfig& config, double spacing, double turn) {
  LocalizerConfig modern = config;
  modern.mode = LocalizerMode::kModern;
  const std::unique_ptr<Localizer> localizer = make_localizer(modern);
  const FixtureMap map(config.building.fixtures);
  const CeilingView view(config.robot.camera);
  const std::vector<OdometryReading> odometry = corrected(log.odometry, config);
  const auto offset = static_cast<std::int64_t>(std::lround(1e6 * config.robot.camera.time_offset));
  FollowedDrive followed;
  std::vector<Pose2> steps;  // as the wheels told them, since the frame kept last
  Pose2 told_at;             // where the last of them ended
  Pose2 kept_at;
  bool has_kept = false;
  std::size_t next_frame = 0;
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    const OdometryReading& now = odometry[i];
    const OdometryReading& before = odometry[i > 0 ? i - 1 : 0];
    if (i == 0 || now.session != before.session) {
      steps.clear();
      told_at = log.odometry[i].odom_from_robot;
      has_kept = false;
    }
    // Frames reach the localizer with the odometry after them. What it believes then is carried back to each.
    const std::vector<SightingFrame> arrived = take_frames(log, offset, before.utime, now.utime, next_frame);
    for (const SightingFrame& frame : arrived) {
      localizer->add_frame(frame);
    }
    localizer->add_odometry(now);
    const LocalizerEstimate estimate = localizer->estimate();
    for (const SightingFrame& raw : arrived) {
      const OdometryReading at = interpolate(before, now, raw.utime);
      const Pose2 since = kept_at.inverse() * at.odom_from_robot;
      const bool is_apart = !has_kept || std::hypot(since.x, since.y) > spacing || std::abs(since.theta) > turn;
      if (estimate.state != LocalizerState::kTracking) {
        ++followed.unused.not_tracking;
        continue;
      }
      if (raw.sightings.empty() || !is_apart) {
        ++(raw.sightings.empty() ? followed.unused.without_fixture : followed.unused.too_near);
        continue;
      }
      const Pose2 pose = estimate.belief.pose * now.odom_from_robot.inverse() * at.odom_from_robot;
      std::vector<KnownSighting> sightings = recognise(raw, at, pose, map, view, config.building.ceiling_height);
      if (sightings.empty()) {
        ++followed.unused.without_fixture;
        continue;
      }
      const Pose2 told = interpolate(log.odometry[i - 1], log.odometry[i], raw.utime).odom_from_robot;
      steps.push_back(told_at.inverse() * told);
      told_at = told;
      followed.frames.push_back({at, pose, std::move(sightings), has_kept ? steps : std::vector<Pose2>{}});
      steps.clear();
      kept_at = at.odom_from_robot;
      has_kept = true;
    }
    steps.push_back(told_at.inverse() * log.odometry[i].odom_from_robot);
    told_at = log.odometry[i].odom_from_robot;
  }
  return followed;
}

}  // namespace luminav
