#include "tests/evaluation/sensing/geometric_sensing.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/camera/truth_message.hpp"
#include "services/common/process/channels.hpp"
#include "tests/evaluation/sensing/sensing_survey.hpp"

namespace luminav {
namespace {

// As the simulated camera has them.
constexpr double kRate = 15.0;                 // [frames/s]
constexpr double kFirstFrame = 50'000.0;       // [us] after the camera was plugged in
constexpr double kDelay = 40'000.0 + 4'000.0;  // [us] transfer and half an exposure
constexpr double kMinShare = 0.03;

}  // namespace

GeometricSensing::GeometricSensing(lcm::LCM& lcm, const WorldTruth& world, const Building& believed,
                                   const CameraDescription& believed_camera, const DetectorBehaviour& behaviour,
                                   std::uint64_t seed)
    : lcm_(lcm),
      world_(world),
      believed_(believed.fixtures),
      ceiling_height_(believed.ceiling_height),
      believed_camera_(believed_camera.intrinsics, believed_camera.mounting),
      behaviour_(behaviour),
      viewer_(world, believed, believed_camera),
      light_(world_.building, seed),
      random_(seed, "geometric sensing"),
      stamp_offset_(-std::llround(1e6 * world.robot.camera.time_offset)),
      frame_time_(1e6 * world.robot.camera.row_time * world.robot.camera.intrinsics.height) {
  message_.width = believed_camera.intrinsics.width;
  message_.height = believed_camera.intrinsics.height;
  message_.median_grey = 100.0;
}

void GeometricSensing::on_truth(const sim_truth_t& truth) {
  simulated::TruthSample sample = truth_sample(truth);
  if (sample.lamps != lamps_) {
    lamps_ = sample.lamps;
    light_.set(truth.daylight, lamps_);
  }
  sample.lamps.clear();  // what is kept of each moment is small
  const bool unplugged = sample.camera_unplugged;
  if (!truth_.add(sample)) {
    return;
  }
  if (unplugged) {
    running_ = false;
    last_pose_.reset();
    return;
  }
  if (!running_) {
    running_ = true;
    first_middle_ = std::round(static_cast<double>(truth.utime) + 0.5 * frame_time_ + kFirstFrame);
    first_number_ = number_;
  }
  while (true) {
    const double middle = first_middle_ + std::round(static_cast<double>(number_ - first_number_) * 1e6 / kRate);
    if (static_cast<double>(truth.utime) < middle + 0.5 * frame_time_ + kDelay) {
      return;
    }
    publish_frame(middle);
    ++number_;
  }
}

void GeometricSensing::publish_frame(double middle) {
  const auto moment = moment_at(truth_, middle, frame_time_);
  if (!moment) {
    return;
  }
  const Pose2& pose = moment->pose.world_from_robot;
  const int motion = last_pose_ ? motion_class(*last_pose_, pose) : kMotionClasses - 1;
  last_pose_ = pose;
  message_.utime = std::llround(middle) + stamp_offset_;
  message_.sequence = static_cast<std::int32_t>(number_);
  message_.detections.clear();
  viewer_.look(*moment, truth_.newest().moved, kMinShare, views_);
  for (const FixtureView& view : views_) {
    see_fixture(view, middle, moment->angular, motion);
  }
  raise_false_alarms(pose);
  message_.count = static_cast<std::int32_t>(message_.detections.size());
  lcm_.publish(channels::kFixtureDetections, &message_);
}

void GeometricSensing::see_fixture(const FixtureView& view, double middle, double angular, int motion) {
  const bool burns = light_.emission(static_cast<int>(view.index), middle) > 0.0;
  const bool half = light_.lamp(static_cast<int>(view.index)) == simulated::LampState::kHalf;
  const SightingClass sighting = class_of(world_.building.fixtures[view.index].shape,
                                          light_of(burns, half, world_.unlit_darker[view.index]), view, angular);
  // The same number of draws whatever happens, so that runs stay alike as long as they can.
  const double keep_seen = random_.uniform();
  const double keep_error = random_.uniform();
  const double seen = random_.uniform();
  const double error = random_.uniform();
  Luck& luck = lucks_[view.index];
  const bool was_there = luck.frame + 1 == number_ && luck.frame >= 0;
  const auto m = static_cast<std::size_t>(motion);
  if (!was_there || keep_seen >= behaviour_.keep_seen[m]) {
    luck.seen = seen;
  }
  if (!was_there || keep_error >= behaviour_.keep_error[m]) {
    luck.error = error;
  }
  luck.frame = number_;
  if (luck.seen >= behaviour_.seen_probability(sighting)) {
    return;
  }
  const auto& errors = behaviour_.errors(sighting);
  if (!errors.empty()) {
    report(view, errors[static_cast<std::size_t>(luck.error * static_cast<double>(errors.size()))]);
  }
}

std::optional<Eigen::Vector2d> GeometricSensing::pixel_of(const Eigen::Vector2d& point, double height) const {
  return believed_camera_.pixel_of_ceiling_point(point, height);
}

void GeometricSensing::report(const FixtureView& view, const MeasuredSighting& measured) {
  const Fixture& fixture = believed_[view.index];
  const bool bar = fixture.shape == FixtureShape::kRectangle;
  const double side = view.near_end && !view.far_end ? -1.0 : 1.0;  // errors are kept as if the far end were the one
  bool near_end = side > 0.0 ? measured.near_end : measured.far_end;
  bool far_end = side > 0.0 ? measured.far_end : measured.near_end;
  const Pose2 exact = bar ? view.robot_from_fixture(near_end, far_end) : view.robot_from_fixture(true, true);
  const Eigen::Vector2d centre = exact * Eigen::Vector2d(side * measured.along, side * measured.across);
  const double theta = exact.theta + measured.turn;
  fixture_detection_t detection{};
  detection.shape = static_cast<std::int8_t>(fixture.shape);
  detection.state = static_cast<std::int8_t>(measured.state);
  detection.has_theta = fixture.shape != FixtureShape::kRound ? 1 : 0;
  detection.x = centre.x();
  detection.y = centre.y();
  detection.theta = wrap_modulo(theta, symmetry_period(fixture.shape));
  if (bar && std::abs(wrap_angle(detection.theta - theta)) > 0.5 * kPi) {
    std::swap(near_end, far_end);
  }
  const double c = std::cos(exact.theta);
  const double s = std::sin(exact.theta);
  Eigen::Matrix3d to_robot;
  to_robot << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  covariance(0, 0) = measured.sigma_along * measured.sigma_along;
  covariance(1, 1) = measured.sigma_across * measured.sigma_across;
  covariance(2, 2) = measured.sigma_turn * measured.sigma_turn;
  covariance(1, 2) = covariance(2, 1) =
      std::clamp(measured.correlation, -0.999, 0.999) * measured.sigma_across * measured.sigma_turn;
  covariance = to_robot * covariance * to_robot.transpose();
  for (int i = 0; i < 9; ++i) {
    detection.covariance[i] = covariance(i / 3, i % 3);
  }
  detection.length = std::max(0.02, view.seen_to - view.seen_from + measured.length);
  detection.width = std::max(0.02, fixture.width + measured.width);
  detection.clipped = measured.clipped ? 1 : 0;
  detection.near_end_visible = near_end ? 1 : 0;
  detection.far_end_visible = far_end ? 1 : 0;
  detection.fit = measured.fit;
  const Pose2 pose{detection.x, detection.y, detection.theta};
  const auto set_pixel = [&](float* where, const Eigen::Vector2d& point) {
    const auto pixel = pixel_of(pose * point, fixture.height);
    where[0] = pixel ? static_cast<float>(pixel->x()) : -1.0F;
    where[1] = pixel ? static_cast<float>(pixel->y()) : -1.0F;
  };
  const double half_length = 0.5 * detection.length;
  const double half_width = 0.5 * fixture.width;
  set_pixel(detection.corners_px, {half_length, half_width});
  set_pixel(detection.corners_px + 2, {-half_length, half_width});
  set_pixel(detection.corners_px + 4, {-half_length, -half_width});
  set_pixel(detection.corners_px + 6, {half_length, -half_width});
  set_pixel(detection.centre_px, {0.0, 0.0});
  message_.detections.push_back(detection);
}

void GeometricSensing::raise_false_alarms(const Pose2& world_from_robot) {
  const auto in_image = [&](const FalseAlarm& alarm) {
    const auto pixel = pixel_of((world_from_robot.inverse() * alarm.world_from_fixture).position(), ceiling_height_);
    return pixel && believed_camera_.is_in_image(*pixel);
  };
  std::erase_if(false_alarms_, [&](const FalseAlarm& alarm) {
    return random_.uniform() >= behaviour_.false_alarms_last || !in_image(alarm);
  });
  const double begins = random_.uniform();
  const double which = random_.uniform();
  if (begins < behaviour_.false_alarms_begin && !behaviour_.false_alarms.empty()) {
    const MeasuredFalseAlarm& measured =
        behaviour_.false_alarms[static_cast<std::size_t>(which * static_cast<double>(behaviour_.false_alarms.size()))];
    false_alarms_.push_back({world_from_robot * measured.robot_from_fixture, &measured});
  }
  for (const FalseAlarm& alarm : false_alarms_) {
    const MeasuredFalseAlarm& measured = *alarm.measured;
    const Pose2 pose = world_from_robot.inverse() * alarm.world_from_fixture;
    const double turned = wrap_angle(pose.theta - measured.robot_from_fixture.theta);
    Eigen::Matrix3d covariance;
    for (std::size_t i = 0; i < 9; ++i) {
      covariance(static_cast<int>(i / 3), static_cast<int>(i % 3)) = measured.covariance[i];
    }
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    turn.topLeftCorner<2, 2>() << std::cos(turned), -std::sin(turned), std::sin(turned), std::cos(turned);
    covariance = turn * covariance * turn.transpose();
    fixture_detection_t detection{};
    detection.shape = static_cast<std::int8_t>(measured.shape);
    detection.state = static_cast<std::int8_t>(measured.state);
    detection.has_theta = measured.shape != fixture_detection_t::SHAPE_ROUND ? 1 : 0;
    detection.x = pose.x;
    detection.y = pose.y;
    detection.theta = pose.theta;
    for (int i = 0; i < 9; ++i) {
      detection.covariance[i] = covariance(i / 3, i % 3);
    }
    detection.length = measured.length;
    detection.width = measured.width;
    detection.fit = measured.fit;
    detection.clipped = measured.clipped ? 1 : 0;
    detection.near_end_visible = measured.near_end ? 1 : 0;
    detection.far_end_visible = measured.far_end ? 1 : 0;
    message_.detections.push_back(detection);
  }
}

}  // namespace luminav
