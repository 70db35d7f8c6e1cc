#pragma once

namespace luminav::simulated {

/// A part of a thing on the ceiling as one frame sees it. Lengths in metres in the thing's own frame, brightness as in
/// CeilingLight.
struct Shape {
  bool round = false;  // a capsule or a disc, else a rectangle
  bool ribs_follow_x = true;
  float x = 0.0F;  // [m] middle
  float y = 0.0F;
  float half_length = 0.6F;   // [m]
  float half_width = 0.15F;   // [m]
  float edge_along = 0.02F;   // [m] over which an end fades: sharpness and motion along it
  float edge_across = 0.02F;  // [m] the same for the long sides
  float reflectance = 1.0F;   // of the light that falls there
  float emission = 0.0F;      // own light
  float glow = 0.0F;          // around it; 0 = none
  float bloom_reach = 0.06F;  // [m]
  float halo_reach = 0.25F;   // [m]
  float rib_pitch = 0.0F;     // [m] 0 = none
  float rib_depth = 0.0F;     // as far as the picture is sharp enough to show them
  float rib_mean = 1.0F;      // brightness over a whole pitch, which no blur changes
};

/// Part of a row of pixels: where in the thing's frame each one looks, the light that falls there and the brightness
/// seen so far, which drawing changes.
struct RowSpan {
  const float* along = nullptr;
  const float* across = nullptr;
  const float* light = nullptr;
  float* brightness = nullptr;
  int count = 0;
};

/// Paints one row of a shape over what is there, with anti-aliased edges. What is thinner than the picture is sharp is
/// as faint as it should be.
void paint(const Shape& shape, const RowSpan& row);
/// Adds one row of bloom and halo around a shape.
void add_glow(const Shape& shape, const RowSpan& row);

}  // namespace luminav::simulated
