#include "drivers/camera/simulated/catalogue/clutter.hpp"

namespace luminav::simulated {
namespace {

using Kind = ClutterKind;

/// Half its size.
struct Half {
  double length;  // [m]
  double width;   // [m]
};

Part plate(const Half& half, double reflectance, double inset = 0.0) {
  return {.half_length = half.length - inset, .half_width = half.width - inset, .reflectance = reflectance};
}

Part plate_at(double x, double y, const Half& half, double reflectance) {
  return {.x = x, .y = y, .half_length = half.length, .half_width = half.width, .reflectance = reflectance};
}

Part disc(double radius, double reflectance) {
  return {.round = true, .half_length = radius, .half_width = radius, .reflectance = reflectance};
}

Part slatted(Part part, double pitch, double depth, bool follow_x) {
  part.rib_pitch = pitch;
  part.rib_depth = depth;
  part.ribs_follow_x = follow_x;
  return part;
}

Part bright_by_day(Part part, double sky) {
  part.sky = sky;
  return part;
}

std::vector<Part> vent(const Half& half) {
  return {plate(half, 0.88), slatted(plate(half, 0.8, 0.03), 0.05, 0.63, false)};
}

/// White plastic, a darker middle and a shadow at the rim.
std::vector<Part> smoke_detector(const Half& half) {
  Part rim = disc(half.length, 0.7);
  return {rim, disc(0.85 * half.length, 1.08), disc(0.4 * half.length, 0.73)};
}

std::vector<Part> loudspeaker(const Half& half) {
  return {disc(half.length, 0.7), disc(0.85 * half.length, 1.06)};
}

/// Shines by itself, day and night, and carries dark symbols.
std::vector<Part> exit_sign(const Half& half) {
  std::vector<Part> parts{plate(half, 0.8)};
  parts[0].emission = 1.5;
  for (const auto& [x, share] : {std::pair(-0.5, 0.18), {0.3, 0.4}}) {
    parts.push_back(plate_at(x * half.length, 0.0, {share * half.length, 0.55 * half.width}, 0.8));
    parts.back().emission = 0.25;
  }
  return parts;
}

std::vector<Part> four_way_diffuser(const Half& half) {
  std::vector<Part> parts;
  for (int ring = 0; ring < 5; ++ring) {  // cones of sheet and the dark gaps between them
    const double share = 1.0 - 0.2 * ring;
    parts.push_back(plate({share * half.length, share * half.width}, 0.92));
    parts.push_back(plate({(share - 0.05) * half.length, (share - 0.05) * half.width}, 0.4));
  }
  parts.push_back(plate({0.12 * half.length, 0.12 * half.width}, 0.92));
  return parts;
}

std::vector<Part> slot_diffuser(const Half& half) {
  const Half slot{half.length - 0.01, 0.22 * half.width};
  return {plate(half, 0.9), plate_at(0.0, -0.45 * half.width, slot, 0.15),
          plate_at(0.0, 0.45 * half.width, slot, 0.15)};
}

std::vector<Part> cassette(const Half& half) {
  const Half grille{0.55 * half.length, 0.55 * half.width};
  std::vector<Part> parts{plate(half, 1.05), slatted(plate(grille, 0.75), 0.03, 0.6, true)};
  for (const double side : {-1.0, 1.0}) {  // outlets
    parts.push_back(plate_at(side * 0.8 * half.length, 0.0, {0.07 * half.length, 0.6 * half.width}, 0.2));
    parts.push_back(plate_at(0.0, side * 0.8 * half.width, {0.6 * half.length, 0.07 * half.width}, 0.2));
  }
  return parts;
}

std::vector<Part> sprinkler(const Half& half) {
  return {disc(half.length, 1.0), disc(0.6 * half.length, 0.45), disc(0.3 * half.length, 0.9)};
}

std::vector<Part> beam(const Half& half) {
  return {plate(half, 0.8), plate_at(0.0, -0.8 * half.width, {half.length, 0.2 * half.width}, 0.5)};
}

/// Round: dark at its sides, a bright line along its middle.
std::vector<Part> pipe(const Half& half) {
  Part shine = plate({half.length, 0.4 * half.width}, 0.95);
  shine.softness = 0.5 * half.width;
  return {plate(half, 0.4), plate({half.length, 0.75 * half.width}, 0.6), shine};
}

std::vector<Part> cable_tray(const Half& half) {
  return {slatted(plate(half, 0.6), 0.3, 0.5, true), plate_at(0.0, -0.95 * half.width, {half.length, 0.012}, 0.85),
          plate_at(0.0, 0.95 * half.width, {half.length, 0.012}, 0.85),
          plate_at(0.0, 0.3 * half.width, {half.length, 0.2 * half.width}, 0.2)};
}

/// `columns` x `rows` panes of sky between bars.
std::vector<Part> glazing(const Half& half, int columns, int rows, double bar, double bar_reflectance) {
  std::vector<Part> parts{plate(half, bar_reflectance)};
  const Half pane{half.length / columns - bar, half.width / rows - bar};
  for (int column = 0; column < columns; ++column) {
    for (int row = 0; row < rows; ++row) {
      const double x = half.length * ((2.0 * column + 1.0) / columns - 1.0);
      const double y = half.width * ((2.0 * row + 1.0) / rows - 1.0);
      parts.push_back(bright_by_day(plate_at(x, y, pane, 0.05), 12.0));
    }
  }
  parts.front().glow = 0.5;
  return parts;
}

std::vector<Part> poster(const Half& half) {
  return {plate(half, 1.1), plate(half, 0.45, 0.04),
          plate_at(-0.3 * half.length, 0.1 * half.width, {0.4 * half.length, 0.5 * half.width}, 0.85),
          plate_at(0.6 * half.length, 0.0, {0.15 * half.length, 0.7 * half.width}, 0.2)};
}

/// Of a lamp, in a glass pane or a glossy floor: dim, not sharp, cut by an edge.
std::vector<Part> reflection(const Half& half) {
  Part glass = plate({half.length + 0.05, half.width + 0.2}, 0.85);
  glass.y = 0.15;
  Part image = plate(half, 0.9);
  image.emission = 0.5;
  image.softness = 0.05;
  return {glass, image};
}

std::vector<Part> head(const Half& half) {
  Part shoulders{.round = true, .half_length = half.length, .half_width = 0.45 * half.length, .reflectance = 0.35};
  Part hair = disc(half.width, 0.1);
  hair.x = 0.02;
  return {shoulders, hair};
}

}  // namespace

const std::vector<UsualClutter>& usual_clutter() {
  static const std::vector<UsualClutter> all{
      {Kind::kVent, "vent", 0.6, 0.6, 0.0},
      {Kind::kSmokeDetector, "smoke detector", 0.11, 0.11, 0.0},
      {Kind::kLoudspeaker, "loudspeaker", 0.22, 0.22, 0.0},
      {Kind::kExitSign, "exit sign", 0.35, 0.15, 0.0},
      {Kind::kFourWayDiffuser, "four-way diffuser", 0.6, 0.6, 0.0},
      {Kind::kSlotDiffuser, "slot diffuser", 1.2, 0.1, 0.0},
      {Kind::kCassette, "cassette", 0.9, 0.9, 0.0},
      {Kind::kSprinkler, "sprinkler", 0.06, 0.06, 0.0},
      {Kind::kBeam, "beam", 8.0, 0.25, 0.3},
      {Kind::kPipe, "pipe", 8.0, 0.08, 0.2},
      {Kind::kCableTray, "cable tray", 8.0, 0.3, 0.25},
      {Kind::kSkylight, "skylight", 1.2, 0.9, 0.0},
      {Kind::kGlassRoof, "glass roof", 5.0, 4.0, 0.0},
      {Kind::kPoster, "poster", 1.0, 0.7, 0.4},
      {Kind::kWindowFrame, "window frame", 1.6, 1.2, 0.4},
      {Kind::kReflection, "reflection", 0.85, 0.2, 0.0},
      {Kind::kHead, "head", 0.5, 0.18, 1.1},
  };
  return all;
}

std::vector<Part> parts_of(ClutterKind kind, double length, double width) {
  const Half half{0.5 * length, 0.5 * width};
  switch (kind) {
    case Kind::kVent:
      return vent(half);
    case Kind::kSmokeDetector:
      return smoke_detector(half);
    case Kind::kLoudspeaker:
      return loudspeaker(half);
    case Kind::kExitSign:
      return exit_sign(half);
    case Kind::kFourWayDiffuser:
      return four_way_diffuser(half);
    case Kind::kSlotDiffuser:
      return slot_diffuser(half);
    case Kind::kCassette:
      return cassette(half);
    case Kind::kSprinkler:
      return sprinkler(half);
    case Kind::kBeam:
      return beam(half);
    case Kind::kPipe:
      return pipe(half);
    case Kind::kCableTray:
      return cable_tray(half);
    case Kind::kSkylight:
      return glazing(half, 2, 1, 0.025, 0.7);
    case Kind::kGlassRoof:
      return glazing(half, 5, 6, 0.03, 0.3);
    case Kind::kPoster:
      return poster(half);
    case Kind::kWindowFrame:
      return glazing(half, 2, 1, 0.04, 0.6);
    case Kind::kReflection:
      return reflection(half);
    case Kind::kHead:
      return head(half);
  }
  return {};
}

ClutterItem clutter_of(const CeilingElement& element, double ceiling_height) {
  ClutterItem item{.world_from_item = element.world_from_element,
                   .length = element.length,
                   .width = element.width,
                   .height = ceiling_height};
  switch (element.kind) {
    case ElementKind::kVent:
      item.kind = Kind::kVent;
      break;
    case ElementKind::kDetector:
      item.kind = Kind::kSmokeDetector;
      break;
    case ElementKind::kSpeaker:
      item.kind = Kind::kLoudspeaker;
      break;
    case ElementKind::kSign:
      item.kind = Kind::kExitSign;
      break;
  }
  return item;
}

}  // namespace luminav::simulated
