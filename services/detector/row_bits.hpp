#pragma once

#include <cstdint>

namespace luminav {

/// One bit for each pixel of a row, 64 in a word, the first in the lowest: set where the grey level is above `above` or
/// not above `not_above`; the last word's others are 0.
void take_row_bits(const std::uint8_t* pixels, int width, int above, int not_above, std::uint64_t* bits);

}  // namespace luminav
