#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "services/localizer/calibration/drive_calibration.hpp"

namespace luminav {
namespace {

std::string trimmed(const std::string& line) {
  const std::size_t first = line.find_first_not_of(" \t");
  return first == std::string::npos ? "" : line.substr(first);
}

bool sets_key(const std::string& line, const std::string& key) {
  const std::string text = trimmed(line);
  if (text.rfind(key, 0) != 0) {
    return false;
  }
  const std::string rest = trimmed(text.substr(key.size()));
  return !rest.empty() && rest.front() == '=';
}

/// Sets `key` in `[table]`: in its old place, or at the table's end, or in a new table at the end of the file.
void set(std::vector<std::string>& lines, const std::string& table, const std::string& key, const std::string& value) {
  const std::string line = key + " = " + value;
  const auto is_header = [](const std::string& text) { return trimmed(text).rfind('[', 0) == 0; };
  const auto header = std::find_if(lines.begin(), lines.end(), [&](const std::string& text) {
    return trimmed(text).rfind("[" + table + "]", 0) == 0;
  });
  if (header == lines.end()) {
    lines.insert(lines.end(), {"", "[" + table + "]", line});
    return;
  }
  auto end = std::find_if(header + 1, lines.end(), is_header);
  const auto old = std::find_if(header + 1, end, [&](const std::string& text) { return sets_key(text, key); });
  if (old != end) {
    *old = line;
    return;
  }
  while (end != header + 1 && trimmed(*(end - 1)).empty()) {
    --end;
  }
  lines.insert(end, line);
}

std::string with_sigma(double value, double sigma) {
  return fmt::format("{:.6f}  # +- {:.6f}, calibrated by driving", value, sigma);
}

std::string error(double sigma) {
  constexpr double kLeast = 1e-4;  // an estimate from one drive is never surer than that
  return fmt::format("{:.6f}  # as the calibration left it", std::max(kLeast, sigma));
}

}  // namespace

std::string write_into(const std::string& robot_toml, const DriveCalibration& calibration,
                       const LocalizerConfig& config) {
  std::vector<std::string> lines;
  std::istringstream in(robot_toml);
  for (std::string line; std::getline(in, line);) {
    lines.push_back(line);
  }
  const RobotDescription robot = apply(calibration, config.robot, config.building.ceiling_height);
  const CameraMounting& mounting = robot.camera.mounting;
  const double height = config.building.ceiling_height - mounting.z;
  set(lines, "camera", "z", with_sigma(mounting.z, height * calibration.camera_scale.sigma));
  set(lines, "camera", "roll", with_sigma(mounting.roll, calibration.tilt_y.sigma));
  set(lines, "camera", "pitch", with_sigma(mounting.pitch, calibration.tilt_x.sigma));
  set(lines, "camera", "yaw", with_sigma(mounting.yaw, calibration.yaw.sigma));
  set(lines, "camera", "time_offset", with_sigma(robot.camera.time_offset, calibration.time_offset.sigma));
  set(lines, "localizer.wheels", "scale", with_sigma(calibration.wheel_scale.value, calibration.wheel_scale.sigma));
  set(lines, "localizer.wheels", "ratio", with_sigma(calibration.wheel_ratio.value, calibration.wheel_ratio.sigma));
  set(lines, "localizer.wheels", "base", with_sigma(calibration.wheel_base.value, calibration.wheel_base.sigma));
  set(lines, "localizer.errors", "wheel_scale", error(calibration.wheel_scale.sigma));
  set(lines, "localizer.errors", "wheel_ratio", error(calibration.wheel_ratio.sigma));
  set(lines, "localizer.errors", "wheel_base", error(calibration.wheel_base.sigma));
  set(lines, "localizer.errors", "camera_tilt", error(std::max(calibration.tilt_x.sigma, calibration.tilt_y.sigma)));
  set(lines, "localizer.errors", "camera_yaw", error(calibration.yaw.sigma));
  set(lines, "localizer.errors", "camera_scale", error(calibration.camera_scale.sigma));
  set(lines, "localizer.errors", "camera_time_offset", error(calibration.time_offset.sigma));
  std::string text;
  for (const std::string& line : lines) {
    text += line + "\n";
  }
  return text;
}

}  // namespace luminav
