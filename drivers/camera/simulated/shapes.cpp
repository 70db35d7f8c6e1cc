#include "drivers/camera/simulated/shapes.hpp"

#include <cmath>

#include "services/common/geometry/vector_clones.hpp"

namespace luminav::simulated {
namespace {

// Of light that the lens scatters, at the edge of a lamp. Brightness as in CeilingLight.
constexpr float kBloom = 1.0F;
constexpr float kHalo = 0.35F;

// By arithmetic: minima and maxima become branches in long loops, and those are not vectorised (GCC 12).
float positive_part(float value) {
  return 0.5F * (value + std::abs(value));
}
float clamped(float value) {
  return positive_part(value) - positive_part(value - 1.0F);
}

/// From 0 to 1 over -0.5 .. 0.5.
float smooth_step(float value) {
  const float t = clamped(value + 0.5F);
  return t * t * (3.0F - 2.0F * t);
}

/// Share of a blurred pixel that lies within `half` of the middle; `inverse_width` of the blur.
float covered(float distance, float half, float inverse_width) {
  return smooth_step((distance + half) * inverse_width) - smooth_step((distance - half) * inverse_width);
}

/// 1 on a rib, 0 in the middle between two.
float rib(float place, float inverse_pitch) {
  const float position = place * inverse_pitch + 1024.5F;  // positive, so that truncation rounds down
  return std::abs(position - static_cast<float>(static_cast<int>(position)) - 0.5F) * 2.0F;
}

// Shapes come by value: what may change under a loop is loaded again in each turn, and then nothing is vectorised.

template <bool has_ribs>
void paint_rectangle(const Shape shape, const RowSpan& row) {
  const float inverse_along = 1.0F / shape.edge_along;
  const float inverse_across = 1.0F / shape.edge_across;
  const float inverse_pitch = has_ribs ? 1.0F / shape.rib_pitch : 0.0F;
  const float* __restrict along = row.along;
  const float* __restrict across = row.across;
  const float* __restrict light = row.light;
  const float* __restrict ribbed = shape.ribs_follow_x ? row.along : row.across;
  const float rib_middle = shape.ribs_follow_x ? shape.x : shape.y;
  float* __restrict brightness = row.brightness;
  const int count = row.count;
  for (int i = 0; i < count; ++i) {
    const float share = covered(along[i] - shape.x, shape.half_length, inverse_along) *
                        covered(across[i] - shape.y, shape.half_width, inverse_across);
    float inside = shape.reflectance * light[i] + shape.emission;
    if (has_ribs) {
      inside *= shape.rib_mean + shape.rib_depth * (0.5F - rib(ribbed[i] - rib_middle, inverse_pitch));
    }
    brightness[i] += share * (inside - brightness[i]);
  }
}

template <bool has_ribs>
void paint_capsule(const Shape shape, const RowSpan& row) {
  const float straight = shape.half_length - shape.half_width;
  const float inverse_along = 1.0F / shape.edge_along;
  const float inverse_across = 1.0F / shape.edge_across;
  const float inverse_pitch = has_ribs ? 1.0F / shape.rib_pitch : 0.0F;
  const float* __restrict along = row.along;
  const float* __restrict across = row.across;
  const float* __restrict light = row.light;
  float* __restrict brightness = row.brightness;
  const int count = row.count;
  for (int i = 0; i < count; ++i) {
    const float end = positive_part(std::abs(along[i] - shape.x) - straight);
    const float side = across[i] - shape.y;
    const float distance2 = end * end + side * side + 1e-12F;
    const float endwise = end * end / distance2;
    const float inverse_width = inverse_across + endwise * (inverse_along - inverse_across);
    const float share = covered(std::sqrt(distance2), shape.half_width, inverse_width);
    float inside = shape.reflectance * light[i] + shape.emission;
    if (has_ribs) {
      inside *= shape.rib_mean + shape.rib_depth * (0.5F - rib(along[i] - shape.x, inverse_pitch));
    }
    brightness[i] += share * (inside - brightness[i]);
  }
}

}  // namespace

[[gnu::flatten]] LUMINAV_VECTOR_CLONES void paint(const Shape& shape, const RowSpan& row) {
  if (shape.round) {
    shape.rib_pitch > 0.0F ? paint_capsule<true>(shape, row) : paint_capsule<false>(shape, row);
  } else {
    shape.rib_pitch > 0.0F ? paint_rectangle<true>(shape, row) : paint_rectangle<false>(shape, row);
  }
}

LUMINAV_VECTOR_CLONES void add_glow(const Shape& shape, const RowSpan& row) {
  const float corner = shape.round ? shape.half_width : 0.0F;
  const float half_length = shape.half_length - corner;
  const float half_width = shape.half_width - corner;
  const float middle_x = shape.x;
  const float middle_y = shape.y;
  const float bloom_strength = kBloom * shape.glow;
  const float halo_strength = kHalo * shape.glow;
  const float inverse_bloom = 1.0F / shape.bloom_reach;
  const float inverse_halo = 1.0F / shape.halo_reach;
  const float* __restrict along = row.along;
  const float* __restrict across = row.across;
  float* __restrict brightness = row.brightness;
  const int count = row.count;
  for (int i = 0; i < count; ++i) {
    const float end = positive_part(std::abs(along[i] - middle_x) - half_length);
    const float side = positive_part(std::abs(across[i] - middle_y) - half_width);
    const float distance = positive_part(std::sqrt(end * end + side * side) - corner);
    const float bloom = clamped(1.0F - distance * inverse_bloom);
    const float halo = clamped(1.0F - distance * inverse_halo);
    brightness[i] += bloom_strength * bloom * bloom * bloom + halo_strength * halo * halo * halo;
  }
}

}  // namespace luminav::simulated
