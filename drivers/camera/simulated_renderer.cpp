#include "drivers/camera/simulated_renderer.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/camera/simulated_random.hpp"

namespace luminav::simulated {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::uint64_t kHalfPurpose = 5;
constexpr int kNodePitch = 40;         // [px] between nodes of the light
constexpr double kEdgePixels = 4.0;    // width of a sharp edge: lens and pixel, 0.9 px 1-sigma
constexpr double kTextureSigma = 0.7;  // [px]
constexpr double kBloomPixels = 12.0;
constexpr double kHaloPixels = 50.0;
constexpr float kWall = 0.35F;  // of the ceiling's light, where a pixel sees no ceiling

/// Width of a smooth edge after a motion by `travel`: variances add; a smooth step's is width^2 / 20, a box's 1/12.
double widened(double width, double travel) {
  return std::sqrt(width * width + 20.0 / 12.0 * travel * travel);
}

std::vector<Vector2d> positions(const std::vector<Pose2>& poses) {
  std::vector<Vector2d> points;
  points.reserve(poses.size());
  for (const Pose2& pose : poses) {
    points.push_back(pose.position());
  }
  return points;
}

std::vector<Pose2> poses_of(const std::vector<Fixture>& fixtures) {
  std::vector<Pose2> poses;
  for (const Fixture& fixture : fixtures) {
    poses.push_back(fixture.world_from_fixture);
  }
  return poses;
}

std::vector<Pose2> poses_of(const std::vector<CeilingElement>& elements) {
  std::vector<Pose2> poses;
  for (const CeilingElement& element : elements) {
    poses.push_back(element.world_from_element);
  }
  return poses;
}

/// Fixtures lie in the tiles' grid, so a corner of the first straight one is a crossing of it.
Vector2d grid_origin(const std::vector<Fixture>& fixtures) {
  for (const Fixture& fixture : fixtures) {
    const double theta = wrap_modulo(fixture.world_from_fixture.theta, kPi);
    if (fixture.shape == FixtureShape::kRound) {
      continue;
    }
    const bool upright = std::abs(theta) > 0.25 * kPi;
    const double along_x = upright ? fixture.width : fixture.length;
    const double along_y = upright ? fixture.length : fixture.width;
    return fixture.world_from_fixture.position() - 0.5 * Vector2d(along_x, along_y);
  }
  return Vector2d::Zero();
}

double blur_of_texture(const CeilingModel& model) {
  const double rise = std::max(0.1, model.building.ceiling_height - model.mounting.z);
  return kTextureSigma * rise / model.intrinsics.fx;
}

double positive_modulo(double value, double period) {
  return value - period * std::floor(value / period);
}

}  // namespace

CeilingRenderer::CeilingRenderer(const CeilingModel& model)
    : model_(model),
      camera_(model.intrinsics, model.mounting),
      rays_(camera_),
      texture_(model.seed, blur_of_texture(model)),
      response_(rays_.width(), rays_.height(), model.grey_noise, model.seed),
      light_(model_.building, model.seed),
      fixture_index_(positions(poses_of(model_.building.fixtures))),
      element_index_(positions(poses_of(model_.building.elements))),
      world_from_fixture_(poses_of(model_.building.fixtures)),
      grid_origin_(grid_origin(model_.building.fixtures)),
      node_columns_((rays_.width() + kNodePitch - 1) / kNodePitch + 1),
      node_rows_((rays_.height() + kNodePitch - 1) / kNodePitch + 1) {
  model_.unlit_darker.resize(model_.building.fixtures.size(), 20.0);
  nodes_.resize(static_cast<std::size_t>(node_columns_) * static_cast<std::size_t>(node_rows_));
  const auto width = static_cast<std::size_t>(rays_.width());
  texel_.resize(width);
  for (auto* row : {&x_, &y_, &plane_x_, &plane_y_, &brightness_}) {
    row->resize(width);
  }
  light_row_.resize(static_cast<std::size_t>(node_columns_) * kNodePitch);
}

void CeilingRenderer::set_world(double daylight, const std::vector<LampState>& lamps,
                                const std::vector<MovedLamp>& moved) {
  light_.set(daylight, lamps);
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

CeilingRenderer::View CeilingRenderer::view_from(const TruePose& pose) const {
  // The same convention as the mounting: yaw after pitch after roll.
  const double cr = std::cos(pose.roll);
  const double sr = std::sin(pose.roll);
  const double cp = std::cos(pose.pitch);
  const double sp = std::sin(pose.pitch);
  const double c = std::cos(pose.world_from_robot.theta);
  const double s = std::sin(pose.world_from_robot.theta);
  View view;
  view.world_from_robot << c * cp, c * sp * sr - s * cr, c * sp * cr + s * sr,  //
      s * cp, s * sp * sr + c * cr, s * sp * cr - c * sr,                       //
      -sp, cp * sr, cp * cr;
  view.lens = view.world_from_robot * Vector3d(model_.mounting.x, model_.mounting.y, model_.mounting.z);
  view.lens.x() += pose.world_from_robot.x;
  view.lens.y() += pose.world_from_robot.y;
  return view;
}

double CeilingRenderer::metres_per_pixel(const View& view, const Vector2d& point, double height) const {
  const double rise = std::max(0.05, height - view.lens.z());
  const double reach = std::min((point - view.lens.head<2>()).norm() / rise, rays_.reach());
  // Between the footprint's two axes, rise / (f cos) and rise / (f cos^2).
  return rise / model_.intrinsics.fx * std::pow(1.0 + reach * reach, 0.75);
}

void CeilingRenderer::light_nodes(const View& view) {
  const double rise = model_.building.ceiling_height - view.lens.z();
  std::size_t node = 0;
  for (int i = 0; i < node_rows_; ++i) {
    const int row = std::min(i * kNodePitch, rays_.height() - 1);
    for (int j = 0; j < node_columns_; ++j) {
      const auto column = static_cast<std::size_t>(std::min(j * kNodePitch, rays_.width() - 1));
      const Vector3d ray = view.world_from_robot * Vector3d(rays_.x(row)[column], rays_.y(row)[column], 1.0);
      const Vector2d point = view.lens.head<2>() + rise / std::max(ray.z(), 0.05) * ray.head<2>();
      nodes_[node++] = static_cast<float>(light_.at(point));
    }
  }
}

void CeilingRenderer::set_outline(const Pose2& world_from_shape, double length, double width, VisibleShape& visible,
                                  const View& view) const {
  const Vector2d centre = world_from_shape.position();
  Shape& shape = visible.shape;
  shape.x = static_cast<float>(centre.x() - origin_.x());
  shape.y = static_cast<float>(centre.y() - origin_.y());
  const Vector2d axis(std::cos(world_from_shape.theta), std::sin(world_from_shape.theta));
  shape.cosine = static_cast<float>(axis.x());
  shape.sine = static_cast<float>(axis.y());
  shape.half_length = static_cast<float>(0.5 * length);
  shape.half_width = static_cast<float>(0.5 * width);
  const double pixel = metres_per_pixel(view, centre, visible.height);
  const Vector2d offset = centre - origin_;
  const Vector2d travel = motion_ + turn_ * Vector2d(-offset.y(), offset.x());
  const double along = travel.dot(axis);
  const double across = axis.x() * travel.y() - axis.y() * travel.x();
  shape.edge_along = static_cast<float>(widened(kEdgePixels * pixel, along));
  shape.edge_across = static_cast<float>(widened(kEdgePixels * pixel, across));
  shape.bloom_reach = static_cast<float>(kBloomPixels * pixel);
  shape.halo_reach = static_cast<float>(kHaloPixels * pixel);
}

void CeilingRenderer::find_spans(double reach, const Pose2& world_from_shape, const View& view, VisibleShape& visible) {
  constexpr int kPointsPerSide = 4;
  const double half_length = visible.shape.half_length + reach;
  const double half_width = visible.shape.half_width + reach;
  const Matrix3d camera_from_world = (view.world_from_robot * camera_.rotation()).transpose();
  const std::array<Vector2d, 4> corners{Vector2d(-half_length, -half_width), Vector2d(half_length, -half_width),
                                        Vector2d(half_length, half_width), Vector2d(-half_length, half_width)};
  std::array<Vector2d, 4 * kPointsPerSide> outline;
  double top = 1e9;
  double bottom = -1e9;
  bool whole_image = false;
  for (std::size_t i = 0; i < outline.size() && !whole_image; ++i) {
    const Vector2d& a = corners[i / kPointsPerSide];
    const Vector2d& b = corners[(i / kPointsPerSide + 1) % 4];
    const Vector2d local = a + (b - a) * static_cast<double>(i % kPointsPerSide) / kPointsPerSide;
    const Vector2d point = world_from_shape * local;
    const Vector3d offset(point.x() - view.lens.x(), point.y() - view.lens.y(), visible.height - view.lens.z());
    const auto pixel = camera_.pixel_of(camera_from_world * offset);
    whole_image = !pixel;  // it reaches beyond what the lens can show
    if (pixel) {
      outline[i] = *pixel;
      top = std::min(top, pixel->y());
      bottom = std::max(bottom, pixel->y());
    }
  }
  visible.spans.clear();
  visible.first_row = whole_image ? 0 : static_cast<int>(std::clamp(std::floor(top) - 2.0, 0.0, 1.0 * rays_.height()));
  const int end_row =
      whole_image ? rays_.height() : static_cast<int>(std::clamp(std::ceil(bottom) + 3.0, 0.0, 1.0 * rays_.height()));
  for (int row = visible.first_row; row < end_row; ++row) {
    double left = whole_image ? 0.0 : 1e9;
    double right = whole_image ? rays_.width() : -1e9;
    for (std::size_t i = 0; i < outline.size() && !whole_image; ++i) {
      const Vector2d& a = outline[i];
      const Vector2d& b = outline[(i + 1) % outline.size()];
      if (std::max(a.y(), b.y()) < row - 2.0 || std::min(a.y(), b.y()) > row + 2.0) {
        continue;
      }
      const double rise = b.y() - a.y();
      for (const double y : {row - 2.0, row + 2.0}) {
        const double share = std::abs(rise) < 1e-6 ? 0.0 : std::clamp((y - a.y()) / rise, 0.0, 1.0);
        const double x = a.x() + share * (b.x() - a.x());
        left = std::min({left, x, std::abs(rise) < 1e-6 ? b.x() : x});
        right = std::max({right, x, std::abs(rise) < 1e-6 ? b.x() : x});
      }
    }
    const double width = rays_.width();
    visible.spans.push_back({static_cast<int>(std::clamp(std::floor(left) - 2.0, 0.0, width)),
                             static_cast<int>(std::clamp(std::ceil(right) + 3.0, 0.0, width))});
  }
}

void CeilingRenderer::add_fixture(int index, const Exposure& exposure, const View& view) {
  const auto i = static_cast<std::size_t>(index);
  const Fixture& fixture = model_.building.fixtures[i];
  if (static_cast<std::size_t>(visible_count_) == visible_.size()) {
    visible_.emplace_back();
  }
  VisibleShape& visible = visible_[static_cast<std::size_t>(visible_count_)];
  visible.fixture = index;
  visible.height = fixture.height;
  visible.shape = Shape{};
  set_outline(world_from_fixture_[i], fixture.length, fixture.width, visible, view);
  Shape& shape = visible.shape;
  const LampState state = light_.lamp(index);
  const bool burns = state == LampState::kOn || state == LampState::kFlicker;
  if (fixture.shape == FixtureShape::kRound) {
    shape.look = state == LampState::kOff ? Look::kUnlitRound : Look::kLitRound;
  } else {
    shape.look = burns ? Look::kLitPanel : state == LampState::kHalf ? Look::kHalfPanel : Look::kUnlitPanel;
    const int lamps = std::max(1, fixture.lamps);
    shape.tube_pitch = static_cast<float>(fixture.width / lamps);
    shape.tube_phase = lamps % 2 == 0 ? 0.0F : 0.5F;
  }
  shape.emission = static_cast<float>(light_.emission(index, exposure.utime));
  shape.darker = static_cast<float>(model_.unlit_darker[i] / SensorResponse::kNominalGrey);
  RandomStream random = random_stream(model_.seed, kHalfPurpose, static_cast<std::uint64_t>(index));
  shape.half_side = random.uniform() < 0.5 ? -1.0F : 1.0F;
  const bool glows = state != LampState::kOff;
  const double reach = (glows ? shape.halo_reach : std::max(shape.edge_along, shape.edge_across)) + slack_;
  find_spans(reach, world_from_fixture_[i], view, visible);
  visible_count_ += visible.spans.empty() ? 0 : 1;
}

void CeilingRenderer::add_element(const CeilingElement& element, const View& view) {
  if (static_cast<std::size_t>(visible_count_) == visible_.size()) {
    visible_.emplace_back();
  }
  VisibleShape& visible = visible_[static_cast<std::size_t>(visible_count_)];
  visible.fixture = -1;
  visible.height = model_.building.ceiling_height;
  visible.shape = Shape{};
  set_outline(element.world_from_element, element.length, element.width, visible, view);
  Shape& shape = visible.shape;
  switch (element.kind) {
    case ElementKind::kVent:
      shape.look = Look::kVent;
      break;
    case ElementKind::kSign:
      shape.look = Look::kSign;
      break;
    case ElementKind::kSpeaker:
      shape.look = Look::kDisc;
      shape.darker = 0.02F;
      break;
    case ElementKind::kDetector:
      shape.look = Look::kDisc;
      shape.darker = 0.35F;
      break;
  }
  if (shape.look == Look::kDisc) {
    shape.half_width = shape.half_length;
  }
  find_spans(std::max(shape.edge_along, shape.edge_across) + slack_, element.world_from_element, view, visible);
  visible_count_ += visible.spans.empty() ? 0 : 1;
}

void CeilingRenderer::find_shapes(const Exposure& exposure, const View& view, const Vector2d& robot) {
  const double seconds = exposure.exposure_us * 1e-6;
  const Vector2d lever = origin_ - robot;
  turn_ = exposure.angular * seconds;
  motion_ = exposure.velocity * seconds + turn_ * Vector2d(-lever.y(), lever.x());
  const double rise = std::max(0.1, model_.building.ceiling_height - view.lens.z());
  const double reach = rays_.reach() * rise;
  const double half_readout = 0.5e-6 * exposure.row_time_us * rays_.height() + 0.5 * seconds;
  slack_ = 0.01 + half_readout * (exposure.velocity.norm() + std::abs(exposure.angular) * (reach + lever.norm()));

  visible_count_ = 0;
  constexpr double kLargestThing = 3.0;  // [m] half the diagonal, halo included
  element_index_.near(origin_, reach + kLargestThing, found_);
  for (const int index : found_) {
    add_element(model_.building.elements[static_cast<std::size_t>(index)], view);
  }
  // Lit ones last: their halo lies over all the rest.
  fixture_index_.near(origin_, reach + kLargestThing + farthest_moved_, found_);
  for (const bool lit : {false, true}) {
    for (const int index : found_) {
      if ((light_.lamp(index) != LampState::kOff) == lit) {
        add_fixture(index, exposure, view);
      }
    }
  }
}

CeilingRenderer::TextureMap CeilingRenderer::texture_map(const Exposure& exposure, const View& view) const {
  constexpr double kPeriod = TileTexture::kPeriod;
  constexpr double kTexelsPerMetre = TileTexture::kSide / kPeriod;
  TextureMap map;
  // 64 periods more than needed keep the coordinates positive for 76 m to each side of the lens.
  const Vector2d phase = origin_ - grid_origin_;
  map.phase_x = static_cast<float>((positive_modulo(phase.x(), kPeriod) + 64 * kPeriod) * kTexelsPerMetre);
  map.phase_y = static_cast<float>((positive_modulo(phase.y(), kPeriod) + 64 * kPeriod) * kTexelsPerMetre);
  map.shift_x = static_cast<float>(motion_.x());
  map.shift_y = static_cast<float>(motion_.y());
  map.turn = static_cast<float>(turn_);
  const double pixel = metres_per_pixel(view, view.lens.head<2>(), model_.building.ceiling_height);
  const double blur = (motion_.norm() + std::abs(turn_) * 0.25 * rays_.width() * pixel) / pixel;
  map.taps = exposure.exposure_us <= 0.0 ? 1 : std::clamp(static_cast<int>(0.5 * blur) + 1, 1, 4);
  return map;
}

void CeilingRenderer::ceiling_points(int row, const View& view) {
  const Matrix3d& r = view.world_from_robot;
  const auto rise = static_cast<float>(model_.building.ceiling_height - view.lens.z());
  const float r00 = static_cast<float>(r(0, 0)), r01 = static_cast<float>(r(0, 1)), r02 = static_cast<float>(r(0, 2));
  const float r10 = static_cast<float>(r(1, 0)), r11 = static_cast<float>(r(1, 1)), r12 = static_cast<float>(r(1, 2));
  const float r20 = static_cast<float>(r(2, 0)), r21 = static_cast<float>(r(2, 1)), r22 = static_cast<float>(r(2, 2));
  const auto lens_x = static_cast<float>(view.lens.x() - origin_.x());
  const auto lens_y = static_cast<float>(view.lens.y() - origin_.y());
  const float* __restrict ray_x = rays_.x(row).data();
  const float* __restrict ray_y = rays_.y(row).data();
  float* __restrict x = x_.data();
  float* __restrict y = y_.data();
  const int width = rays_.width();
  for (int i = 0; i < width; ++i) {
    const float scale = rise / std::max(r20 * ray_x[i] + r21 * ray_y[i] + r22, 0.05F);
    x[i] = lens_x + scale * (r00 * ray_x[i] + r01 * ray_y[i] + r02);
    y[i] = lens_y + scale * (r10 * ray_x[i] + r11 * ray_y[i] + r12);
  }
}

void CeilingRenderer::light_row(int row) {
  const int above = row / kNodePitch;
  const float share = static_cast<float>(row - above * kNodePitch) / kNodePitch;
  const float* upper = nodes_.data() + static_cast<std::ptrdiff_t>(above) * node_columns_;
  const float* lower = nodes_.data() + static_cast<std::ptrdiff_t>(std::min(above + 1, node_rows_ - 1)) * node_columns_;
  for (int j = 0; j + 1 < node_columns_; ++j) {
    const float left = upper[j] + share * (lower[j] - upper[j]);
    const float right = upper[j + 1] + share * (lower[j + 1] - upper[j + 1]);
    const float step = (right - left) * (1.0F / kNodePitch);
    float* __restrict out = light_row_.data() + static_cast<std::ptrdiff_t>(j) * kNodePitch;
    for (int i = 0; i < kNodePitch; ++i) {
      out[i] = left + step * static_cast<float>(i);
    }
  }
}

void CeilingRenderer::texture_row(const TextureMap& map) {
  constexpr float kTexelsPerMetre = static_cast<float>(TileTexture::kSide / TileTexture::kPeriod);
  constexpr int kMask = TileTexture::kSide - 1;
  const int width = rays_.width();
  const float* __restrict x = x_.data();
  const float* __restrict y = y_.data();
  const float* __restrict light = light_row_.data();
  float* __restrict brightness = brightness_.data();
  int* __restrict texel = texel_.data();
  const std::uint8_t* texels = texture_.texels();
  const float weight = 1.0F / (TileTexture::kWhite * static_cast<float>(map.taps));
  for (int tap = 0; tap < map.taps; ++tap) {
    const float moment = (static_cast<float>(tap) + 0.5F) / static_cast<float>(map.taps) - 0.5F;
    const float shift_x = moment * map.shift_x;
    const float shift_y = moment * map.shift_y;
    const float turn = moment * map.turn;
    for (int i = 0; i < width; ++i) {
      const float u = (x[i] + shift_x - turn * y[i]) * kTexelsPerMetre + map.phase_x;
      const float v = (y[i] + shift_y + turn * x[i]) * kTexelsPerMetre + map.phase_y;
      texel[i] = ((static_cast<int>(v) & kMask) * TileTexture::kSide) | (static_cast<int>(u) & kMask);
    }
    if (tap == 0) {
      for (int i = 0; i < width; ++i) {
        brightness[i] = static_cast<float>(texels[texel[i]]);
      }
    } else {
      for (int i = 0; i < width; ++i) {
        brightness[i] += static_cast<float>(texels[texel[i]]);
      }
    }
  }
  for (int i = 0; i < width; ++i) {
    brightness[i] *= weight * light[i];
  }
}

void CeilingRenderer::shapes_row(int row, const Exposure& exposure, const View& view) {
  const double ceiling = model_.building.ceiling_height;
  for (int k = 0; k < visible_count_; ++k) {
    VisibleShape& visible = visible_[static_cast<std::size_t>(k)];
    const int line = row - visible.first_row;
    if (line < 0 || line >= static_cast<int>(visible.spans.size())) {
      continue;
    }
    const Span span = visible.spans[static_cast<std::size_t>(line)];
    if (span.begin >= span.end) {
      continue;
    }
    RowSpan part{x_.data() + span.begin, y_.data() + span.begin, light_row_.data() + span.begin,
                 brightness_.data() + span.begin, span.end - span.begin};
    if (std::abs(visible.height - ceiling) > 1e-4) {  // it hangs lower: the same rays meet its plane earlier
      const auto share = static_cast<float>((visible.height - view.lens.z()) / (ceiling - view.lens.z()));
      const auto lens_x = static_cast<float>(view.lens.x() - origin_.x());
      const auto lens_y = static_cast<float>(view.lens.y() - origin_.y());
      for (int i = 0; i < part.count; ++i) {
        plane_x_[static_cast<std::size_t>(i)] = lens_x + share * (part.x[i] - lens_x);
        plane_y_[static_cast<std::size_t>(i)] = lens_y + share * (part.y[i] - lens_y);
      }
      part.x = plane_x_.data();
      part.y = plane_y_.data();
    }
    if (visible.fixture >= 0 && light_.lamp(visible.fixture) == LampState::kFlicker) {
      const double row_utime = exposure.utime + (row - 0.5 * (rays_.height() - 1)) * exposure.row_time_us;
      visible.shape.emission = static_cast<float>(light_.emission(visible.fixture, row_utime));
    }
    draw(visible.shape, part);
  }
}

void CeilingRenderer::render(const Exposure& exposure, std::span<const TruePose> rows, GreyImage& image) {
  const int width = rays_.width();
  const int height = rays_.height();
  image.width = width;
  image.height = height;
  image.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const TruePose& middle = rows[rows.size() / 2];
  const View view = view_from(middle);
  origin_ = view.lens.head<2>();
  light_.gather(origin_, rays_.reach() * std::max(0.1, model_.building.ceiling_height - view.lens.z()), exposure.utime);
  light_nodes(view);
  find_shapes(exposure, view, middle.world_from_robot.position());
  const TextureMap map = texture_map(exposure, view);
  response_.begin_frame(exposure.number, exposure.exposure_us, exposure.gain);
  for (int row = 0; row < height; ++row) {
    const View row_view =
        rows.size() == static_cast<std::size_t>(height) ? view_from(rows[static_cast<std::size_t>(row)]) : view;
    ceiling_points(row, row_view);
    light_row(row);
    texture_row(map);
    shapes_row(row, exposure, row_view);
    const auto below = rays_.below(row);
    for (std::size_t i = 0; i < below.size(); ++i) {
      brightness_[i] += below[i] * (kWall * light_row_[i] - brightness_[i]);
    }
    response_.develop(row, brightness_.data(), image.pixels.data() + static_cast<std::ptrdiff_t>(row) * width);
  }
}

}  // namespace luminav::simulated
