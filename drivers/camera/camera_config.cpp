#include "drivers/camera/camera_config.hpp"

#include <stdexcept>

#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

ExposureParams read_exposure(const TomlTable& table) {
  ExposureParams p;
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
  config.exposure = read_exposure(table);
  table.reject_unknown();
  try {
    const ExposureControl check(config.exposure);
  } catch (const std::invalid_argument& error) {
    table.fail("min_target", error.what());
  }
  return config;
}

}  // namespace luminav
