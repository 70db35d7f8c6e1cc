#pragma once

#include <luminav/sim_truth_t.hpp>

#include "drivers/camera/simulated/truth.hpp"

namespace luminav {

/// What the simulated ceiling needs of a SIM_TRUTH message.
simulated::TruthSample truth_sample(const sim_truth_t& message);

}  // namespace luminav
