#pragma once

#include <string>
#include <vector>

#include "drivers/camera/simulated/catalogue/clutter.hpp"
#include "drivers/camera/simulated/truth.hpp"
#include "drivers/simulator/world/luminaire_kind.hpp"
#include "services/common/building/building.hpp"
#include "tests/evaluation/detector_score/detector_score.hpp"

namespace luminav::score {

/// A ceiling of one kind of luminaire in one state, or of one thing that is none.
struct LuminaireScene {
  std::string name;
  std::string state;  // lit, half or off; by day for what is no luminaire
  simulated::LampState lamp = simulated::LampState::kOn;
  LuminaireKind kind = LuminaireKind::kPanel;
  Fixture like;             // shape, size, lamps; height is how far it hangs below the ceiling
  double pitch_x = 2.4;     // [m] from one to the next
  double pitch_y = 1.8;     // [m]
  double ceiling = 2.8;     // [m]
  double daylight = 0.3;    // 0..1
  bool is_clutter = false;  // then no luminaire is in view, and all that is reported is wrong
  simulated::UsualClutter clutter{};
};

/// The catalogue: each kind in each state, then each thing that is none.
const std::vector<LuminaireScene>& luminaire_scenes();

/// Frames below such a ceiling from random places, the tiles and covers drawn anew for each world. Of the options the
/// scenario gives the robot only.
DetectorScore score_scene(const DetectorScoreOptions& options, const LuminaireScene& scene,
                          const FrameListener& listener = {});

}  // namespace luminav::score
