#include "services/common/ceiling/detection_conversion.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/process/subscriber.hpp"

namespace luminav {
namespace {

constexpr double kFarthest = 50.0;       // [m] of a sighting from the robot
constexpr double kMaxCovariance = 1e12;  // [m^2] and [rad^2] far beyond what says "unknown"

}  // namespace

bool is_covariance(const double (&values)[9]) {
  return std::all_of(std::begin(values), std::end(values), [](double v) { return std::abs(v) < kMaxCovariance; }) &&
         values[0] > 0.0 && values[4] > 0.0 && values[8] > 0.0 && values[0] * values[4] - values[1] * values[1] >= 0.0;
}

Eigen::Matrix3d to_matrix(const double (&values)[9]) {
  Eigen::Matrix3d matrix;
  for (int i = 0; i < 9; ++i) {
    matrix(i / 3, i % 3) = values[i];
  }
  return 0.5 * (matrix + matrix.transpose());
}

bool is_possible(const fixture_detection_t& d) {
  return all_finite({d.x, d.y, d.theta, d.length, d.width, d.fit}) && is_covariance(d.covariance) &&
         std::hypot(d.x, d.y) < kFarthest && d.length > 0.0 && d.length < 20.0 && d.width > 0.0 && d.width < 20.0;
}

FixtureSighting to_sighting(const fixture_detection_t& detection) {
  FixtureSighting sighting;
  sighting.robot_from_fixture = {detection.x, detection.y, wrap_angle(detection.theta)};
  sighting.covariance = to_matrix(detection.covariance);
  sighting.shape = detection.shape == fixture_detection_t::SHAPE_SQUARE  ? FixtureShape::kSquare
                   : detection.shape == fixture_detection_t::SHAPE_ROUND ? FixtureShape::kRound
                                                                         : FixtureShape::kRectangle;
  sighting.state = detection.state == fixture_detection_t::STATE_LIT     ? SightingState::kLit
                   : detection.state == fixture_detection_t::STATE_UNLIT ? SightingState::kUnlit
                   : detection.state == fixture_detection_t::STATE_HALF  ? SightingState::kHalf
                                                                         : SightingState::kUnknown;
  sighting.has_theta = detection.has_theta != 0;
  sighting.length = detection.length;
  sighting.width = detection.width;
  sighting.clipped = detection.clipped != 0;
  sighting.near_end_visible = detection.near_end_visible != 0;
  sighting.far_end_visible = detection.far_end_visible != 0;
  sighting.fit = detection.fit;
  return sighting;
}

SightingFrame to_frame(const fixture_detections_t& message) {
  SightingFrame frame;
  frame.utime = message.utime;
  for (const fixture_detection_t& detection : message.detections) {
    if (is_possible(detection) && detection.shape != fixture_detection_t::SHAPE_ELEMENT) {
      frame.sightings.push_back(to_sighting(detection));
    }
  }
  return frame;
}

}  // namespace luminav
