#include "drivers/camera/simulated/layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "drivers/camera/simulated/catalogue/luminaires.hpp"
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

/// Which of two tubes burns in a half lit fixture is drawn: half a turn changes nothing else.
std::vector<Pose2> poses_of(const CeilingModel& model) {
  std::vector<Pose2> poses;
  for (const Fixture& fixture : model.building.fixtures) {
    SplitMix random = random_stream(model.seed, kHalfPurpose, poses.size());
    const double turn = random.uniform() < 0.5 ? 0.0 : kPi;
    Pose2 pose = fixture.world_from_fixture;
    pose.theta = wrap_angle(pose.theta + turn);
    poses.push_back(pose);
  }
  return poses;
}

std::vector<ClutterItem> clutter_in(const CeilingModel& model) {
  std::vector<ClutterItem> items;
  for (const CeilingElement& element : model.building.elements) {
    items.push_back(clutter_of(element, model.building.ceiling_height));
  }
  items.insert(items.end(), model.clutter.begin(), model.clutter.end());
  return items;
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

/// Half the size of all parts together, from the thing's middle, and how far light and blur reach around them.
Vector2d reach_of(const std::vector<Shape>& shapes) {
  Vector2d reach = Vector2d::Zero();
  for (const Shape& shape : shapes) {
    const double glow = shape.glow > 0.0F ? shape.halo_reach : 0.0;
    const double along = std::abs(shape.x) + shape.half_length + std::max(glow, 1.0 * shape.edge_along);
    const double across = std::abs(shape.y) + shape.half_width + std::max(glow, 1.0 * shape.edge_across);
    reach = reach.cwiseMax(Vector2d(along, across));
  }
  return reach;
}

/// What a smooth edge of that width leaves of the contrast of ribs.
double shown_ribs(double pitch, double edge) {
  const double sigma = edge / std::sqrt(20.0);
  return std::exp(-2.0 * kPi * kPi * sigma * sigma / (pitch * pitch));
}

/// Widths [m] of edges in the picture where a thing is, and of its glow.
struct Sharpness {
  double along;
  double across;
  double bloom;
  double halo;
};

Shape shape_of(const Part& part, const Sharpness& sharpness, double daylight, bool is_lamp) {
  Shape shape;
  shape.round = part.round;
  shape.ribs_follow_x = part.ribs_follow_x;
  shape.x = static_cast<float>(part.x);
  shape.y = static_cast<float>(part.y);
  shape.half_length = static_cast<float>(part.half_length);
  shape.half_width = static_cast<float>(part.half_width);
  shape.edge_along = static_cast<float>(std::hypot(sharpness.along, part.softness));
  shape.edge_across = static_cast<float>(std::hypot(sharpness.across, part.softness));
  shape.reflectance = static_cast<float>(part.reflectance);
  shape.emission = static_cast<float>(part.emission + daylight * part.sky);
  shape.glow = static_cast<float>(part.glow * (is_lamp ? 1.0 : daylight));
  shape.bloom_reach = static_cast<float>(sharpness.bloom);
  shape.halo_reach = static_cast<float>(sharpness.halo);
  if (part.rib_pitch > 0.0) {
    const double shown = shown_ribs(part.rib_pitch, part.ribs_follow_x ? sharpness.along : sharpness.across);
    shape.rib_pitch = shown > 0.05 ? static_cast<float>(part.rib_pitch) : 0.0F;
    shape.rib_depth = static_cast<float>(shown * part.rib_depth);
    shape.rib_mean = static_cast<float>(1.0 - 0.5 * part.rib_depth);
    if (shape.rib_pitch == 0.0F) {  // too fine to be seen: only darker
      shape.reflectance *= shape.rib_mean;
      shape.emission *= shape.rib_mean;
    }
  }
  return shape;
}

std::size_t look_of(LampState state) {
  return state == LampState::kOff ? 0 : state == LampState::kHalf ? 2 : 1;
}

}  // namespace

CeilingLayout::CeilingLayout(const CeilingModel& model)
    : model_(model),
      camera_(model.intrinsics, model.mounting),
      clutter_(clutter_in(model)),
      world_from_fixture_(poses_of(model)) {
  for (const ClutterItem& item : clutter_) {
    clutter_parts_.push_back(parts_of(item.kind, item.length, item.width));
  }
  for (std::size_t i = 0; i < model.building.fixtures.size(); ++i) {
    const LuminaireKind kind = i < model.luminaires.size() ? model.luminaires[i] : LuminaireKind::kPanel;
    const double darker = i < model.unlit_darker.size() ? model.unlit_darker[i] / SensorResponse::kNominalGrey : 0.2;
    auto& looks = fixture_parts_.emplace_back();
    for (const LampState state : {LampState::kOff, LampState::kOn, LampState::kHalf}) {
      looks[look_of(state)] = parts_of(kind, model.building.fixtures[i], state, darker);
    }
  }
}

void CeilingLayout::set_moved(const std::vector<MovedLamp>& moved) {
  if (moved == moved_) {
    return;
  }
  moved_ = moved;
  world_from_fixture_ = poses_of(model_);
  for (const MovedLamp& lamp : moved_) {
    if (lamp.index >= 0 && static_cast<std::size_t>(lamp.index) < world_from_fixture_.size()) {
      Pose2& pose = world_from_fixture_[static_cast<std::size_t>(lamp.index)];
      pose = {pose.x + lamp.dx, pose.y + lamp.dy, wrap_angle(pose.theta + lamp.theta)};
    }
  }
}

void CeilingLayout::find(const FrameGeometry& frame, const CeilingLight& light) {
  size_ = 0;
  const double radius = frame.reach * frame.rise + kLargestThing;
  add_clutter(frame, light, false);
  for (const bool lit : {false, true}) {  // lit ones last: their halo lies over all the rest
    for (std::size_t i = 0; i < world_from_fixture_.size(); ++i) {
      const int index = static_cast<int>(i);
      const Vector2d offset = world_from_fixture_[i].position() - frame.origin;
      if ((light.lamp(index) != LampState::kOff) == lit && offset.norm() < radius) {
        add_fixture(index, frame, light);
      }
    }
  }
  add_clutter(frame, light, true);
}

void CeilingLayout::add_clutter(const FrameGeometry& frame, const CeilingLight& light, bool low) {
  constexpr double kLow = 0.05;  // [m]
  for (std::size_t i = 0; i < clutter_.size(); ++i) {
    const ClutterItem& item = clutter_[i];
    const double reach = frame.reach * frame.rise + 0.5 * std::hypot(item.length, item.width) + kLargestThing;
    const Vector2d offset = item.world_from_item.position() - frame.origin;
    if ((item.height < model_.building.ceiling_height - kLow) == low && offset.norm() < reach) {
      add(item.world_from_item, item.height, -1, clutter_parts_[i], light.daylight(), frame);
    }
  }
}

void CeilingLayout::add_fixture(int index, const FrameGeometry& frame, const CeilingLight& light) {
  const auto i = static_cast<std::size_t>(index);
  add(world_from_fixture_[i], model_.building.fixtures[i].height, index, fixture_parts_[i][look_of(light.lamp(index))],
      light.daylight(), frame);
}

void CeilingLayout::add(const Pose2& world_from_thing, double height, int fixture, const std::vector<Part>& parts,
                        double daylight, const FrameGeometry& frame) {
  if (size_ == visible_.size()) {
    visible_.emplace_back();
  }
  VisibleThing& visible = visible_[size_];
  const Vector2d offset = world_from_thing.position() - frame.origin;
  const Vector2d axis(std::cos(world_from_thing.theta), std::sin(world_from_thing.theta));
  visible.fixture = fixture;
  visible.height = height;
  visible.x = static_cast<float>(offset.x());
  visible.y = static_cast<float>(offset.y());
  visible.cosine = static_cast<float>(axis.x());
  visible.sine = static_cast<float>(axis.y());
  const double pixel = metres_per_pixel(model_, frame, world_from_thing.position(), height);
  const Vector2d travel = frame.motion + frame.turn * Vector2d(-offset.y(), offset.x());
  const Sharpness sharpness{widened(kEdgePixels * pixel, travel.dot(axis)),
                            widened(kEdgePixels * pixel, axis.x() * travel.y() - axis.y() * travel.x()),
                            kBloomPixels * pixel, kHaloPixels * pixel};
  visible.shapes.clear();
  for (const Part& part : parts) {
    visible.shapes.push_back(shape_of(part, sharpness, daylight, fixture >= 0));
  }
  const Vector2d slack = Vector2d::Constant(frame.slack);
  size_ += find_spans(world_from_thing, reach_of(visible.shapes) + slack, frame, visible) ? 1 : 0;
}

bool CeilingLayout::find_spans(const Pose2& world_from_thing, const Vector2d& half, const FrameGeometry& frame,
                               VisibleThing& visible) const {
  const Matrix3d camera_from_world = (frame.view.world_from_robot * camera_.rotation()).transpose();
  Outline polygon = rectangle(half.x(), half.y());
  const int width = model_.intrinsics.width;
  const int height = model_.intrinsics.height;
  double top = height;
  double bottom = -1.0;
  bool beyond_lens = false;  // part of it is where the lens shows nothing: then its place in the picture is not sought
  for (Vector2d& point : polygon) {
    const Vector2d in_world = world_from_thing * point;
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
  return any;
}

}  // namespace luminav::simulated
