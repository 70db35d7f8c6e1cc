#pragma once

#include <string>
#include <vector>

#include "drivers/camera/simulated/catalogue/part.hpp"
#include "services/common/building/building.hpp"

namespace luminav::simulated {

/// What a camera sees up there that is no luminaire.
enum class ClutterKind {
  kVent,
  kSmokeDetector,
  kLoudspeaker,
  kExitSign,
  kFourWayDiffuser,
  kSlotDiffuser,
  kCassette,
  kSprinkler,
  kBeam,
  kPipe,
  kCableTray,
  kSkylight,
  kGlassRoof,
  kPoster,
  kWindowFrame,
  kReflection,
  kHead
};

/// One of them in a building.
struct ClutterItem {
  ClutterKind kind = ClutterKind::kVent;
  Pose2 world_from_item;
  double length = 0.6;  // [m]
  double width = 0.6;   // [m]
  double height = 2.8;  // [m] above the floor; lower than the ceiling: it hides what hangs above
};

/// A kind as hung: its size and how far below the ceiling it is.
struct UsualClutter {
  ClutterKind kind;
  const char* name;
  double length;  // [m]
  double width;   // [m]
  double below;   // [m] below the ceiling
};

/// All kinds with their usual sizes.
const std::vector<UsualClutter>& usual_clutter();

/// What it looks like from below.
std::vector<Part> parts_of(ClutterKind kind, double length, double width);
/// What a building's file calls an element. Detectors and speakers are round with `length` as their diameter.
ClutterItem clutter_of(const CeilingElement& element, double ceiling_height);

}  // namespace luminav::simulated
