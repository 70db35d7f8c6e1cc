#pragma once

#include <cstdint>

namespace luminav::simulated {

/// What a thing on the ceiling looks like.
enum class Look { kLitPanel, kHalfPanel, kUnlitPanel, kLitRound, kUnlitRound, kVent, kDisc, kSign };

/// A thing on the ceiling as one frame sees it. Lengths in metres on its own plane, brightness as in CeilingLight.
struct Shape {
  Look look = Look::kLitPanel;
  float x = 0.0F;  // [m] centre, from the origin of the row's points
  float y = 0.0F;
  float cosine = 1.0F;  // of the direction of its long side
  float sine = 0.0F;
  float half_length = 0.6F;   // [m] of a round one the radius
  float half_width = 0.15F;   // [m]
  float edge_along = 0.02F;   // [m] over which an end of the long side fades: sharpness and motion along it
  float edge_across = 0.02F;  // [m] the same for the long sides
  float bloom_reach = 0.06F;  // [m] around a lit one
  float halo_reach = 0.25F;   // [m]
  float emission = 1.0F;      // share of full light; set for each row because flickering ones change
  float darker = 0.2F;        // an unlit one reflects this much less than its tile
  float tube_pitch = 0.15F;   // [m] across, from tube to tube; 0 = no tubes to see
  float tube_phase = 0.5F;    // 0.5 = a tube on the middle line, 0 = the middle line is between two
  float half_side = 1.0F;     // +1 or -1: which side of the middle line burns
};

/// Part of a row of pixels: where on the shape's plane each one looks, the light that falls there and the brightness
/// seen so far, which drawing changes.
struct RowSpan {
  const float* x = nullptr;
  const float* y = nullptr;
  const float* light = nullptr;
  float* brightness = nullptr;
  int count = 0;
};

/// Draws one row of a shape over what is there: anti-aliased edges, and around lit ones bloom and halo.
void draw(const Shape& shape, const RowSpan& row);

}  // namespace luminav::simulated
