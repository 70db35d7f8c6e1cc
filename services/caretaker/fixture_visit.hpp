#pragma once

#include <cstdint>
#include <optional>

#include "services/common/building/building.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// One fixture wholly in view of a robot that knew its pose, from when it came until it went.
struct FixtureVisit {
  std::int64_t begin = 0;  // [us] of the first image
  std::int64_t end = 0;    // [us] of the last one
  int expected = 0;        // images that had all of it in view
  int lit = 0;             // of these, in how many it burnt,
  int half = 0;            // burnt in part,
  int unlit = 0;           // was seen dark
  int changes = 0;         // from burning to not burning or back, from one image to the next
  Pose2 offset;            // where it is seen beside where the file has it, world axes; median over `seen` images
  double grey = 0.0;       // 0..255 mean of the images' medians: how light the ceiling was

  [[nodiscard]] int seen() const { return lit + half + unlit; }
};

/// Whether it burnt; nothing when the images do not agree.
std::optional<bool> was_burning(const FixtureVisit& visit);
/// Whether only some of its lamps burnt, in most of the images.
bool was_half_lit(const FixtureVisit& visit);
/// Whether it went on and off while one looked.
bool was_flickering(const FixtureVisit& visit);

/// Something that looks like a fixture, hung where the file has none, and was in view once.
struct StrangerVisit {
  std::int64_t begin = 0;  // [us]
  std::int64_t end = 0;    // [us]
  int seen = 0;            // images
  FixtureShape shape = FixtureShape::kRectangle;
  Pose2 world_from_fixture;  // median
  double length = 0.0;       // [m] median
  double width = 0.0;        // [m]
};

}  // namespace luminav
