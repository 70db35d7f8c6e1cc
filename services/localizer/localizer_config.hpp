#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "services/common/building/building.hpp"
#include "services/common/building/occupancy_grid.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/localizer/model/error_model.hpp"
#include "services/localizer/model/wheel_correction.hpp"
#include "services/localizer/modern_localizer.hpp"
#include "services/localizer/paper/paper_localizer.hpp"

namespace luminav {

enum class LocalizerMode { kPaper, kModern };

/// All that the localizer needs to know before it starts.
struct LocalizerConfig {
  LocalizerMode mode = LocalizerMode::kModern;
  std::uint64_t seed = 1;
  std::string state_dir;  // pose memory; "" = off
  RobotDescription robot;
  Building building;
  PriorMap walls;  // the building's map; empty when it has none
  ErrorParams errors;
  WheelCorrection wheels;  // from a calibration drive
  ModernLocalizerParams modern;
  PaperLocalizerParams paper;
};

/// Reads the robot's file with its table [localizer] and the building with its map. Throws ConfigurationError.
LocalizerConfig read_localizer_config(const std::filesystem::path& robot_file,
                                      const std::filesystem::path& building_file);

/// The localizer of the mode that the configuration asks for.
std::unique_ptr<Localizer> make_localizer(const LocalizerConfig& config);

}  // namespace luminav
