#include "tests/evaluation/detector_score/frame_judgement.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace luminav::score {
namespace {

using Eigen::Vector2d;
using simulated::LampState;

constexpr double kMinShare = 0.3;
constexpr double kNear = 0.3;        // [m] across: farther ones are others
constexpr double kMaxAcross = 0.03;  // [m] a detection farther off is wrong
constexpr double kMaxAlong = 0.03;   // [m] or 3.5 sigma
constexpr double kMaxHeading = radians(2.0);

DetectionState expected_state(const VisibleFixture& truth) {
  switch (truth.lamp) {
    case LampState::kOff:
      return DetectionState::kUnlit;
    case LampState::kHalf:  // the only tube of a fixture, half burnt, is lit
      return truth.fixture->lamps < 2 ? DetectionState::kLit : DetectionState::kHalf;
    case LampState::kOn:
    case LampState::kFlicker:
      break;
  }
  return DetectionState::kLit;
}

double period_of(const Fixture& fixture) {
  return symmetry_period(fixture.shape);
}

/// Sums up how far a detection is from its fixture; false when too far to be called found.
bool compare(const Detection& detection, VisibleFixture& truth, DetectorScore& score, std::string& complaint) {
  const Pose2& imaged = truth.imaged.as_imaged;
  const Pose2 error = imaged.inverse() * detection.robot_from_fixture;
  const double heading = wrap_modulo(error.theta, period_of(*truth.fixture));
  const Vector2d along(std::cos(imaged.theta), std::sin(imaged.theta));
  const Vector2d across(-along.y(), along.x());
  const auto spread = [&](const Vector2d& direction) {
    return std::sqrt(direction.dot(detection.covariance.topLeftCorner<2, 2>() * direction));
  };
  const std::string figures = fmt::format(
      "off by {:.1f} mm along (sigma {:.1f}), {:.1f} across ({:.1f}), {:.3f} deg ({:.3f}), {:.2f} px; share {:.2f}, "
      "state {} lamp {}, width {:.3f} of {:.2f}, ends {} {}, at {:.0f} {:.0f}",
      1e3 * error.x, 1e3 * spread(along), 1e3 * error.y, 1e3 * spread(across), degrees(heading),
      degrees(std::sqrt(detection.covariance(2, 2))), (detection.centre_px - truth.imaged.centre_px).norm(),
      truth.imaged.share, static_cast<int>(detection.state), static_cast<int>(truth.lamp), detection.width,
      truth.fixture->width, detection.near_end_visible, detection.far_end_visible, detection.centre_px.x(),
      detection.centre_px.y());
  truth.taken = true;
  if (std::abs(error.y) > kMaxAcross || std::abs(heading) > kMaxHeading ||
      std::abs(error.x) > std::max(kMaxAlong, 3.5 * spread(along))) {
    complaint = "wrong: " + figures;
    return false;
  }
  if (truth.lamp != LampState::kFlicker && detection.state != expected_state(truth)) {
    ++score.wrong_state;
    complaint = "state: " + figures;
  }
  score.seen += truth.imaged.share >= kMinShare ? 1 : 0;
  score.plain_seen += truth.is_plain && truth.imaged.share >= kMinShare ? 1 : 0;
  if (truth.imaged.is_whole) {
    ++score.whole_seen;
    ++score.measured;
    const double px = (detection.centre_px - truth.imaged.centre_px).norm();
    score.centre_px2 += px * px;
    score.worst_px = std::max(score.worst_px, px);
    score.heading2 += heading * heading;
    const Pose2 in_robot = truth.imaged.robot_from_fixture.inverse() * detection.robot_from_fixture;
    score.position2 += in_robot.position().squaredNorm();
    score.robot_heading2 += std::pow(wrap_modulo(in_robot.theta, period_of(*truth.fixture)), 2);
  } else {
    ++score.cut_measured;
    score.across2 += error.y * error.y;
    score.cut_heading2 += heading * heading;
  }
  const Eigen::Vector3d difference(detection.robot_from_fixture.x - imaged.x, detection.robot_from_fixture.y - imaged.y,
                                   heading);
  const double normalised = difference.dot(detection.covariance.inverse() * difference) / 3.0;
  score.normalised += normalised;
  score.normalised_along += std::pow(error.x / spread(along), 2);
  score.normalised_across += std::pow(error.y / spread(across), 2);
  score.normalised_heading += heading * heading / detection.covariance(2, 2);
  ++score.normalised_count;
  if (normalised > 5.0 && complaint.empty()) {
    complaint = "far: " + figures;
  }
  return true;
}

bool match(const Detection& detection, std::vector<VisibleFixture>& visible, DetectorScore& score,
           std::string& complaint) {
  VisibleFixture* nearest = nullptr;
  double min = 1e9;
  for (VisibleFixture& truth : visible) {
    const Pose2 error = truth.imaged.as_imaged.inverse() * detection.robot_from_fixture;
    const double apart = error.position().norm();
    if (!truth.taken && std::abs(error.y) < kNear && std::abs(error.x) < 0.6 * truth.fixture->length + kNear &&
        apart < min) {
      nearest = &truth;
      min = apart;
    }
  }
  if (nearest == nullptr) {
    complaint = fmt::format(
        "wrong: nothing there; state {}, {:.2f} x {:.3f} m, clipped {}, ends {} {}, fit {:.2f}, at {:.0f} {:.0f}",
        static_cast<int>(detection.state), detection.length, detection.width, detection.clipped,
        detection.near_end_visible, detection.far_end_visible, detection.fit, detection.centre_px.x(),
        detection.centre_px.y());
    return false;
  }
  return compare(detection, *nearest, score, complaint);
}

}  // namespace

std::vector<std::string> judge(const std::vector<Detection>& detections, std::vector<VisibleFixture>& visible,
                               DetectorScore& score) {
  std::vector<std::string> complaints;
  bool any_whole = false;
  bool any_cut = false;
  for (const VisibleFixture& fixture : visible) {
    score.visible += fixture.imaged.share >= kMinShare ? 1 : 0;
    score.plain += fixture.is_plain && fixture.imaged.share >= kMinShare ? 1 : 0;
    score.whole += fixture.imaged.is_whole ? 1 : 0;
    any_whole = any_whole || fixture.imaged.is_whole;
    any_cut = any_cut || (fixture.imaged.share >= kMinShare && !fixture.imaged.is_whole);
  }
  bool used = false;
  for (const Detection& detection : detections) {
    ++score.reported;
    std::string complaint;
    const bool found = match(detection, visible, score, complaint);
    used = used || found;
    score.wrong += found ? 0 : 1;
    if (!complaint.empty()) {
      complaints.push_back(complaint);
    }
  }
  if (any_cut && !any_whole) {
    ++score.cut_only_frames;
    score.cut_used_frames += used ? 1 : 0;
  }
  for (const VisibleFixture& fixture : visible) {
    if (fixture.imaged.share >= kMinShare && !fixture.taken) {
      complaints.push_back(fmt::format("missed: share {:.2f}, lamp {}, width {:.2f}, at {:.0f} {:.0f}",
                                       fixture.imaged.share, static_cast<int>(fixture.lamp), fixture.fixture->width,
                                       fixture.imaged.centre_px.x(), fixture.imaged.centre_px.y()));
    }
  }
  return complaints;
}

}  // namespace luminav::score
