#pragma once

#include <filesystem>
#include <string>

#include "services/common/building/building.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/detector/model/detector_params.hpp"
#include "services/detector/outline/ceiling_catalogue.hpp"

namespace luminav {

struct DetectorConfig {
  DetectorParams params;
  CameraDescription camera;
  CeilingCatalogue catalogue;
  std::string robot;  // its name, for NODE_STATUS
};

/// Reads table [detector] of the robot's file (mode, [detector.paper], [detector.modern]), its camera, and what hangs
/// on the building's ceiling. Throws ConfigurationError.
DetectorConfig read_detector_config(const std::filesystem::path& robot_file,
                                    const std::filesystem::path& building_file);
/// The same for a building that is known already; the file is named where it is wrong.
DetectorConfig read_detector_config(const std::filesystem::path& robot_file, const Building& building,
                                    const std::filesystem::path& building_file);

}  // namespace luminav
