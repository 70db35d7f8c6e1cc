#include "services/detector/coarse_glance.hpp"

#include <array>
#include <cmath>

#include "services/detector/pixel_sampling.hpp"
#include "services/detector/profile_lanes.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kPoints = ProfileLanes::kLanes;  // of a side
constexpr int kLeastFactor = 4;                        // [px] of a cell
constexpr double kStep = 0.5;                          // [cells] from one sample to the next
constexpr int kReach = 7;                              // samples to each side: 14 px, as far as a fit looks
constexpr int kHalfFilter = 2;                         // samples whose means are compared
constexpr double kUsable = 0.8;                        // of a side: its corners are rounded
constexpr int kLeastInView = 5;                        // points
// Rendered frames of two buildings: these refute half of the guesses that have no edges, and of those that prove to be
// something none that is unlit and 5 of 1,765 lit ones, which are found by another guess; where every second point must
// show a full step, one of 150 unlit ones is lost.
constexpr double kShareOfStep = 0.7;  // that the cells, and samples between them, must show of the step asked for
constexpr double kLeastShare = 0.4;   // of the points in view that must show an edge

/// The side to the left (1) or to the right (-1).
bool may_have_edges(const CeilingFrame& frame, const CeilingCamera& camera, const Outline& outline,
                    const PointTransform& pose, double side, double least_step) {
  constexpr double kAhead = 0.02;  // [m] to find the normal's direction in the image
  std::array<Vector2d, 2 * kPoints> places;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double along = kUsable * outline.length * ((static_cast<double>(i) + 0.5) / kPoints - 0.5);
    places[2 * i] = pose * Vector2d(along, side * 0.5 * outline.width);
    places[2 * i + 1] = pose * Vector2d(along, side * (0.5 * outline.width + kAhead));
  }
  std::array<Vector2d, 2 * kPoints> pixels;
  camera.pixels_of_ceiling_points(places, outline.height, pixels);
  const GreyView cells{frame.reduced.width, frame.reduced.height, frame.reduced.cells};
  ProfileLanes::Lines lines{};
  std::size_t in_view = 0;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const Vector2d normal = (pixels[2 * i + 1] - pixels[2 * i]).normalized();
    const Vector2d cell = (pixels[2 * i] - Vector2d::Constant(0.5 * (frame.factor - 1))) / frame.factor;
    const Vector2d first = cell - kReach * kStep * normal;
    if (is_sampled(cells, first) && is_sampled(cells, cell + kReach * kStep * normal)) {  // false for no number
      lines.x[in_view] = static_cast<float>(first.x());
      lines.y[in_view] = static_cast<float>(first.y());
      lines.dx[in_view] = static_cast<float>(kStep * normal.x());
      lines.dy[in_view] = static_cast<float>(kStep * normal.y());
      lines.last[in_view] = 2 * kReach;
      ++in_view;
    }
  }
  if (in_view < kLeastInView) {
    return true;
  }
  for (std::size_t i = in_view; i < kPoints; ++i) {  // lanes that nobody reads
    lines.x[i] = lines.x[0];
    lines.y[i] = lines.y[0];
    lines.last[i] = 0;
  }
  ProfileLanes profiles;
  profiles.clear(2 * kReach + 1);
  profiles.add(cells, lines);
  const ProfileLanes::Steps steps = profiles.largest_steps(kHalfFilter, least_step > 0.0 ? 1.0F : -1.0F);
  std::size_t on_edge = 0;
  for (std::size_t i = 0; i < in_view; ++i) {
    on_edge += steps.at[i] >= 0 && steps.height[i] >= kShareOfStep * std::abs(least_step) ? 1 : 0;
  }
  return static_cast<double>(on_edge) >= kLeastShare * static_cast<double>(in_view);
}

}  // namespace

bool may_have_long_sides(const CeilingFrame& frame, const CeilingCamera& camera, const Outline& outline,
                         const Pose2& start, double least_step) {
  if (frame.factor < kLeastFactor || outline.shape == FixtureShape::kRound) {
    return true;
  }
  const PointTransform pose(start);
  return may_have_edges(frame, camera, outline, pose, 1.0, least_step) &&
         may_have_edges(frame, camera, outline, pose, -1.0, least_step);
}

}  // namespace luminav
