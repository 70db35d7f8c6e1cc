#include "drivers/camera/simulated/shapes.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/camera/simulated/vectors.hpp"

namespace luminav::simulated {
namespace {

// Brightness against a tile at 1: a fluorescent fixture behind prisms is 10 to 50 times as bright as the ceiling around
// it. Beyond the saturation of the sensor only the width of its edges shows the difference.
constexpr float kLamp = 9.0F;
constexpr float kTubeContrast = 0.5F;
constexpr float kTubeHalfWidth = 0.020F;  // [m] of the bright line of a 26 mm tube
constexpr float kUnlitTube = 0.04F;       // an unlit tube shines a little brighter than its housing
constexpr float kWornTube = 2.5F;         // the only tube of a fixture, half burnt
constexpr float kLeakedLight = 0.45F;     // on the dark half of a half-lit fixture
constexpr float kBloom = 1.0F;            // at the edge of a lit fixture
constexpr float kHalo = 0.35F;

// By arithmetic: minima and maxima become branches in long loops, and those are not vectorised (GCC 12).
float positive_part(float value) {
  return 0.5F * (value + std::abs(value));
}
float lesser(float a, float b) {
  return a - positive_part(a - b);
}
float clamped(float value) {
  return positive_part(value) - positive_part(value - 1.0F);
}

/// 1 inside, 0 outside, over `1 / inverse_width` around the edge; `outside` [m] is positive beyond it.
float coverage(float outside, float inverse_width) {
  const float t = clamped(0.5F - outside * inverse_width);
  return t * t * (3.0F - 2.0F * t);
}

float glow(float distance, float inverse_bloom, float inverse_halo) {
  const float bloom = clamped(1.0F - distance * inverse_bloom);
  const float halo = clamped(1.0F - distance * inverse_halo);
  return kBloom * bloom * bloom * bloom + kHalo * halo * halo * halo;
}

/// 1 on the middle line of a tube, 0 between tubes.
float tube(float across, float inverse_pitch, float phase, float pitch) {
  const float position = across * inverse_pitch + phase + 1024.0F;  // positive, so that truncation rounds down
  const float fraction = position - static_cast<float>(static_cast<int>(position)) - 0.5F;
  const float distance = fraction * pitch * (1.0F / kTubeHalfWidth);
  return positive_part(1.0F - distance * distance);
}

struct Local {
  float along;
  float across;
};

inline Local local_of(const Shape& shape, float x, float y) {
  const float dx = x - shape.x;
  const float dy = y - shape.y;
  return {shape.cosine * dx + shape.sine * dy, shape.cosine * dy - shape.sine * dx};
}

/// Part of a panel that shines: a strip along its long side.
struct Shining {
  float strength = 0.0F;    // of its bloom and halo; 0 = none
  float middle = 0.0F;      // [m] across
  float half_width = 0.0F;  // [m]
};

// Shapes come by value and brightness functions capture by value: what may change under a loop is loaded again in
// each turn, and then nothing is vectorised.

/// Panels share the outline; `inside(light, local)` gives the brightness within it.
template <typename Inside>
void draw_panel(const Shape shape, const RowSpan& row, const Shining shining, Inside inside) {
  const float inverse_along = 1.0F / shape.edge_along;
  const float inverse_across = 1.0F / shape.edge_across;
  const float inverse_bloom = 1.0F / shape.bloom_reach;
  const float inverse_halo = 1.0F / shape.halo_reach;
  const float* __restrict x = row.x;
  const float* __restrict y = row.y;
  const float* __restrict light = row.light;
  float* __restrict brightness = row.brightness;
  const int count = row.count;
  for (int i = 0; i < count; ++i) {
    const Local local = local_of(shape, x[i], y[i]);
    const float beyond_end = std::abs(local.along) - shape.half_length;
    const float beyond_side = std::abs(local.across) - shape.half_width;
    const float covered = coverage(beyond_end, inverse_along) * coverage(beyond_side, inverse_across);
    const float end = positive_part(beyond_end);
    const float side = positive_part(std::abs(local.across - shining.middle) - shining.half_width);
    const float halo = shining.strength * glow(std::sqrt(end * end + side * side), inverse_bloom, inverse_halo);
    brightness[i] += halo + covered * (inside(light[i], local) - brightness[i]);
  }
}

template <typename Inside>
void draw_round(const Shape shape, const RowSpan& row, float glow_strength, Inside inside) {
  const float inverse_edge = 1.0F / shape.edge_along;
  const float inverse_bloom = 1.0F / shape.bloom_reach;
  const float inverse_halo = 1.0F / shape.halo_reach;
  const float* __restrict x = row.x;
  const float* __restrict y = row.y;
  const float* __restrict light = row.light;
  float* __restrict brightness = row.brightness;
  const int count = row.count;
  for (int i = 0; i < count; ++i) {
    const Local local = local_of(shape, x[i], y[i]);
    const float radius = std::sqrt(local.along * local.along + local.across * local.across);
    const float beyond = radius - shape.half_length;
    const float covered = coverage(beyond, inverse_edge);
    const float behind = brightness[i] + glow_strength * glow(positive_part(beyond), inverse_bloom, inverse_halo);
    brightness[i] = behind + covered * (inside(light[i], radius) - behind);
  }
}

void draw_fixture_panel(const Shape& shape, const RowSpan& row) {
  const bool has_tubes = shape.tube_pitch > 0.0F;
  const float pitch = has_tubes ? shape.tube_pitch : 1.0F;
  const float inverse_pitch = 1.0F / pitch;
  const float contrast = has_tubes ? 1.0F : 0.0F;
  const float reflectance = 1.0F - shape.darker;
  const float lamp = kLamp * shape.emission;
  const auto tube_at = [=](float across) { return contrast * tube(across, inverse_pitch, shape.tube_phase, pitch); };
  switch (shape.look) {
    case Look::kLitPanel:
      draw_panel(shape, row, {shape.emission, 0.0F, shape.half_width}, [=](float light, const Local& local) {
        return reflectance * light + lamp * (1.0F - kTubeContrast * (1.0F - tube_at(local.across)));
      });
      return;
    case Look::kHalfPanel:
      if (shape.tube_pitch > 1.5F * shape.half_width) {  // a single tube
        draw_panel(shape, row, {0.2F, 0.0F, shape.half_width}, [=](float light, const Local& local) {
          return reflectance * light + kWornTube * (0.6F + 0.4F * tube_at(local.across));
        });
        return;
      }
      draw_panel(shape, row, {1.0F, 0.5F * shape.half_side * shape.half_width, 0.5F * shape.half_width},
                 [=](float light, const Local& local) {
                   const float burning = clamped(0.5F + 50.0F * shape.half_side * local.across);  // fades over 20 mm
                   return reflectance * light + kLeakedLight +
                          burning * kLamp * (1.0F - kTubeContrast * (1.0F - tube_at(local.across)));
                 });
      return;
    default:
      draw_panel(shape, row, {}, [=](float light, const Local& local) {
        return light * (reflectance + kUnlitTube * tube_at(local.across));
      });
      return;
  }
}

void draw_vent(const Shape& shape, const RowSpan& row) {
  constexpr float kSlatPitch = 0.05F;  // [m]
  const float frame = 0.03F;           // [m] of plain metal around the slats
  draw_panel(shape, row, {}, [=](float light, const Local& local) {
    const float slats = lesser(shape.half_length - std::abs(local.along), shape.half_width - std::abs(local.across));
    const float position = local.across * (1.0F / kSlatPitch) + 1024.0F;
    const float fraction = position - static_cast<float>(static_cast<int>(position)) - 0.5F;
    const float slat = 0.30F + 1.0F * std::abs(fraction);
    const float between = clamped(0.5F + 100.0F * (slats - frame));  // fades over 10 mm
    return light * (0.88F + between * (slat - 0.88F));
  });
}

/// Smoke detectors and loudspeakers: white plastic, a darker middle and a shadow at the rim.
void draw_disc(const Shape& shape, const RowSpan& row) {
  const float inverse_radius = 1.0F / shape.half_length;
  draw_round(shape, row, 0.0F, [=](float light, float radius) {
    const float r = radius * inverse_radius;
    const float rim = clamped(6.0F * (r - 0.8F));
    const float middle = clamped(8.0F * (0.45F - r));
    return light * (1.08F - 0.45F * rim - shape.darker * middle);
  });
}

/// An emergency exit sign shines by itself, day and night, and carries dark symbols.
void draw_sign(const Shape& shape, const RowSpan& row) {
  draw_panel(shape, row, {}, [=](float light, const Local& local) {
    const float along = local.along / shape.half_length;
    const float across = local.across / shape.half_width;
    const bool symbol = std::abs(across) < 0.55F && (std::abs(along + 0.5F) < 0.18F || std::abs(along - 0.3F) < 0.4F);
    return 0.8F * light + (symbol ? 0.25F : 1.5F);
  });
}

}  // namespace

LUMINAV_WIDE_VECTORS void draw(const Shape& shape, const RowSpan& row) {
  switch (shape.look) {
    case Look::kLitPanel:
    case Look::kHalfPanel:
    case Look::kUnlitPanel:
      draw_fixture_panel(shape, row);
      return;
    case Look::kLitRound: {
      const float lamp = kLamp * shape.emission;
      draw_round(shape, row, shape.emission, [=](float light, float) { return light + lamp; });
      return;
    }
    case Look::kUnlitRound:
      draw_round(shape, row, 0.0F, [=](float light, float) { return light * (1.0F - shape.darker); });
      return;
    case Look::kVent:
      draw_vent(shape, row);
      return;
    case Look::kDisc:
      draw_disc(shape, row);
      return;
    case Look::kSign:
      draw_sign(shape, row);
      return;
  }
}

}  // namespace luminav::simulated
