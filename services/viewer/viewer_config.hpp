#pragma once

#include <cstdint>
#include <filesystem>

#include "services/common/building/building.hpp"
#include "services/common/configuration/robot_file.hpp"

namespace luminav {

struct ViewerConfig {
  RobotDescription robot;
  Building building;
  std::int64_t picture_period = 500'000;  // [us] between camera pictures shown
};

/// Throws ConfigurationError.
ViewerConfig read_viewer_config(const std::filesystem::path& robot_file, const std::filesystem::path& building_file);

}  // namespace luminav
