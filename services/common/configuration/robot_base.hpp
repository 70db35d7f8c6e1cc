#pragma once

#include <filesystem>
#include <string>

namespace luminav {

/// Key `base` of the robot's file, "p3dx" or "create2": whose driver runs, and what is simulated. No service asks for
/// it. Throws ConfigurationError.
std::string read_robot_base(const std::filesystem::path& robot_file);

}  // namespace luminav
