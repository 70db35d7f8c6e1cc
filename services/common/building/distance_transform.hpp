#pragma once

#include <cstddef>
#include <vector>

namespace luminav {

/// Squared distance [cells^2] where no cell is solid.
inline constexpr float kNoSolidCell = 1e12F;

/// Squared distances [cells^2], centre to centre, from each cell of a row-major grid to the nearest solid one. Exact
/// Euclidean transform, Felzenszwalb and Huttenlocher 2012; linear in the number of cells.
std::vector<float> squared_distances_to(const std::vector<bool>& is_solid, std::size_t columns);

}  // namespace luminav
