#include "drivers/camera/simulated/catalogue/luminaires.hpp"

#include <algorithm>

namespace luminav::simulated {
namespace {

// Own light against a tile at 1, which has some 100 cd/m^2 in a lit office. A bare T8 tube has 10,000 cd/m^2, covers
// with a tube or LEDs behind 2,000 to 5,000 (EN 12464-1 asks for less than 3,000 by the angle of view).
constexpr double kTube = 60.0;
constexpr double kOpal = 25.0;
constexpr double kPrism = 14.0;  // and more where a tube is behind
// A louvre hides its lamps beyond 65 degrees only; from below its mirrors show them. Two tubes of 3,350 lm, of which 65
// % leave with 300 cd a klm straight down, are 5,600 cd/m^2 over the aperture, a third of which the tubes themselves
// give.
constexpr double kMirror = 12.0;  // matt and dusty ones have less
constexpr double kWorn = 2.5;     // the only tube of a luminaire, half burnt
constexpr double kDimmed = 0.5;   // of all LEDs of a luminaire, at half power
constexpr double kLeaked = 0.45;
constexpr double kTubeRadius = 0.013;  // [m] T8

using Kind = LuminaireKind;

/// The fixture and its light, and names for what all kinds ask.
struct Plan {
  const Fixture& fixture;
  LampState state;
  double darker;

  [[nodiscard]] double length() const { return 0.5 * fixture.length; }  // [m] half of it
  [[nodiscard]] double width() const { return 0.5 * fixture.width; }    // [m] half of it
  [[nodiscard]] int tubes() const { return std::max(1, fixture.lamps); }
  [[nodiscard]] bool is_off() const { return state == LampState::kOff; }
  [[nodiscard]] bool is_half() const { return state == LampState::kHalf; }
  [[nodiscard]] int burning() const { return is_off() ? 0 : is_half() ? (tubes() + 1) / 2 : tubes(); }
  /// [m] across, of a tube's axis.
  [[nodiscard]] double axis(int tube) const { return 2.0 * width() * ((tube + 0.5) / tubes() - 0.5); }
  /// `lit`, or of a single tube half burnt little, or of one that does not burn what comes from its neighbours.
  [[nodiscard]] double light_of(int tube, double lit) const {
    return is_off() ? 0.0 : tube >= burning() ? kLeaked : is_half() && tubes() == 1 ? std::min(lit, kWorn) : lit;
  }
  [[nodiscard]] double glow(double full) const {
    return is_off() ? 0.0 : (is_half() ? (tubes() == 1 ? 0.2 : 0.5) * full : full);
  }
};

Part body(const Plan& plan, double reflectance, double inset = 0.0) {
  return {.half_length = plan.length() - inset, .half_width = plan.width() - inset, .reflectance = reflectance};
}

/// A cover that is lit from behind; of two tubes one side when half of them burn.
void add_cover(const Plan& plan, double inset, double reflectance, double emission, std::vector<Part>& parts) {
  Part cover = body(plan, reflectance, inset);
  const bool one_side = plan.is_half() && plan.tubes() > 1;
  cover.emission = plan.is_off() ? 0.0 : one_side ? kLeaked : plan.is_half() ? std::min(kWorn, emission) : emission;
  parts.push_back(cover);
  if (one_side) {
    const double burning = static_cast<double>(plan.burning()) / plan.tubes();
    cover.half_width *= burning;
    cover.y = -(plan.width() - inset) * (1.0 - burning);
    cover.emission = emission;
    cover.softness = 0.02;
    parts.push_back(cover);
  }
}

std::vector<Part> panel(const Plan& plan) {
  constexpr double kLamp = 9.0;
  std::vector<Part> parts;
  add_cover(plan, 0.0, 1.0 - plan.darker, 0.5 * kLamp, parts);
  for (int tube = 0; tube < plan.tubes(); ++tube) {
    Part line = body(plan, 1.0 - plan.darker + 0.04);
    line.half_width = std::min(line.half_width, kTubeRadius);
    line.y = plan.axis(tube);
    line.emission = plan.light_of(tube, kLamp);
    parts.push_back(line);
  }
  parts.front().glow = plan.is_half() && plan.tubes() > 1 ? 0.0 : plan.glow(1.0);
  if (plan.is_half() && plan.tubes() > 1) {
    parts[1].glow = 1.0;
  }
  return parts;
}

std::vector<Part> louvre(const Plan& plan) {
  constexpr double kBar = 0.015;  // [m] half the bright bar between two troughs
  Part frame = body(plan, 0.95);
  frame.emission = plan.is_off() ? 0.0 : 0.2;
  frame.glow = plan.glow(0.7);
  std::vector<Part> parts{frame};
  const double half_trough = plan.width() / plan.tubes() - kBar;
  for (int tube = 0; tube < plan.tubes(); ++tube) {
    Part trough{.y = plan.axis(tube), .half_length = plan.length() - 0.02, .half_width = half_trough};
    trough.reflectance = 0.35;  // a mirror that shows the floor
    trough.emission = plan.light_of(tube, kMirror);
    trough.rib_pitch = 0.1;
    trough.rib_depth = 0.35;
    parts.push_back(trough);
  }
  for (int tube = 0; tube < plan.tubes(); ++tube) {
    Part line{.round = true, .y = plan.axis(tube), .half_length = plan.length() - 0.03, .half_width = kTubeRadius};
    line.reflectance = 0.6;
    line.emission = plan.light_of(tube, kTube);
    line.rib_pitch = 0.1;
    line.rib_depth = 0.3;
    parts.push_back(line);
  }
  return parts;
}

std::vector<Part> batten(const Plan& plan) {
  Part shade = body(plan, plan.is_off() ? 0.82 : 1.0, -0.03);  // below itself when off, and a pool of light when on
  shade.softness = plan.is_off() ? 0.06 : 0.2;
  shade.emission = plan.glow(0.5);
  Part back = body(plan, 0.92);
  back.emission = plan.glow(1.2);
  back.glow = plan.glow(0.7);
  std::vector<Part> parts{shade, back};
  for (int tube = 0; tube < plan.tubes(); ++tube) {
    Part line{.round = true, .y = plan.axis(tube), .half_length = plan.length() - 0.01, .half_width = kTubeRadius};
    line.reflectance = 0.98;
    line.emission = plan.light_of(tube, kTube);
    parts.push_back(line);
  }
  for (const double end : {-1.0, 1.0}) {  // lamp holders
    parts.push_back({.x = end * (plan.length() - 0.012),
                     .half_length = 0.012,
                     .half_width = std::min(plan.width(), 0.02 * plan.tubes() + 0.01),
                     .reflectance = 0.8});
  }
  return parts;
}

std::vector<Part> opal(const Plan& plan, bool framed) {
  std::vector<Part> parts;
  Part edge = body(plan, framed ? 0.6 : 0.7);  // an aluminium frame, or the joint around a cover
  edge.glow = plan.glow(1.0);
  parts.push_back(edge);
  add_cover(plan, framed ? 0.018 : 0.004, 1.0 - plan.darker, kOpal, parts);
  return parts;
}

std::vector<Part> prismatic(const Plan& plan) {
  Part edge = body(plan, 0.75);
  edge.glow = plan.glow(0.9);
  std::vector<Part> parts{edge};
  add_cover(plan, 0.006, 1.0 - plan.darker, kPrism, parts);
  for (int tube = 0; tube < plan.tubes(); ++tube) {
    Part line{.round = true, .y = plan.axis(tube), .half_length = plan.length() - 0.04, .half_width = 0.025};
    line.reflectance = 1.0 - plan.darker + (plan.is_off() ? 0.04 : 0.0);
    line.emission = plan.light_of(tube, kTube);
    line.softness = 0.03;
    if (tube < plan.burning() || plan.is_off()) {
      parts.push_back(line);
    }
  }
  for (Part& part : parts) {
    part.rib_pitch = 0.025;
    part.rib_depth = 0.15;
  }
  return parts;
}

/// On ropes below the ceiling, which it lights too.
std::vector<Part> pendant(const Plan& plan) {
  Part pool = body(plan, 1.0, -0.25);
  pool.softness = 0.4;
  pool.emission = plan.glow(0.8);
  Part edge = body(plan, 0.45);
  edge.glow = plan.glow(1.0);
  std::vector<Part> parts;
  if (!plan.is_off()) {
    parts.push_back(pool);
  }
  parts.push_back(edge);
  Part cover = body(plan, 1.0 - plan.darker, 0.012);
  cover.emission = plan.is_off() ? 0.0 : plan.is_half() ? kDimmed * kWorn : kOpal;
  parts.push_back(cover);
  return parts;
}

Part disc(double radius, double reflectance, double emission) {
  return {.round = true, .half_length = radius, .half_width = radius, .reflectance = reflectance, .emission = emission};
}

std::vector<Part> downlight(const Plan& plan) {
  const double lit = plan.is_off() ? 0.0 : plan.is_half() ? 0.1 : 1.0;
  Part ring = disc(plan.length(), 0.97, 0.0);
  ring.glow = plan.glow(0.8);
  Part lamp = disc(0.45 * plan.length(), 0.8, lit * kOpal);
  lamp.softness = 0.01;
  return {ring, disc(0.86 * plan.length(), 0.45, lit * 6.0), lamp};
}

std::vector<Part> high_bay(const Plan& plan) {
  const double lit = plan.is_off() ? 0.0 : plan.is_half() ? 0.06 : 1.0;
  Part rim = disc(plan.length(), 0.3, 0.0);
  rim.glow = plan.glow(1.0);
  Part lamp = disc(0.3 * plan.length(), 0.85, lit * kTube);
  lamp.softness = 0.02;
  return {rim, disc(0.94 * plan.length(), 0.5, lit * 12.0), lamp};
}

}  // namespace

std::vector<Part> parts_of(LuminaireKind kind, const Fixture& fixture, LampState state, double darker) {
  const Plan plan{fixture, state, darker};
  if (kind == Kind::kPanel && fixture.shape == FixtureShape::kRound) {
    Part only = disc(plan.length(), 1.0 - (plan.is_off() ? darker : 0.0), plan.is_off() ? 0.0 : 9.0);
    only.emission *= plan.is_half() ? 0.5 : 1.0;
    only.glow = plan.is_off() ? 0.0 : plan.is_half() ? 0.5 : 1.0;
    return {only};
  }
  switch (kind) {
    case Kind::kPanel:
      return panel(plan);
    case Kind::kLouvre:
      return louvre(plan);
    case Kind::kBatten:
      return batten(plan);
    case Kind::kOpal:
      return opal(plan, false);
    case Kind::kOpalFramed:
      return opal(plan, true);
    case Kind::kPrismatic:
      return prismatic(plan);
    case Kind::kPendant:
      return pendant(plan);
    case Kind::kDownlight:
      return downlight(plan);
    case Kind::kHighBay:
      return high_bay(plan);
  }
  return {};
}

}  // namespace luminav::simulated
