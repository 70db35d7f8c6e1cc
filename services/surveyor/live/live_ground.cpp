#include "services/surveyor/live/live_ground.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "services/surveyor/survey/key_frames.hpp"

namespace luminav {
namespace {

constexpr double kMargin = 15.0;  // [m] of the grid beyond the path when it is drawn anew,
constexpr double kNarrow = 6.0;   // [m] and what is left of it when it has to be: as far as a sonar hears, and a metre

bool is_before(const OdometryReading& reading, std::int64_t utime) {
  return reading.utime < utime;
}

}  // namespace

void draw(LiveEstimate& estimate, const SurveyLog& log, const SurveyModel& model) {
  const Survey& survey = estimate.survey;
  estimate.path = SurveyedPath(log.drive.odometry, survey.frames, survey.estimate.poses).stops();
  if (!estimate.path.empty()) {
    estimate.map = draw_along(log.drive.echoes, estimate.path, model.robot, geometry_around(estimate.path, kMargin));
  }
}

LiveGround::LiveGround(const SurveyModel& model)
    : model_(model), wheels_(model.wheels), map_(model.robot, geometry_around({SurveyedPath::Stop{}}, kMargin)) {}

void LiveGround::add(const OdometryReading& reading) {
  const std::size_t before = stops_.size();
  go_on(reading);
  if (stops_.size() > before) {
    map_.go_on(stops_.back());
  }
}

void LiveGround::add(const SonarEcho& echo) {
  map_.hear(echo);
}

void LiveGround::go_on(const OdometryReading& reading) {
  const bool is_first = !last_;
  const bool goes_on = last_ && here_ && reading.session == last_->session;
  Pose2 pose;
  if (goes_on) {
    const Pose2 step = last_->odom_from_robot.inverse() * reading.odom_from_robot;
    double distance = 0.0;
    double turn = 0.0;
    WheelCorrection::correct(wheels_.scale, wheels_.ratio, wheels_.base, model_.robot.wheel_base, signed_length(step),
                             step.theta, distance, turn);
    pose = here_->world_from_robot *
           Pose2{distance * std::cos(0.5 * turn), distance * std::sin(0.5 * turn), wrap_angle(turn)};
    since_estimate_ += std::abs(distance);
  }
  last_ = reading;
  if (is_first || goes_on) {
    here_ = SurveyedPath::Stop{reading.utime, 0, pose, reading.angular};
    stops_.push_back(*here_);
  } else {
    here_.reset();
  }
}

void LiveGround::take(LiveEstimate& estimate, const SurveyLog& log) {
  if (!estimate.end || !estimate.map) {
    here_.reset();
    return;
  }
  const auto& [scale, ratio, base] = estimate.survey.estimate.wheels;
  wheels_ = {scale, ratio, base};
  stops_ = std::move(estimate.path);
  map_ = *std::exchange(estimate.map, {});
  ++drawing_;
  since_estimate_ = 0.0;
  // the estimate says where the drive ended then: what was driven since is laid out behind it
  last_.reset();
  const std::vector<OdometryReading>& odometry = log.drive.odometry;
  const std::int64_t end = estimate.end->utime;
  auto reading = std::lower_bound(odometry.begin(), odometry.end(), end, is_before);
  if (reading == odometry.end()) {
    here_.reset();
    return;
  }
  while (!stops_.empty() && stops_.back().utime >= end) {
    stops_.pop_back();
  }
  here_ = SurveyedPath::Stop{end, 0, estimate.world_from_robot, reading->angular};
  last_ = *reading;
  stops_.push_back(*here_);
  for (const SonarEcho& echo : log.drive.echoes) {
    map_.hear(echo);
  }
  map_.go_on(*here_);
  for (++reading; reading != odometry.end() && here_; ++reading) {
    add(*reading);
  }
}

void LiveGround::redraw(const SurveyLog& log) {
  if (!stops_.empty()) {
    map_ = draw_along(log.drive.echoes, stops_, model_.robot, geometry_around(stops_, kMargin));
    ++drawing_;
  }
}

bool LiveGround::is_narrow() const {
  if (!here_) {
    return false;
  }
  const GridGeometry& geometry = map_.grid().geometry;
  const Eigen::Vector2d size = geometry.resolution * Eigen::Vector2d(geometry.columns, geometry.rows);
  const Eigen::Array2d inside = here_->world_from_robot.position() - geometry.origin;
  return std::min(inside.minCoeff(), (size.array() - inside).minCoeff()) < kNarrow;
}

std::vector<Eigen::Vector2d> LiveGround::looks(const std::vector<SightingFrame>& frames) const {
  std::vector<Eigen::Vector2d> looks;
  for (const SightingFrame& frame : frames) {
    const auto stop =
        std::lower_bound(stops_.begin(), stops_.end(), frame.utime,
                         [](const SurveyedPath::Stop& each, std::int64_t utime) { return each.utime < utime; });
    if (stop != stops_.end()) {
      looks.push_back(stop->world_from_robot.position());
    }
  }
  return looks;
}

}  // namespace luminav
