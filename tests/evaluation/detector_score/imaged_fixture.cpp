#include "tests/evaluation/detector_score/imaged_fixture.hpp"

#include <cmath>
#include <vector>

namespace luminav::score {
namespace {

using Eigen::Vector2d;

/// Pixel of a point of the ceiling: the row that shows it decides where the robot was, so it is found by iteration.
std::optional<Vector2d> pixel_of(const Vector2d& in_world, double height, const FrameMotion& motion,
                                 const CeilingCamera& camera) {
  const int rows = camera.intrinsics().height;
  double row = 0.5 * (rows - 1);
  std::optional<Vector2d> pixel;
  for (int i = 0; i < 6; ++i) {  // a row changes by some px per iteration at first; each one shrinks it 20-fold or more
    const Pose2 robot_from_world = motion.world_from_robot_at(row, rows).inverse();
    pixel = camera.pixel_of_ceiling_point(robot_from_world * in_world, height);
    if (!pixel) {
      return std::nullopt;
    }
    row = pixel->y();
  }
  return pixel;
}

/// The rotation and translation that take `from` to `to` with the least squares (Umeyama 1991, in the plane).
Pose2 rigid_fit(const std::vector<Vector2d>& from, const std::vector<Vector2d>& to) {
  Vector2d from_mean = Vector2d::Zero();
  Vector2d to_mean = Vector2d::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    from_mean += from[i];
    to_mean += to[i];
  }
  from_mean /= static_cast<double>(from.size());
  to_mean /= static_cast<double>(from.size());
  double cosine = 0.0;
  double sine = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Vector2d a = from[i] - from_mean;
    const Vector2d b = to[i] - to_mean;
    cosine += a.dot(b);
    sine += a.x() * b.y() - a.y() * b.x();
  }
  const Pose2 turn{0.0, 0.0, std::atan2(sine, cosine)};
  const Vector2d shift = to_mean - turn * from_mean;
  return {shift.x(), shift.y(), turn.theta};
}

bool is_visible(const std::optional<Vector2d>& pixel, const CeilingCamera& camera) {
  return pixel && camera.is_in_image(*pixel);
}

std::vector<Vector2d> outline_of(const Fixture& fixture) {
  std::vector<Vector2d> outline;
  const bool round = fixture.shape == FixtureShape::kRound;
  const double step = 0.02;  // [m]
  if (round) {
    const int count = static_cast<int>(kPi * fixture.length / step);
    for (int i = 0; i < count; ++i) {
      const double angle = 2.0 * kPi * i / count;
      outline.emplace_back(0.5 * fixture.length * std::cos(angle), 0.5 * fixture.length * std::sin(angle));
    }
    return outline;
  }
  const auto add_sides = [&](double extent, double distance, bool along) {
    const int count = static_cast<int>(extent / step);
    for (int i = 0; i <= count; ++i) {
      const double t = extent * (static_cast<double>(i) / count - 0.5);
      for (const double side : {0.5, -0.5}) {
        outline.emplace_back(along ? t : side * distance, along ? side * distance : t);
      }
    }
  };
  add_sides(fixture.length, fixture.width, true);
  add_sides(fixture.width, fixture.length, false);
  return outline;
}

}  // namespace

Pose2 FrameMotion::world_from_robot_at(double row, int height) const {
  const double dt = (row - 0.5 * (height - 1)) * row_time;
  return {world_from_robot.x + dt * velocity.x(), world_from_robot.y + dt * velocity.y(),
          wrap_angle(world_from_robot.theta + dt * angular)};
}

std::optional<ImagedFixture> image_of(const Fixture& fixture, const FrameMotion& motion, const CeilingCamera& camera) {
  constexpr double kFarthest = 8.0;  // [m] no camera here sees farther along the ceiling
  if ((fixture.world_from_fixture.position() - motion.world_from_robot.position()).norm() > kFarthest) {
    return std::nullopt;
  }
  constexpr int kAlong = 32;
  constexpr int kAcross = 8;
  int inside = 0;
  int all = 0;
  for (int i = 0; i < kAlong; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      const Vector2d place(fixture.length * ((i + 0.5) / kAlong - 0.5), fixture.width * ((j + 0.5) / kAcross - 0.5));
      if (fixture.shape == FixtureShape::kRound && place.norm() > 0.5 * fixture.length) {
        continue;
      }
      ++all;
      inside +=
          is_visible(pixel_of(fixture.world_from_fixture * place, fixture.height, motion, camera), camera) ? 1 : 0;
    }
  }
  if (inside == 0) {
    return std::nullopt;
  }
  ImagedFixture imaged;
  imaged.share = static_cast<double>(inside) / all;
  imaged.is_whole = true;
  std::vector<Vector2d> on_fixture;
  std::vector<Vector2d> in_robot;
  for (const Vector2d& place : outline_of(fixture)) {
    const auto pixel = pixel_of(fixture.world_from_fixture * place, fixture.height, motion, camera);
    if (!is_visible(pixel, camera)) {
      imaged.is_whole = false;
      continue;
    }
    if (const auto seen = camera.point_on_ceiling(*pixel, fixture.height)) {
      on_fixture.push_back(place);
      in_robot.push_back(*seen);
    }
  }
  const int rows = camera.intrinsics().height;
  const auto centre = pixel_of(fixture.world_from_fixture.position(), fixture.height, motion, camera);
  const double centre_row = centre ? centre->y() : 0.5 * (rows - 1);
  imaged.robot_from_fixture = motion.world_from_robot_at(centre_row, rows).inverse() * fixture.world_from_fixture;
  imaged.as_imaged = on_fixture.size() < 8 ? imaged.robot_from_fixture : rigid_fit(on_fixture, in_robot);
  imaged.centre_px = camera.pixel_of_ceiling_point(imaged.as_imaged.position(), fixture.height)
                         .value_or(centre.value_or(Vector2d::Zero()));
  return imaged;
}

}  // namespace luminav::score
