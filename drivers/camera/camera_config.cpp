#include "drivers/camera/camera_config.hpp"

#include <stdexcept>

#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

ExposureParams read_exposure(const TomlTable& table) {
  ExposureParams p;
  p.target_least = table.number("target_least", p.target_least, {1.0, 254.0});
  p.target_most = table.number("target_most", p.target_most, {1.0, 254.0});
  p.lamp_grey = table.number("lamp_grey", p.lamp_grey, {2.0, 255.0});
  p.exposure_least_us = table.number("exposure_least_us", p.exposure_least_us, {1.0, 1e6});
  p.exposure_most_us = table.number("exposure_most_us", p.exposure_most_us, {1.0, 1e6});
  p.gain_most = table.number("gain_most", p.gain_most, {1.0, 1000.0});
  p.step_most = table.number("step_most", p.step_most, {1.01, 20.0});
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
  config.size_most = table.count("size_most", config.size_most, {1000, 64000});
  config.exposure = read_exposure(table);
  table.reject_unknown();
  try {
    const ExposureControl check(config.exposure);
  } catch (const std::invalid_argument& error) {
    table.fail("target_least", error.what());
  }
  return config;
}

}  // namespace luminav
