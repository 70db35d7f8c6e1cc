#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "drivers/camera/simulated/renderer.hpp"
#include "drivers/simulator/geometry/random_stream.hpp"
#include "drivers/simulator/world/world_truth.hpp"
#include "services/common/image/grey_image.hpp"
#include "tests/evaluation/detector_score/detector_score.hpp"
#include "tests/evaluation/detector_score/imaged_fixture.hpp"

namespace luminav::score {

/// From where and in what light a frame is taken.
struct Place {
  FrameMotion motion;
  double daylight = 0.5;
};

/// State of each of `count` fixtures.
std::vector<simulated::LampState> draw_lamps(const Condition& condition, std::size_t count, RandomStream& random);

Place draw_place(const Condition& condition, const WorldTruth& world, RandomStream& random, SplitMix& generator);

/// Sets what the exposure control would settle at, then the condition's error of it.
void expose(simulated::CeilingRenderer& renderer, const Pose2& pose, double factor, simulated::Exposure& exposure);

/// A frame, row by row while the robot moves.
void render(simulated::CeilingRenderer& renderer, const FrameMotion& motion, simulated::Exposure& exposure,
            GreyImage& image);

}  // namespace luminav::score
