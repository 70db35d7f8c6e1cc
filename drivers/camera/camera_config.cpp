#include "drivers/camera/camera_config.hpp"

#include <stdexcept>

#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

/// The paper's control knows no other aim while lamps burn.
ExposureParams read_exposure(const TomlTable& table, const std::string& mode) {
  ExposureParams p;
  if (table.choice("mode", mode, {"paper", "modern"}) == "paper") {
    p.lit_target = 1.0;
  }
  p.two_exposures = table.boolean("two_exposures", p.two_exposures);
  p.lamp_exposure = table.number("lamp_exposure", p.lamp_exposure, {0.005, 0.25});
  p.lit_target = table.number("lit_target", p.lit_target, {0.01, 1.0});
  p.lamp_share = table.number("lamp_share", p.lamp_share, {0.0, 0.5});
  p.lamp_memory = table.count("lamp_memory", p.lamp_memory, {0, 10'000});
  p.min_target = table.number("min_target", p.min_target, {1.0, 254.0});
  p.max_target = table.number("max_target", p.max_target, {1.0, 254.0});
  p.lamp_grey = table.number("lamp_grey", p.lamp_grey, {2.0, 255.0});
  p.min_exposure_us = table.number("min_exposure_us", p.min_exposure_us, {1.0, 1e6});
  p.max_exposure_us = table.number("max_exposure_us", p.max_exposure_us, {1.0, 1e6});
  p.max_gain = table.number("max_gain", p.max_gain, {1.0, 1000.0});
  p.max_step = table.number("max_step", p.max_step, {1.01, 20.0});
  p.patience = table.count("patience", p.patience, {1, 100});
  p.turning_rate = table.number("turning_rate", p.turning_rate, {0.0, 10.0});
  p.initial_exposure_us = table.number("initial_exposure_us", p.initial_exposure_us, {1.0, 1e6});
  return p;
}

}  // namespace

CameraConfig read_camera_config(const std::filesystem::path& robot_file) {
  const TomlTable root = TomlTable::load(robot_file);
  const RobotDescription robot = read_robot(root);
  const TomlTable table = root.table("camera_driver");
  CameraConfig config;
  config.robot = robot.name;
  config.camera = robot.camera;
  config.camera_index = table.count("camera_index", config.camera_index, {0, 127});
  config.rate = table.number("rate", config.rate, {0.5, 120.0});
  config.encoding =
      table.choice("encoding", "jpeg", {"jpeg", "mono8"}) == "jpeg" ? ImageEncoding::kJpeg : ImageEncoding::kMono8;
  config.quality = table.count("quality", config.quality, {1, 100});
  config.max_size = table.count("max_size", config.max_size, {1000, 64000});
  config.exposure = read_exposure(table, robot.mode);
  table.reject_unknown();
  try {
    const ExposureControl check(config.exposure);
  } catch (const std::invalid_argument& error) {
    table.fail("min_target", error.what());
  }
  return config;
}

}  // namespace luminav
