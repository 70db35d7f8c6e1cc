#pragma once

#include <cstdint>

namespace luminav {

// The numbers of SIM_TRUTH.
inline constexpr std::int8_t kLampOff = 0;
inline constexpr std::int8_t kLampOn = 1;
inline constexpr std::int8_t kLampHalf = 2;
inline constexpr std::int8_t kLampFlicker = 3;

}  // namespace luminav
