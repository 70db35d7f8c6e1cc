#pragma once

#include <filesystem>
#include <vector>

namespace luminav {

/// The scenarios of mishaps, in the drawn buildings and the laboratory: fixtures that hang elsewhere than the file
/// says, wheels that slip, a robot that is bumped. Same files each time.
std::vector<std::filesystem::path> make_mishaps(const std::filesystem::path& folder);

}  // namespace luminav
