#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/evaluation/detector_score/detector_score.hpp"

namespace luminav::score {

/// By how much building file, robot file and light miss the truth.
struct Mistake {
  std::string name;
  double size = 1.0;      // told length and width, of the true ones
  double height = 1.0;    // told heights above the floor, of the true ones
  double pitch = 0.0;     // [rad] of the camera, told less true
  double roll = 0.0;      // [rad]
  double focal = 1.0;     // told focal length, of the true one
  double lower = 0.0;     // [m] by which the fixtures hang lower than the file says
  double exposure = 1.0;  // of what the exposure control settles at
};

/// None first, then each mistake that an installer may make alone.
const std::vector<Mistake>& mistakes();

/// What is found in the same frames under one mistake after the other; frames with a third of the lamps off. A fixture
/// counts as found when what is said of it lies on it in the image: places on the ceiling are as wrong as what the
/// detector was told. Centres and covariances are not measured.
std::vector<DetectorScore> score_mistakes(const DetectorScoreOptions& options);

}  // namespace luminav::score
