// Estimates from the log of a drive what is wrong with the robot's wheels and camera, and writes it to the robot's
// file.

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "services/common/configuration/robot_file.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/common/process/command_line.hpp"
#include "services/localizer/calibration/drive_calibration.hpp"

namespace luminav {
namespace {

constexpr double kSpacing = 0.10;        // [m] between images used
constexpr double kTurn = radians(5.0);   // [rad] likewise
constexpr std::size_t kMinFrames = 100;  // of a drive worth the name

void print(const char* name, const CalibratedValue& value, double factor, const char* unit) {
  fmt::print("  {:<14} {:+9.3f} +- {:.3f} {}\n", name, factor * value.value, factor * value.sigma, unit);
}

void print(const DriveCalibration& c) {
  fmt::print("{} images with {} sightings over {:.0f} m; residuals {:.2f} deviations\n", c.frames, c.sightings,
             c.distance, c.residual);
  fmt::print("found of the wheels, in all:\n");
  print("wheel scale", c.wheel_scale, 100.0, "%");
  print("wheel ratio", c.wheel_ratio, 100.0, "%");
  print("wheel base", c.wheel_base, 100.0, "%");
  fmt::print("found of the camera, beside what the robot's file says:\n");
  print("picture to x", c.tilt_x, degrees(1.0), "deg");
  print("picture to y", c.tilt_y, degrees(1.0), "deg");
  print("picture turned", c.yaw, degrees(1.0), "deg");
  print("picture larger", c.camera_scale, 100.0, "%");
  print("time offset", c.time_offset, 1e3, "ms");
}

/// scripts/record keeps the files of the drive beside its log. Detections were placed with that camera: what is found
/// says nothing of another one, and nothing twice.
void check_camera(const std::string& log, const CameraDescription& camera) {
  std::filesystem::path kept = log + ".config/robot.toml";
  if (!std::filesystem::exists(kept)) {
    // a part of a log that was split: NAME.00 beside NAME.config
    kept = std::filesystem::path(log).replace_extension().string() + ".config/robot.toml";
  }
  if (std::filesystem::exists(kept) && read_robot(kept).camera != camera) {
    throw std::runtime_error(
        fmt::format("{} was recorded with another [camera] than the robot's file has now; give --robot {} "
                    "and --out, or record a new drive",
                    log, kept.string()));
  }
}

int run(int argc, char** argv) {
  std::vector<std::string> logs;
  std::string robot;
  std::string building;
  std::string out;
  bool only_look = false;
  CommandLine line("calibrate-drive",
                   "Estimates the errors of wheels and camera from the log of a drive of a few "
                   "minutes under known fixtures, and writes them to the robot's file.");
  line.robot_file(robot).building_file(building);
  line.positional("log", logs, "LCM log with ODOMETRY and FIXTURE_DETECTIONS", true);
  line.output_file("--out", out, "file to write instead of the robot's own")
      .flag("--dry-run", only_look, "write nothing");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  if (logs.size() != 1) {
    throw ConfigurationError(fmt::format("found {} logs, must be one", logs.size()));
  }
  LocalizerConfig config = read_localizer_config(robot, building);
  check_camera(logs.front(), config.robot.camera);
  const DriveLog log = read_drive_log(logs.front());
  fmt::print("{} odometry readings, {} images\n", log.odometry.size(), log.frames.size());
  if (log.is_cut) {
    fmt::print("{}: cut off; what was whole before was used\n", logs.front());
  }
  const auto [frames, unused] = follow_drive(log, config, kSpacing, kTurn);
  const std::string why = fmt::format(
      "{} images used; of the others {} were taken while the pose was not known (the localizer begins anew, whatever "
      "it knew while this was recorded), {} less than {:.1f} m and {:.0f} deg from one that is used, {} without a "
      "known fixture",
      frames.size(), unused.not_tracking, unused.too_near, kSpacing, degrees(kTurn), unused.without_fixture);
  if (frames.size() < kMinFrames) {
    throw std::runtime_error(
        fmt::format("{} images are needed: drive longer and farther, where fixtures are; {}", kMinFrames, why));
  }
  fmt::print("{}\n", why);
  const DriveCalibration calibration = calibrate_drive(frames, config);
  print(calibration);
  if (!calibration.has_converged) {
    throw std::runtime_error("the estimate did not settle; nothing is written");
  }
  if (!calibration.fits()) {
    throw std::runtime_error(
        fmt::format("residuals of {:.1f} deviations are no robot's: the pose was wrong for a while, or fixtures "
                    "hang elsewhere than the file says; nothing is written",
                    calibration.residual));
  }
  if (!only_look) {
    const std::string target = out.empty() ? robot : out;
    write_whole_file(target, write_into(read_whole_file(robot), calibration, config));
    fmt::print("written to {}\n", target);
  }
  return 0;
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  return luminav::run_guarded("calibrate-drive", [&] { return luminav::run(argc, argv); });
}
