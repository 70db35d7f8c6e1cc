#include "services/surveyor/live/live_ground.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "services/surveyor/survey/key_frames.hpp"

namespace luminav {
namespace {

constexpr double kMargin = 15.0;  // [m] of the grid beyond the path when it is drawn anew,
constexpr double kNarrow = 6.0;   // [m] and what is left of it when it has to be: as far as a sonar hears, and a metre

constexpr double kMaxDeadReckoning = 40.0;  // [m] from an estimate that knows where the drive ended
constexpr double kLookSpacing = 0.2;        // [m] between places from which the ceiling was seen

bool is_before(const OdometryReading& reading, std::int64_t utime) {
  return reading.utime < utime;
}

}  // namespace

void draw(LiveEstimate& estimate, const SurveyLog& log, const SurveyModel& model) {
  const Survey& survey = estimate.survey;
  estimate.path = SurveyedPath(log.drive.odometry, survey.frames, survey.estimate.poses).stops();
  if (!estimate.path.empty()) {
    estimate.map =
        draw_along(log.drive.echoes, estimate.path, model.robot, empty_map(geometry_around(estimate.path, kMargin)));
  }
}

LiveGround::LiveGround(const SurveyModel& model)
    : model_(model), tracker_(model), map_(model.robot, geometry_around({SurveyedPath::Stop{}}, kMargin)) {}

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

void LiveGround::add(const SightingFrame& frame) {
  waiting_.push_back(frame);
  look();
}

void LiveGround::go_on(const OdometryReading& reading) {
  const bool is_first = history_.is_empty();
  const bool goes_on = !is_first && here_ && reading.session == history_.newest().session;
  if (goes_on) {
    tracker_.drive(history_.newest(), reading);
  }
  history_.add(reading);
  if (!is_first && !goes_on) {
    here_.reset();
    return;
  }
  look();
  here_ = SurveyedPath::Stop{reading.utime, 0, tracker_.belief().pose, reading.angular};
  stops_.push_back(*here_);
}

void LiveGround::look() {
  const auto offset = static_cast<std::int64_t>(std::lround(1e6 * model_.robot.camera.time_offset));
  while (!waiting_.empty() && !history_.is_empty() && waiting_.front().utime + offset <= history_.newest().utime) {
    if (const std::optional<OdometryReading> at = history_.at(waiting_.front().utime + offset)) {
      tracker_.look(waiting_.front(), at->odom_from_robot.inverse() * history_.newest().odom_from_robot, at->linear,
                    at->angular);
    }
    waiting_.pop_front();
  }
}

void LiveGround::take(LiveEstimate& estimate, const SurveyLog& log) {
  if (!estimate.end || !estimate.map) {
    if (since_estimate() > kMaxDeadReckoning) {
      here_.reset();
    }
    return;  // the next one may know: what the survey takes for a carry was often none
  }
  stops_ = std::move(estimate.path);
  map_ = *std::exchange(estimate.map, {});
  ++drawing_;
  // the estimate says where the drive ended then: what was driven since is laid out behind it
  const std::int64_t end = estimate.end->utime;
  auto reading = std::lower_bound(log.drive.odometry.begin(), log.drive.odometry.end(), end, is_before);
  if (reading == log.drive.odometry.end()) {
    here_.reset();
    return;
  }
  while (!stops_.empty() && stops_.back().utime >= end) {
    stops_.pop_back();
  }
  tracker_.begin(estimate);
  history_.clear();
  history_.add(*reading);
  here_ = SurveyedPath::Stop{end, 0, estimate.world_from_robot, reading->angular};
  stops_.push_back(*here_);
  for (const SonarEcho& echo : log.drive.echoes) {
    map_.hear(echo);
  }
  map_.go_on(*here_);
  waiting_.clear();
  std::copy_if(log.drive.frames.begin(), log.drive.frames.end(), std::back_inserter(waiting_),
               [end](const SightingFrame& frame) { return frame.utime > end; });
  for (++reading; reading != log.drive.odometry.end() && here_; ++reading) {
    add(*reading);
  }
}

void LiveGround::redraw(const SurveyLog& log) {
  if (!stops_.empty()) {
    map_ = draw_along(log.drive.echoes, stops_, model_.robot, empty_map(geometry_around(stops_, kMargin)));
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
    if (stop != stops_.end() &&
        (looks.empty() || (stop->world_from_robot.position() - looks.back()).norm() >= kLookSpacing)) {
      looks.push_back(stop->world_from_robot.position());
    }
  }
  return looks;
}

}  // namespace luminav
