#pragma once

#include <vector>

#include "drivers/camera/simulated/catalogue/part.hpp"
#include "drivers/camera/simulated/truth.hpp"
#include "drivers/simulator/world/luminaire_kind.hpp"
#include "services/common/building/building.hpp"

namespace luminav::simulated {

/// What a luminaire looks like from below. `darker` is by how much [share of its tile's brightness] a cover is darker
/// than the tile when it is off; bare tubes, troughs and bodies have reflectances of their own. A flickering one looks
/// like a lit one with less emission. Half lit: of several tubes the first burn, those towards -y.
std::vector<Part> parts_of(LuminaireKind kind, const Fixture& fixture, LampState state, double darker);

}  // namespace luminav::simulated
