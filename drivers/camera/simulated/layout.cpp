#include "drivers/camera/simulated/layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "drivers/camera/simulated/random.hpp"
#include "drivers/camera/simulated/response.hpp"

namespace luminav::simulated {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::uint64_t kHalfPurpose = 5;
constexpr double kEdgePixels = 4.0;  // width of a sharp edge: lens and pixel, 0.9 px 1-sigma
constexpr double kBloomPixels = 12.0;
constexpr double kHaloPixels = 50.0;
constexpr double kLargestThing = 3.0;  // [m] half the diagonal, halo included
constexpr int kPointsPerSide = 4;      // of an outline, because lenses bend its sides

using Outline = std::array<Vector2d, 4 * kPointsPerSide>;

/// Width of a smooth edge after a motion by `travel`: variances add; a smooth step's is width^2 / 20, a box's 1/12.
double widened(double width, double travel) {
  return std::sqrt(width * width + 20.0 / 12.0 * travel * travel);
}

std::vector<Pose2> poses_of(const std::vector<Fixture>& fixtures) {
  std::vector<Pose2> poses;
  for (const Fixture& fixture : fixtures) {
    poses.push_back(fixture.world_from_fixture);
  }
  return poses;
}

std::vector<Vector2d> positions(const std::vector<Pose2>& poses) {
  std::vector<Vector2d> points;
  for (const Pose2& pose : poses) {
    points.push_back(pose.position());
  }
  return points;
}

std::vector<Vector2d> positions(const std::vector<CeilingElement>& elements) {
  std::vector<Vector2d> points;
  for (const CeilingElement& element : elements) {
    points.push_back(element.world_from_element.position());
  }
  return points;
}

Outline rectangle(double half_length, double half_width) {
  const std::array<Vector2d, 4> corners{Vector2d(-half_length, -half_width), Vector2d(half_length, -half_width),
                                        Vector2d(half_length, half_width), Vector2d(-half_length, half_width)};
  Outline outline;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vector2d& a = corners[i / kPointsPerSide];
    const Vector2d& b = corners[(i / kPointsPerSide + 1) % 4];
    outline[i] = a + (b - a) * static_cast<double>(i % kPointsPerSide) / kPointsPerSide;
  }
  return outline;
}

/// Columns that a polygon of pixels covers in a row or, to be safe, up to two rows away; empty when none.
ColumnSpan columns_of(const Outline& polygon, int row, int width) {
  double left = width;
  double right = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& a = polygon[i];
    const Vector2d& b = polygon[(i + 1) % polygon.size()];
    if (std::max(a.y(), b.y()) < row - 2.0 || std::min(a.y(), b.y()) > row + 2.0) {
      continue;
    }
    const double rise = b.y() - a.y();
    for (const double y : {row - 2.0, row + 2.0}) {
      const double share = std::abs(rise) < 1e-6 ? 0.0 : std::clamp((y - a.y()) / rise, 0.0, 1.0);
      const double x = a.x() + share * (b.x() - a.x());
      const double other = std::abs(rise) < 1e-6 ? b.x() : x;
      left = std::min({left, x, other});
      right = std::max({right, x, other});
    }
  }
  return {static_cast<int>(std::clamp(std::floor(left) - 2.0, 0.0, 1.0 * width)),
          static_cast<int>(std::clamp(std::ceil(right) + 3.0, 0.0, 1.0 * width))};
}

Look look_of(const Fixture& fixture, LampState state) {
  if (fixture.shape == FixtureShape::kRound) {
    return state == LampState::kOff ? Look::kUnlitRound : Look::kLitRound;
  }
  switch (state) {
    case LampState::kOff:
      return Look::kUnlitPanel;
    case LampState::kHalf:
      return Look::kHalfPanel;
    case LampState::kOn:
    case LampState::kFlicker:
      break;
  }
  return Look::kLitPanel;
}

}  // namespace

CeilingLayout::CeilingLayout(const CeilingModel& model)
    : model_(model),
      camera_(model.intrinsics, model.mounting),
      fixture_index_(positions(poses_of(model.building.fixtures))),
      element_index_(positions(model.building.elements)),
      world_from_fixture_(poses_of(model.building.fixtures)) {}

void CeilingLayout::set_moved(const std::vector<MovedLamp>& moved) {
  if (moved == moved_) {
    return;
  }
  moved_ = moved;
  world_from_fixture_ = poses_of(model_.building.fixtures);
  farthest_moved_ = 0.0;
  for (const MovedLamp& lamp : moved_) {
    if (lamp.index >= 0 && static_cast<std::size_t>(lamp.index) < world_from_fixture_.size()) {
      Pose2& pose = world_from_fixture_[static_cast<std::size_t>(lamp.index)];
      pose = {pose.x + lamp.dx, pose.y + lamp.dy, wrap_angle(pose.theta + lamp.theta)};
      farthest_moved_ = std::max(farthest_moved_, std::hypot(lamp.dx, lamp.dy));
    }
  }
}

void CeilingLayout::find(const FrameGeometry& frame, const CeilingLight& light, double utime) {
  size_ = 0;
  const double radius = frame.reach * frame.rise + kLargestThing;
  element_index_.near(frame.origin, radius, found_);
  for (const int index : found_) {
    add_element(model_.building.elements[static_cast<std::size_t>(index)], frame);
  }
  fixture_index_.near(frame.origin, radius + farthest_moved_, found_);
  for (const bool lit : {false, true}) {  // lit ones last: their halo lies over all the rest
    for (const int index : found_) {
      const Vector2d offset = world_from_fixture_[static_cast<std::size_t>(index)].position() - frame.origin;
      if ((light.lamp(index) != LampState::kOff) == lit && offset.norm() < radius) {
        add_fixture(index, frame, light, utime);
      }
    }
  }
}

VisibleShape& CeilingLayout::next() {
  if (size_ == visible_.size()) {
    visible_.emplace_back();
  }
  visible_[size_].shape = Shape{};
  return visible_[size_];
}

void CeilingLayout::set_outline(const Pose2& world_from_shape, double length, double width, const FrameGeometry& frame,
                                VisibleShape& visible) const {
  const Vector2d offset = world_from_shape.position() - frame.origin;
  const Vector2d axis(std::cos(world_from_shape.theta), std::sin(world_from_shape.theta));
  Shape& shape = visible.shape;
  shape.x = static_cast<float>(offset.x());
  shape.y = static_cast<float>(offset.y());
  shape.cosine = static_cast<float>(axis.x());
  shape.sine = static_cast<float>(axis.y());
  shape.half_length = static_cast<float>(0.5 * length);
  shape.half_width = static_cast<float>(0.5 * width);
  const double pixel = metres_per_pixel(model_, frame, world_from_shape.position(), visible.height);
  const Vector2d travel = frame.motion + frame.turn * Vector2d(-offset.y(), offset.x());
  shape.edge_along = static_cast<float>(widened(kEdgePixels * pixel, travel.dot(axis)));
  shape.edge_across = static_cast<float>(widened(kEdgePixels * pixel, axis.x() * travel.y() - axis.y() * travel.x()));
  shape.bloom_reach = static_cast<float>(kBloomPixels * pixel);
  shape.halo_reach = static_cast<float>(kHaloPixels * pixel);
}

void CeilingLayout::keep_if_visible(const Pose2& world_from_shape, double margin, const FrameGeometry& frame) {
  VisibleShape& visible = visible_[size_];
  const Matrix3d camera_from_world = (frame.view.world_from_robot * camera_.rotation()).transpose();
  Outline polygon = rectangle(visible.shape.half_length + margin, visible.shape.half_width + margin);
  const int width = model_.intrinsics.width;
  const int height = model_.intrinsics.height;
  double top = height;
  double bottom = -1.0;
  bool beyond_lens = false;  // part of it is where the lens shows nothing: then its place in the picture is not sought
  for (Vector2d& point : polygon) {
    const Vector2d in_world = world_from_shape * point;
    const Vector3d offset(in_world.x() - frame.view.lens.x(), in_world.y() - frame.view.lens.y(),
                          visible.height - frame.view.lens.z());
    const auto pixel = camera_.pixel_of(camera_from_world * offset);
    beyond_lens = beyond_lens || !pixel;
    point = pixel.value_or(Vector2d::Zero());
    top = std::min(top, point.y());
    bottom = std::max(bottom, point.y());
  }
  visible.first_row = beyond_lens ? 0 : static_cast<int>(std::clamp(std::floor(top) - 2.0, 0.0, 1.0 * height));
  const int end_row = beyond_lens ? height : static_cast<int>(std::clamp(std::ceil(bottom) + 3.0, 0.0, 1.0 * height));
  visible.spans.clear();
  bool any = false;
  for (int row = visible.first_row; row < end_row; ++row) {
    visible.spans.push_back(beyond_lens ? ColumnSpan{0, width} : columns_of(polygon, row, width));
    any = any || visible.spans.back().begin < visible.spans.back().end;
  }
  size_ += any ? 1 : 0;
}

void CeilingLayout::add_fixture(int index, const FrameGeometry& frame, const CeilingLight& light, double utime) {
  const auto i = static_cast<std::size_t>(index);
  const Fixture& fixture = model_.building.fixtures[i];
  VisibleShape& visible = next();
  visible.fixture = index;
  visible.height = fixture.height;
  set_outline(world_from_fixture_[i], fixture.length, fixture.width, frame, visible);
  Shape& shape = visible.shape;
  shape.look = look_of(fixture, light.lamp(index));
  const int lamps = std::max(1, fixture.lamps);
  shape.tube_pitch = static_cast<float>(fixture.width / lamps);
  shape.tube_phase = lamps % 2 == 0 ? 0.0F : 0.5F;
  shape.emission = static_cast<float>(light.emission(index, utime));
  shape.darker = static_cast<float>(model_.unlit_darker[i] / SensorResponse::kNominalGrey);
  RandomStream random = random_stream(model_.seed, kHalfPurpose, static_cast<std::uint64_t>(index));
  shape.half_side = random.uniform() < 0.5 ? -1.0F : 1.0F;
  const double fading =
      light.lamp(index) == LampState::kOff ? std::max(shape.edge_along, shape.edge_across) : shape.halo_reach;
  keep_if_visible(world_from_fixture_[i], fading + frame.slack, frame);
}

void CeilingLayout::add_element(const CeilingElement& element, const FrameGeometry& frame) {
  VisibleShape& visible = next();
  visible.fixture = -1;
  visible.height = model_.building.ceiling_height;
  const bool is_disc = element.kind == ElementKind::kDetector || element.kind == ElementKind::kSpeaker;
  set_outline(element.world_from_element, element.length, is_disc ? element.length : element.width, frame, visible);
  Shape& shape = visible.shape;
  shape.look = is_disc ? Look::kDisc : element.kind == ElementKind::kVent ? Look::kVent : Look::kSign;
  shape.darker = element.kind == ElementKind::kDetector ? 0.35F : 0.02F;  // the middle of a disc
  keep_if_visible(element.world_from_element, std::max(shape.edge_along, shape.edge_across) + frame.slack, frame);
}

}  // namespace luminav::simulated
