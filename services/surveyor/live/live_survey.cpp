#include "services/surveyor/live/live_survey.hpp"

#include <algorithm>
#include <cmath>

#include "services/surveyor/drive/pose_at.hpp"
#include "services/surveyor/drive/survey_report.hpp"
#include "services/surveyor/survey/straightening.hpp"
#include "services/surveyor/survey/wheel_guess.hpp"

namespace luminav {
namespace {

constexpr double kMinGrowth = 10.0;      // [m] between two estimates,
constexpr double kGrowthShare = 0.2;     // and as a share of the drive,
constexpr double kExploringShare = 0.1;  // or that
constexpr double kSamePlace = 0.5;       // [m] a fixture seen again is that far from its place at most

double step_between(const OdometryReading& before, const OdometryReading& now) {
  return now.session == before.session ? luminav::distance(before.odom_from_robot, now.odom_from_robot) : 0.0;
}

/// Turns the world by quarter turns, so that the first pose looks along x as nearly as may be, and has it begin there.
void begin_at_first_pose(Survey& survey) {
  const Pose2 first = survey.estimate.poses.front();
  const double turn = -0.5 * kPi * std::round(first.theta / (0.5 * kPi));
  transform(survey.estimate, Pose2{0.0, 0.0, turn} * Pose2{-first.x, -first.y, 0.0});
  for (JudgedFixture& fixture : survey.fixtures) {
    fixture.covariance = turned(fixture.covariance, turn);
  }
}

KeyFrame as_key_frame(const OdometryReading& reading) {
  KeyFrame frame;
  frame.utime = reading.utime;
  frame.odom_from_robot = reading.odom_from_robot;
  return frame;
}

/// The first reading of the session that goes on.
const OdometryReading& session_begin(const std::vector<OdometryReading>& odometry) {
  const auto other = std::find_if(odometry.rbegin(), odometry.rend(), [&](const OdometryReading& reading) {
    return reading.session != odometry.back().session;
  });
  return *other.base();
}

/// The drive from a time [us] on.
SurveyDrive drive_since(const SurveyDrive& drive, std::int64_t utime) {
  const auto is_before = [](const auto& entry, std::int64_t time) { return entry.utime < time; };
  SurveyDrive since;
  since.has_lengths = drive.has_lengths;
  since.odometry.assign(std::lower_bound(drive.odometry.begin(), drive.odometry.end(), utime, is_before),
                        drive.odometry.end());
  // in the order they came: a stamp from the future is in nobody's way here
  std::copy_if(drive.frames.begin(), drive.frames.end(), std::back_inserter(since.frames),
               [utime](const SightingFrame& frame) { return frame.utime >= utime; });
  return since;
}

}  // namespace

double driven_distance(const std::vector<OdometryReading>& odometry) {
  double sum = 0.0;
  for (std::size_t i = 1; i < odometry.size(); ++i) {
    sum += step_between(odometry[i - 1], odometry[i]);
  }
  return sum;
}

LiveEstimate live_estimate(Survey survey, const SurveyLog& log, const SurveyModel& model) {
  LiveEstimate result;
  result.survey = std::move(survey);
  begin_at_first_pose(result.survey);
  result.remarks = remarks_on(result.survey, log, model);
  result.distance = driven_distance(log.drive.odometry);
  const OdometryReading& last = log.drive.odometry.back();
  if (const auto pose = pose_at(result.survey.frames, result.survey.estimate.poses, log.drive.odometry, last.utime)) {
    result.end = as_key_frame(last);
    result.world_from_robot = *pose;
  }
  return result;
}

LiveEstimate estimate_so_far(const SurveyLog& log, const SurveyModel& model) {
  return live_estimate(survey_drive(log.drive, model), log, model);
}

void LiveSurvey::add(const OdometryReading& reading) {
  distance_ += last_ ? step_between(*last_, reading) : 0.0;
  last_ = reading;
}

bool LiveSurvey::is_estimate_due() const {
  const double share = is_exploring_ ? kExploringShare : kGrowthShare;
  return distance_ - begun_at_ >= std::max(kMinGrowth, share * begun_at_);
}

LiveSurvey::Tail LiveSurvey::tail_of(const SurveyLog& log) const {
  Tail tail;
  const std::vector<OdometryReading>& odometry = log.drive.odometry;
  if (odometry.empty() || (estimate_ && !estimate_->end)) {
    return tail;
  }
  tail.frames.push_back(estimate_ ? *estimate_->end : as_key_frame(session_begin(odometry)));
  const KeyFrame anchor = tail.frames.front();
  for (KeyFrame& frame :
       choose_key_frames(drive_since(log.drive, anchor.utime), model_.robot.camera, model_.kinds.ceiling_height)) {
    if (frame.part > 0) {
      break;  // odometry began anew: where on the map, nobody knows
    }
    if (tail.frames.size() == 1) {
      frame.steps = {anchor.odom_from_robot.inverse() * frame.odom_from_robot};
    }
    tail.frames.push_back(std::move(frame));
  }
  WheelCorrection wheels = model_.wheels;
  if (estimate_) {
    const auto& [scale, ratio, base] = estimate_->survey.estimate.wheels;
    wheels = {scale, ratio, base};
  }
  tail.poses = dead_reckoning(tail.frames, model_.robot.wheel_base, wheels);
  for (Pose2& pose : tail.poses) {
    pose = (estimate_ ? estimate_->world_from_robot : Pose2{}) * pose;
  }
  tail.passes = find_passes(tail.frames, model_.kinds);
  return tail;
}

void LiveSurvey::add_estimate(LiveMap& map) const {
  const Survey& survey = estimate_->survey;
  map.estimated_distance = estimate_->distance;
  map.remarks = estimate_->remarks;
  for (const Pose2& pose : survey.estimate.poses) {
    map.path.push_back(pose.position());
  }
  for (std::size_t f = 0; f < survey.fixtures.size(); ++f) {
    const SurveyedFixture& fixture = survey.estimate.fixtures[f];
    map.fixtures.push_back(
        {fixture.kind, fixture.world_from_fixture, survey.fixtures[f].covariance.topLeftCorner<2, 2>()});
  }
  for (const ClosureDoubt& doubt : survey.doubts) {
    map.fixtures[static_cast<std::size_t>(doubt.fixture)].is_open = true;
  }
}

void LiveSurvey::add_tail(const Tail& tail, LiveMap& map) const {
  for (const Pose2& pose : tail.poses) {
    map.path.push_back(pose.position());
  }
  for (const FixturePass& pass : tail.passes) {
    const PassSighting& middle = pass.sightings[pass.sightings.size() / 2];
    const Pose2 seen = tail.poses[static_cast<std::size_t>(middle.frame)] * middle.sighting.robot_from_fixture;
    const bool is_known = std::any_of(map.fixtures.begin(), map.fixtures.end(), [&](const LiveFixture& fixture) {
      return fixture.kind == pass.kind && luminav::distance(fixture.world_from_fixture, seen) < kSamePlace;
    });
    if (!is_known) {
      LiveFixture fixture{pass.kind, seen};
      fixture.is_provisional = true;
      map.fixtures.push_back(fixture);
    }
  }
}

LiveMap LiveSurvey::map(const SurveyLog& log) const {
  LiveMap map;
  map.distance = distance_;
  if (estimate_) {
    add_estimate(map);
  }
  const Tail tail = tail_of(log);
  add_tail(tail, map);
  const std::vector<OdometryReading>& odometry = log.drive.odometry;
  if (!odometry.empty()) {
    map.world_from_robot = pose_at(tail.frames, tail.poses, odometry, odometry.back().utime);
  }
  for (const NamedMoment& named : log.places) {
    std::optional<Pose2> pose;
    if (!tail.frames.empty() && named.utime >= tail.frames.front().utime) {
      pose = pose_at(tail.frames, tail.poses, odometry, named.utime);
    } else if (estimate_) {
      pose = pose_at(estimate_->survey.frames, estimate_->survey.estimate.poses, odometry, named.utime);
    }
    if (pose) {
      map.places.push_back({named.name, pose->position()});
    }
  }
  return map;
}

}  // namespace luminav
