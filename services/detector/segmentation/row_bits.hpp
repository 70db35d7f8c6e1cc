#pragma once

#include <cstddef>
#include <cstdint>

namespace luminav {

/// One bit for each pixel of some rows, 64 in a word, the first of a row in the lowest: set where the grey level is
/// above `level`; what is left of a row's last word is 0. In `pixels` row follows upon row, in `bits` they begin
/// `apart` words from each other.
void take_row_bits(const std::uint8_t* pixels, int width, int rows, int level, std::uint64_t* bits, std::size_t apart);

}  // namespace luminav
