#include "drivers/camera/simulated/renderer.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/geometry/vector_clones.hpp"

namespace luminav::simulated {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kNodePitch = 40;         // [px] between nodes of the light
constexpr double kTextureSigma = 0.7;  // [px]
constexpr float kWall = 0.35F;         // of the ceiling's light, where a pixel sees no ceiling

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

/// [begin, end) of a row.
struct Interval {
  int begin = 0;
  int end = 0;
};

Interval overlap(const Interval& a, const Interval& b) {
  const int begin = std::max(a.begin, b.begin);
  return {begin, std::max(begin, std::min(a.end, b.end))};
}

/// Where values that run nearly straight, bent by a lens, are within `reach` of `middle`, and some around.
Interval nearly_linear(const float* values, int count, float middle, float reach) {
  const float first = values[0];
  const float last = values[count - 1];
  const int middle_of_values = count / 2;
  const float bend =
      std::abs(values[middle_of_values] - first -
               (last - first) * static_cast<float>(middle_of_values) / static_cast<float>(std::max(1, count - 1)));
  const float slope = (last - first) / static_cast<float>(std::max(1, count - 1));
  const float wide = reach + 1.5F * bend + 2.0F * std::abs(slope);
  if (std::abs(slope) < 1e-6F) {
    return std::abs(first - middle) <= wide ? Interval{0, count} : Interval{};
  }
  const float one = (middle - wide - first) / slope;
  const float other = (middle + wide - first) / slope;
  const auto bound = [count](float column) {
    return static_cast<int>(std::clamp(column, 0.0F, static_cast<float>(count)));
  };
  return {bound(std::min(one, other)), bound(std::max(one, other) + 1.0F)};
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
      layout_(model_),
      grid_origin_(grid_origin(model_.building.fixtures)),
      node_columns_((rays_.width() + kNodePitch - 1) / kNodePitch + 1),
      node_rows_((rays_.height() + kNodePitch - 1) / kNodePitch + 1) {
  model_.unlit_darker.resize(model_.building.fixtures.size(), 20.0);
  nodes_.resize(static_cast<std::size_t>(node_columns_) * static_cast<std::size_t>(node_rows_));
  const auto width = static_cast<std::size_t>(rays_.width());
  texel_.resize(width);
  for (auto* row : {&x_, &y_, &along_, &across_, &brightness_}) {
    row->resize(width);
  }
  light_row_.resize(static_cast<std::size_t>(node_columns_) * kNodePitch);
}

void CeilingRenderer::set_world(double daylight, const std::vector<LampState>& lamps,
                                const std::vector<MovedLamp>& moved) {
  light_.set(daylight, lamps);
  layout_.set_moved(moved);
}

void CeilingRenderer::light_nodes(const FrameGeometry& frame) {
  const View& view = frame.view;
  std::size_t node = 0;
  for (int i = 0; i < node_rows_; ++i) {
    const int row = std::min(i * kNodePitch, rays_.height() - 1);
    for (int j = 0; j < node_columns_; ++j) {
      const auto column = static_cast<std::size_t>(std::min(j * kNodePitch, rays_.width() - 1));
      const Vector3d ray = view.world_from_robot * Vector3d(rays_.x(row)[column], rays_.y(row)[column], 1.0);
      const Vector2d point = frame.origin + frame.rise / std::max(ray.z(), 0.05) * ray.head<2>();
      nodes_[node++] = static_cast<float>(light_.at(point));
    }
  }
}

CeilingRenderer::TextureMap CeilingRenderer::texture_map(const FrameGeometry& frame) const {
  constexpr double kPeriod = TileTexture::kPeriod;
  constexpr double kTexelsPerMetre = TileTexture::kSide / kPeriod;
  TextureMap map;
  // 64 periods more than needed keep the coordinates positive for 76 m to each side of the lens.
  const Vector2d phase = frame.origin - grid_origin_;
  map.phase_x = static_cast<float>((positive_modulo(phase.x(), kPeriod) + 64 * kPeriod) * kTexelsPerMetre);
  map.phase_y = static_cast<float>((positive_modulo(phase.y(), kPeriod) + 64 * kPeriod) * kTexelsPerMetre);
  map.shift_x = static_cast<float>(frame.motion.x());
  map.shift_y = static_cast<float>(frame.motion.y());
  map.turn = static_cast<float>(frame.turn);
  const double pixel = metres_per_pixel(model_, frame, frame.origin, model_.building.ceiling_height);
  const double blur = (frame.motion.norm() + std::abs(frame.turn) * 0.25 * rays_.width() * pixel) / pixel;
  map.taps = std::clamp(static_cast<int>(0.5 * blur) + 1, 1, 4);
  return map;
}

LUMINAV_VECTOR_CLONES void CeilingRenderer::find_points(int row, const View& view, const FrameGeometry& frame) {
  const Matrix3d& r = view.world_from_robot;
  const auto rise = static_cast<float>(std::max(0.1, model_.building.ceiling_height - view.lens.z()));
  const float r00 = static_cast<float>(r(0, 0)), r01 = static_cast<float>(r(0, 1)), r02 = static_cast<float>(r(0, 2));
  const float r10 = static_cast<float>(r(1, 0)), r11 = static_cast<float>(r(1, 1)), r12 = static_cast<float>(r(1, 2));
  const float r20 = static_cast<float>(r(2, 0)), r21 = static_cast<float>(r(2, 1)), r22 = static_cast<float>(r(2, 2));
  const auto lens_x = static_cast<float>(view.lens.x() - frame.origin.x());
  const auto lens_y = static_cast<float>(view.lens.y() - frame.origin.y());
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

LUMINAV_VECTOR_CLONES void CeilingRenderer::light_row(int row) {
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

LUMINAV_VECTOR_CLONES void CeilingRenderer::texture_row(const TextureMap& map) {
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

LUMINAV_VECTOR_CLONES void CeilingRenderer::place_in(const VisibleThing& thing, const ColumnSpan& span,
                                                     const View& view, const FrameGeometry& frame) {
  // What hangs lower is met earlier by the same rays.
  const double rise = model_.building.ceiling_height - view.lens.z();
  const auto share = static_cast<float>((thing.height - view.lens.z()) / rise);
  const float shift_x = (1.0F - share) * static_cast<float>(view.lens.x() - frame.origin.x()) - thing.x;
  const float shift_y = (1.0F - share) * static_cast<float>(view.lens.y() - frame.origin.y()) - thing.y;
  const float cosine = thing.cosine;
  const float sine = thing.sine;
  const float* __restrict x = x_.data() + span.begin;
  const float* __restrict y = y_.data() + span.begin;
  float* __restrict along = along_.data();
  float* __restrict across = across_.data();
  const int count = span.end - span.begin;
  for (int i = 0; i < count; ++i) {
    const float dx = share * x[i] + shift_x;
    const float dy = share * y[i] + shift_y;
    along[i] = cosine * dx + sine * dy;
    across[i] = cosine * dy - sine * dx;
  }
}

void CeilingRenderer::draw_shapes(const VisibleThing& thing, const ColumnSpan& span, float burning) {
  const int count = span.end - span.begin;
  for (Shape shape : thing.shapes) {
    const auto part_of_row = [&](float margin_along, float margin_across) {
      const Interval part = overlap(nearly_linear(along_.data(), count, shape.x, shape.half_length + margin_along),
                                    nearly_linear(across_.data(), count, shape.y, shape.half_width + margin_across));
      return RowSpan{along_.data() + part.begin, across_.data() + part.begin,
                     light_row_.data() + span.begin + part.begin, brightness_.data() + span.begin + part.begin,
                     part.end - part.begin};
    };
    if (thing.fixture >= 0) {
      shape.emission *= burning;
      shape.glow *= burning;
    }
    if (shape.glow > 0.0F) {
      add_glow(shape, part_of_row(shape.halo_reach, shape.halo_reach));
    }
    paint(shape, part_of_row(0.5F * shape.edge_along, 0.5F * shape.edge_across));
  }
}

void CeilingRenderer::draw_things(int row, const Exposure& exposure, const View& view, const FrameGeometry& frame) {
  for (std::size_t k = 0; k < layout_.size(); ++k) {
    const VisibleThing& thing = layout_[k];
    const int line = row - thing.first_row;
    if (line < 0 || line >= static_cast<int>(thing.spans.size())) {
      continue;
    }
    const ColumnSpan span = thing.spans[static_cast<std::size_t>(line)];
    if (span.begin >= span.end) {
      continue;
    }
    double burning = 1.0;
    if (thing.fixture >= 0 && light_.lamp(thing.fixture) == LampState::kFlicker) {
      const double row_utime = exposure.utime + (row - 0.5 * (rays_.height() - 1)) * exposure.row_time_us;
      burning = light_.emission(thing.fixture, row_utime);
    }
    place_in(thing, span, view, frame);
    draw_shapes(thing, span, static_cast<float>(burning));
  }
}

void CeilingRenderer::darken_walls(int row) {
  const auto below = rays_.below(row);
  for (std::size_t i = 0; i < below.size(); ++i) {
    brightness_[i] += below[i] * (kWall * light_row_[i] - brightness_[i]);
  }
}

void CeilingRenderer::render(const Exposure& exposure, std::span<const TruePose> rows, GreyImage& image) {
  const int width = rays_.width();
  const int height = rays_.height();
  image.width = width;
  image.height = height;
  image.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const FrameGeometry frame = geometry_of(model_, exposure, rows[rows.size() / 2], rays_.reach());
  light_.gather(frame.origin, frame.reach * frame.rise, exposure.utime);
  light_nodes(frame);
  layout_.find(frame, light_);
  const TextureMap map = texture_map(frame);
  response_.begin_frame(exposure.number, exposure.exposure_us, exposure.gain);
  const bool rolling = rows.size() == static_cast<std::size_t>(height);
  for (int row = 0; row < height; ++row) {
    const View view = rolling ? view_from(model_.mounting, rows[static_cast<std::size_t>(row)]) : frame.view;
    find_points(row, view, frame);
    light_row(row);
    texture_row(map);
    draw_things(row, exposure, view, frame);
    darken_walls(row);
    response_.develop(row, brightness_.data(), image.pixels.data() + static_cast<std::ptrdiff_t>(row) * width);
  }
}

}  // namespace luminav::simulated
