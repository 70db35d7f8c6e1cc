#include "services/localizer/tracking/tracking_filter.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

namespace luminav {
namespace {

constexpr double kWheelWalk = 0.0005;  // [fraction per sqrt m] of scale and turn: tyres and floors differ in places
constexpr double kDriftWalk = 0.001;   // [rad/m per sqrt m] of the heading's drift per metre
constexpr int kMaxIterations = 5;      // of a correction ...
constexpr double kSettled = 0.01;      // [m, rad] ... until it moves the state by less
constexpr double kFloorLength = 1.0;   // [m] over which the floor's tilt changes

double squared(double value) {
  return value * value;
}

Pose2 displaced(const Fixture& fixture, const FixtureOffset& offset) {
  const Pose2& place = fixture.world_from_fixture;
  return {place.x + offset.mean.x(), place.y + offset.mean.y(), place.theta + offset.mean.z()};
}

}  // namespace

TrackingFilter::TrackingFilter(double height_above_camera, const Eigen::Vector2d& robot_from_camera, double wheel_base,
                               const ErrorParams& errors)
    : height_above_camera_(height_above_camera),
      robot_from_camera_(robot_from_camera),
      wheel_base_(wheel_base),
      errors_(errors) {
  // What was learnt of the robot outlives a new start of the pose.
  covariance_.setZero();
  covariance_(kScale, kScale) = squared(errors.wheel_scale);
  covariance_(kDrift, kDrift) = squared(errors.wheel_ratio / wheel_base);
  covariance_(kTurn, kTurn) = squared(errors.wheel_scale) + squared(errors.wheel_base);
  covariance_(kScale, kTurn) = covariance_(kTurn, kScale) = squared(errors.wheel_scale);
  covariance_(kTilt, kTilt) = covariance_(kTilt + 1, kTilt + 1) = squared(errors.camera_tilt);
  covariance_(kYaw, kYaw) = squared(errors.camera_yaw);
  covariance_(kCameraScale, kCameraScale) = squared(errors.camera_scale);
  covariance_(kTime, kTime) = squared(errors.camera_time_offset);
  covariance_(kFloor, kFloor) = covariance_(kFloor + 1, kFloor + 1) = squared(errors.floor_tilt);
  covariance_(kLens, kLens) = squared(errors.lens_residual);
}

void TrackingFilter::start(const PoseBelief& belief) {
  const auto forget = [&](int first, int count) {
    covariance_.middleRows(first, count).setZero();
    covariance_.middleCols(first, count).setZero();
  };
  forget(0, 3);
  forget(kFixtures, 3 * kSlots);
  state_.tail<3 * kSlots>().setZero();
  state_.head<3>() << belief.pose.x, belief.pose.y, belief.pose.theta;
  covariance_.topLeftCorner<3, 3>() = belief.covariance;
  linearised_ = belief.pose;
  slots_ = {};
  unsure_.clear();  // another pose would tell other places
  doubted_.clear();
}

Pose2 TrackingFilter::corrected(const Pose2& delta) const {
  const double forward = delta.x >= 0.0 ? 1.0 : -1.0;
  const double distance = forward * std::hypot(delta.x, delta.y);
  const double scale = 1.0 + state_(kScale);
  const double extra = state_(kTurn) * delta.theta + state_(kDrift) * distance;
  const double c = std::cos(0.5 * extra);
  const double s = std::sin(0.5 * extra);
  return {scale * (c * delta.x - s * delta.y), scale * (s * delta.x + c * delta.y), wrap_angle(delta.theta + extra)};
}

PoseBelief TrackingFilter::belief() const {
  return {{state_(0), state_(1), wrap_angle(state_(2))}, covariance_.topLeftCorner<3, 3>()};
}

PoseBelief TrackingFilter::belief_after(const Pose2& delta) const {
  TrackingFilter ahead = *this;
  ahead.predict(delta);
  return ahead.belief();
}

void TrackingFilter::bridge(const Pose2& step, const Eigen::Matrix3d& noise) {
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(state_(2), Eigen::Vector3d::UnitZ()).toRotationMatrix();  // the same for (x, y, theta)
  predict(step);
  covariance_.topLeftCorner<3, 3>() += rotation * noise * rotation.transpose();
}

void TrackingFilter::predict(const Pose2& delta) {
  const Pose2 step = corrected(delta);
  const Pose2 before{state_(0), state_(1), state_(2)};
  const double forward = delta.x >= 0.0 ? 1.0 : -1.0;
  const double distance = std::hypot(delta.x, delta.y);
  const Pose2 after = before * step;
  const double dx = after.x - before.x;
  const double dy = after.y - before.y;

  // d(pose after) / d(pose, scale, drift, turn)
  Eigen::Matrix<double, 3, 6> f = Eigen::Matrix<double, 3, 6>::Zero();
  f.leftCols<3>().setIdentity();
  f(0, 2) = -(after.y - linearised_.y);
  f(1, 2) = after.x - linearised_.x;
  f(0, 3) = dx / (1.0 + state_(kScale));
  f(1, 3) = dy / (1.0 + state_(kScale));
  f(2, 4) = forward * distance;
  f(0, 4) = -0.5 * dy * f(2, 4);
  f(1, 4) = 0.5 * dx * f(2, 4);
  f(2, 5) = delta.theta;
  f(0, 5) = -0.5 * dy * delta.theta;
  f(1, 5) = 0.5 * dx * delta.theta;

  const Eigen::Matrix<double, 3, kSize> rows = f * covariance_.topRows<6>();
  const Eigen::Matrix3d corner = rows.leftCols<6>() * f.transpose();
  const double c = std::cos(before.theta);
  const double s = std::sin(before.theta);
  Eigen::Matrix3d rotation;
  rotation << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
  covariance_.topRows<3>() = rows;
  covariance_.leftCols<3>() = rows.transpose();
  covariance_.topLeftCorner<3, 3>() = 0.5 * (corner + corner.transpose()) +
                                      rotation * odometry_noise(delta, wheel_base_, errors_) * rotation.transpose();
  state_.head<3>() << after.x, after.y, after.theta;
  linearised_ = after;

  const double noisy_distance = noise_distance(delta, wheel_base_);
  covariance_(kScale, kScale) += squared(kWheelWalk) * noisy_distance;
  covariance_(kDrift, kDrift) += squared(kDriftWalk) * noisy_distance;
  covariance_(kTurn, kTurn) += squared(kWheelWalk) * noisy_distance;
  // first-order Gauss-Markov process in space, stationary at floor_tilt
  const double keep = std::exp(-distance / kFloorLength);
  state_.segment<2>(kFloor) *= keep;
  covariance_.middleRows<2>(kFloor) *= keep;
  covariance_.middleCols<2>(kFloor) *= keep;
  covariance_(kFloor, kFloor) += (1.0 - keep * keep) * squared(errors_.floor_tilt);
  covariance_(kFloor + 1, kFloor + 1) += (1.0 - keep * keep) * squared(errors_.floor_tilt);
}

void TrackingFilter::mix_in(const TrackingFilter& other, double probability) {
  State apart = other.state_ - state_;
  apart(2) = wrap_angle(apart(2));
  state_ += probability * apart;
  state_(2) = wrap_angle(state_(2));
  covariance_ +=
      probability * (other.covariance_ - covariance_) + probability * (1.0 - probability) * apart * apart.transpose();
  linearised_ = {state_(0), state_(1), state_(2)};
  for (Slot& slot : slots_) {
    slot.linearised.reset();
  }
}

int TrackingFilter::slot_of(int fixture) const {
  for (int i = 0; i < kSlots; ++i) {
    if (slots_[static_cast<std::size_t>(i)].fixture == fixture) {
      return i;
    }
  }
  return -1;
}

int TrackingFilter::take_slot(int fixture, double odometer) {
  int slot = slot_of(fixture);
  if (slot < 0) {
    const auto oldest = std::min_element(slots_.begin(), slots_.end(), [](const Slot& a, const Slot& b) {
      return (a.fixture < 0 ? -1.0 : a.odometer) < (b.fixture < 0 ? -1.0 : b.odometer);
    });
    slot = static_cast<int>(oldest - slots_.begin());
    const FixtureOffset prior = offset_of(fixture);
    if (const auto leaving = unsure_.find(oldest->fixture); leaving != unsure_.end()) {
      leaving->second = offset_of(leaving->first);
    }
    *oldest = {fixture, odometer, {}};
    const int first = kFixtures + 3 * slot;
    state_.segment<3>(first) = prior.mean;
    covariance_.middleRows<3>(first).setZero();
    covariance_.middleCols<3>(first).setZero();
    covariance_.block<3, 3>(first, first) = prior.covariance;
  }
  slots_[static_cast<std::size_t>(slot)].odometer = odometer;
  return slot;
}

FixtureOffset TrackingFilter::offset_of(int fixture) const {
  if (const int slot = slot_of(fixture); slot >= 0) {
    const int first = kFixtures + 3 * slot;
    return {state_.segment<3>(first), covariance_.block<3, 3>(first, first)};
  }
  if (const auto known = unsure_.find(fixture); known != unsure_.end()) {
    return known->second;
  }
  FixtureOffset prior;
  prior.covariance.diagonal() << squared(errors_.fixture_position), squared(errors_.fixture_position),
      squared(errors_.fixture_heading);
  return prior;
}

bool TrackingFilter::has_in_view(int fixture, double odometer) const {
  constexpr double kInView = 0.5;  // [m]
  const int slot = slot_of(fixture);
  return slot >= 0 && odometer - slots_[static_cast<std::size_t>(slot)].odometer < kInView;
}

void TrackingFilter::widen_place(int fixture, const Eigen::Vector3d& variances) {
  unsure_.try_emplace(fixture, offset_of(fixture)).first->second.covariance.diagonal() += variances;
  if (const int slot = slot_of(fixture); slot >= 0) {
    covariance_.diagonal().segment<3>(kFixtures + 3 * slot) += variances;
    slots_[static_cast<std::size_t>(slot)].linearised.reset();
  }
}

void TrackingFilter::doubt(int fixture) {
  if (doubted_.insert(fixture).second) {
    widen_place(fixture, FixtureMap::doubt_variance());
  }
}

TrackingFilter::Expectation TrackingFilter::expect(const FixtureSighting& sighting, int index, const Fixture& fixture,
                                                   int slot, double linear, double angular) const {
  const FixtureOffset offset = offset_of(index);
  const Pose2 world_from_fixture = displaced(fixture, offset);
  const Pose2 pose{state_(0), state_(1), state_(2)};
  const ExpectedSighting ideal = expect_sighting(pose, world_from_fixture);
  const std::optional<Pose2> held = slot < 0 ? std::nullopt : slots_[static_cast<std::size_t>(slot)].linearised;
  const Eigen::Matrix3d by_pose = expect_sighting(linearised_, held.value_or(world_from_fixture)).jacobian;
  const double x = ideal.robot_from_fixture.x;
  const double y = ideal.robot_from_fixture.y;
  // Each error shifts the ceiling's picture by a field over the ceiling; what the field does to the fixture's heading
  // is its derivative along the long side, seen across it, and to a square's the mean of both sides'.
  const double h = height_above_camera_;
  const Eigen::Vector2d p = (ideal.robot_from_fixture.position() - robot_from_camera_) / h;
  const Eigen::Vector2d axis(std::cos(ideal.robot_from_fixture.theta), std::sin(ideal.robot_from_fixture.theta));
  const Eigen::Vector2d across_axis(axis.y(), -axis.x());
  const double along = p.dot(axis);
  const double across = -p.dot(across_axis);
  const Eigen::Vector3d by_yaw(-h * p.y(), h * p.x(), 1.0);
  const Eigen::Vector3d by_scale(h * p.x(), h * p.y(), 0.0);
  const Eigen::Vector3d by_time(-linear + angular * y, -angular * x, -angular);
  const double of_width = fixture.shape == FixtureShape::kSquare ? 0.5 : 0.0;
  const Eigen::Vector2d by_tilt = (1.0 - of_width) * across * axis + of_width * along * across_axis;  // of the heading
  const Eigen::Vector3d by_tilt_x(h * (1.0 + p.x() * p.x()), h * p.x() * p.y(), by_tilt.x());
  const Eigen::Vector3d by_tilt_y(h * p.x() * p.y(), h * (1.0 + p.y() * p.y()), by_tilt.y());
  const Eigen::Vector3d by_lens(h * p.squaredNorm() * p.x(), h * p.squaredNorm() * p.y(),
                                2.0 * (1.0 - 2.0 * of_width) * along * across);
  const double tilt_x = state_(kTilt) + state_(kFloor);
  const double tilt_y = state_(kTilt + 1) + state_(kFloor + 1);
  const Eigen::Vector3d shift = tilt_x * by_tilt_x + tilt_y * by_tilt_y + state_(kYaw) * by_yaw +
                                state_(kCameraScale) * by_scale + state_(kTime) * by_time + state_(kLens) * by_lens;
  const Pose2 expected{x + shift.x(), y + shift.y(), wrap_angle(ideal.robot_from_fixture.theta + shift.z())};

  Expectation expectation;
  expectation.residual = sighting_residual(sighting, expected, fixture.shape);
  expectation.jacobian.setZero();
  expectation.jacobian.leftCols<3>() = by_pose;
  expectation.jacobian.col(kTilt) = expectation.jacobian.col(kFloor) = by_tilt_x;
  expectation.jacobian.col(kTilt + 1) = expectation.jacobian.col(kFloor + 1) = by_tilt_y;
  expectation.jacobian.col(kYaw) = by_yaw;
  expectation.jacobian.col(kCameraScale) = by_scale;
  expectation.jacobian.col(kTime) = by_time;
  expectation.jacobian.col(kLens) = by_lens;
  expectation.noise = white_sighting_covariance(sighting, fixture, errors_);
  // the fixture's place moves the picture as the robot's moves it back; its heading turns it about its own centre
  Eigen::Matrix3d by_fixture = Eigen::Matrix3d::Zero();
  by_fixture.leftCols<2>() = -by_pose.leftCols<2>();
  by_fixture(2, 2) = 1.0;
  if (slot >= 0) {
    expectation.jacobian.middleCols<3>(kFixtures + 3 * slot) = by_fixture;
  } else {
    expectation.noise += by_fixture * offset.covariance * by_fixture.transpose();
  }
  return expectation;
}

Innovation TrackingFilter::innovate(const FixtureSighting& sighting, int index, const Fixture& fixture, double linear,
                                    double angular) const {
  const Expectation expectation = expect(sighting, index, fixture, slot_of(index), linear, angular);
  Innovation innovation;
  innovation.residual = expectation.residual;
  innovation.covariance = expectation.jacobian * covariance_ * expectation.jacobian.transpose() + expectation.noise;
  innovation.nis = innovation.residual.dot(innovation.covariance.inverse() * innovation.residual);
  return innovation;
}

double TrackingFilter::correct(const FixtureSighting& sighting, int index, const Fixture& fixture, double linear,
                               double angular, double odometer) {
  const int slot = take_slot(index, odometer);
  std::optional<Pose2>& linearised = slots_[static_cast<std::size_t>(slot)].linearised;
  const bool may_linearise_anew = !linearised || !unsure_.contains(index);
  const State before = state_;
  Expectation expectation;
  Eigen::Matrix<double, kSize, 3> cross, gain;
  Eigen::Matrix3d innovation;
  double nis = 0.0;
  // Iterated (Bell and Cathey 1993), as long as what was linearised elsewhere before does not forbid it.
  for (int i = 0; i < kMaxIterations; ++i) {
    expectation = expect(sighting, index, fixture, slot, linear, angular);
    expectation.noise += covariance_shared_by_pass(sighting, fixture);
    cross = covariance_ * expectation.jacobian.transpose();
    innovation = expectation.jacobian * cross + expectation.noise;
    const Eigen::Matrix3d inverse = innovation.inverse();
    gain = cross * inverse;
    const Eigen::Vector3d residual = expectation.residual - expectation.jacobian * (before - state_);
    nis = i == 0 ? residual.dot(inverse * residual) : nis;
    const State corrected = before + gain * residual;
    const double moved = (corrected - state_).lpNorm<Eigen::Infinity>();
    state_ = corrected;
    if (!may_linearise_anew || moved < kSettled) {
      break;
    }
    linearised_ = {state_(0), state_(1), state_(2)};
    linearised.reset();
  }
  if (!linearised) {
    linearised = displaced(fixture, offset_of(index));
  }
  // P - K H P - P H' K' + K S K', which rounding leaves positive
  const Covariance reduction = gain * cross.transpose();
  covariance_ += gain * innovation * gain.transpose() - reduction - reduction.transpose();
  covariance_ = 0.5 * (covariance_ + covariance_.transpose()).eval();
  state_(2) = wrap_angle(state_(2));
  return nis;
}

}  // namespace luminav
