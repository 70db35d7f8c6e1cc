#pragma once

#include <filesystem>

#include "services/common/building/building.hpp"

namespace luminav {

/// Reads a building.toml strictly. Throws ConfigurationError, naming file, line, key and what is allowed; two fixtures
/// with one id are an error.
Building read_building(const std::filesystem::path& file);

}  // namespace luminav
