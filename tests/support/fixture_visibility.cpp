#include "tests/support/fixture_visibility.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kFarthest = 6.0;     // [m] no camera here sees farther along the ceiling
constexpr double kBeyondView = 0.05;  // [m] slack of the radius outside of which nothing is seen

/// Without a square root: asked for every fixture of a building many times a second.
bool is_near(const Pose2& a, const Pose2& b, double radius) {
  const double dx = a.x - b.x;
  const double dy = a.y - b.y;
  return dx * dx + dy * dy < radius * radius;
}

/// Radius [m] round the robot beyond which the centre of no fixture can be while a part of it is in the image.
double reach_of(const std::vector<Fixture>& fixtures, const CeilingCamera& camera) {
  double reach = 0.0;
  const auto& lens = camera.intrinsics();
  for (const Fixture& fixture : fixtures) {
    const double size = 0.5 * std::hypot(fixture.length, fixture.width);
    for (const double x : {0.0, lens.width - 1.0}) {
      for (const double y : {0.0, lens.height - 1.0}) {
        const auto point = camera.point_on_ceiling({x, y}, fixture.height);
        reach = std::max(reach, point ? point->norm() + size + kBeyondView : kFarthest);
      }
    }
  }
  return std::min(reach, kFarthest);
}

}  // namespace

double visible_share(const Fixture& fixture, const Pose2& world_from_robot, const CeilingCamera& camera) {
  constexpr int kAlong = 13;
  constexpr int kAcross = 3;
  const Pose2 robot_from_fixture = world_from_robot.inverse() * fixture.world_from_fixture;
  int seen = 0;
  for (int i = 0; i < kAlong; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      const Eigen::Vector2d point = robot_from_fixture * Eigen::Vector2d(((i + 0.5) / kAlong - 0.5) * fixture.length,
                                                                         ((j + 0.5) / kAcross - 0.5) * fixture.width);
      const auto pixel = camera.pixel_of_ceiling_point(point, fixture.height);
      seen += pixel && camera.is_in_image(*pixel) ? 1 : 0;
    }
  }
  return static_cast<double>(seen) / (kAlong * kAcross);
}

FixtureVisibility::FixtureVisibility(std::vector<Fixture> fixtures, const CeilingCamera& camera)
    : fixtures_(std::move(fixtures)), camera_(camera), reach_(reach_of(fixtures_, camera)) {}

std::vector<std::size_t> FixtureVisibility::visible_from(const Pose2& world_from_robot, double share) const {
  std::vector<std::size_t> visible;
  for (std::size_t i = 0; i < fixtures_.size(); ++i) {
    if (is_near(fixtures_[i].world_from_fixture, world_from_robot, reach_) &&
        visible_share(fixtures_[i], world_from_robot, camera_) >= share) {
      visible.push_back(i);
    }
  }
  return visible;
}

bool FixtureVisibility::predicts(const Pose2& in_robot, const Fixture& seen, const Pose2& world_from_robot,
                                 const ViewGate& gate) const {
  for (const Fixture& fixture : fixtures_) {
    if (!is_near(fixture.world_from_fixture, world_from_robot, kFarthest)) {
      continue;
    }
    const Pose2 predicted = world_from_robot.inverse() * fixture.world_from_fixture;
    const double turn = wrap_modulo(predicted.theta - in_robot.theta, symmetry_period(seen.shape));
    if (fixture.shape == seen.shape && distance(predicted, in_robot) < gate.distance && std::abs(turn) < gate.turn) {
      return true;
    }
  }
  return false;
}

bool FixtureVisibility::contradicts(const Pose2& truth, const Pose2& belief, const ViewGate& gate) const {
  for (const std::size_t i : visible_from(truth, 0.3)) {
    if (!predicts(truth.inverse() * fixtures_[i].world_from_fixture, fixtures_[i], belief, gate)) {
      return true;
    }
  }
  for (const std::size_t i : visible_from(belief, 0.8)) {
    if (!predicts(belief.inverse() * fixtures_[i].world_from_fixture, fixtures_[i], truth, gate)) {
      return true;
    }
  }
  return false;
}

}  // namespace luminav
