#pragma once

#include <string>
#include <vector>

#include "drivers/camera/simulated/renderer.hpp"
#include "services/detector/model/detection.hpp"
#include "tests/evaluation/detector_score/detector_score.hpp"
#include "tests/evaluation/detector_score/imaged_fixture.hpp"

namespace luminav::score {

/// A fixture that a frame shows, and what is true of it.
struct VisibleFixture {
  ImagedFixture imaged;
  const Fixture* fixture = nullptr;
  simulated::LampState lamp = simulated::LampState::kOn;
  bool taken = false;     // by a detection
  bool is_plain = false;  // a person sees its outline
};

/// Counts what one frame shows and what was reported; returns what is to be said against it.
std::vector<std::string> judge(const std::vector<Detection>& detections, std::vector<VisibleFixture>& visible,
                               DetectorScore& score);

}  // namespace luminav::score
