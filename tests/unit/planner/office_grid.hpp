#pragma once

#include <cstdint>
#include <vector>

namespace luminav {

/// The office floor of the performance page: rooms of 4 x 5 m with doors and boxes along corridors, `side` cells
/// square, 1 = occupied, row-major.
std::vector<std::uint8_t> office_grid(int side, double resolution);

/// FNV-1a, 64 bits.
std::uint64_t fnv1a(const std::vector<std::uint8_t>& bytes);

}  // namespace luminav
