#pragma once

#include <vector>

#include "services/surveyor/survey/ceiling_kinds.hpp"
#include "services/surveyor/survey/key_frames.hpp"

namespace luminav {

/// A fixture seen from one key frame.
struct PassSighting {
  int frame = 0;  // index into the key frames
  FixtureSighting sighting;
};

/// One fixture in view, once, from when it came until it went. The same fixture passed again is another pass.
struct FixturePass {
  int kind = 0;  // index into the kinds
  std::vector<PassSighting> sightings;
};

/// Joins the sightings of the key frames to passes. Sightings of which neither end is in view say too little of where
/// the fixture is, and what is of no kind is none: both are left out.
std::vector<FixturePass> find_passes(const std::vector<KeyFrame>& frames, const CeilingKinds& kinds);

/// By how much the fixtures of a kind look longer than the file of kinds says: the median over the sightings that show
/// all of one, as a fraction; 0 where there is none.
double excess_length(const std::vector<FixturePass>& passes, const CeilingKinds& kinds, int kind);

}  // namespace luminav
