// The detector on pictures from files: scripts/detect.

#include <array>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <stdexcept>

#include "services/common/configuration/whole_file.hpp"
#include "services/common/image/picture_file.hpp"
#include "services/common/process/command_line.hpp"
#include "services/detector/detector.hpp"
#include "services/detector/detector_config.hpp"
#include "services/detector/tool/debug_picture.hpp"

namespace luminav {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// in the order of FixtureShape and of DetectionState
constexpr std::array kShapes{"rectangle", "square", "round"};
constexpr std::array kStates{"unknown", "lit", "unlit", "half"};

json to_json(const std::array<Eigen::Vector2d, 4>& corners) {
  json result = json::array();
  for (const Eigen::Vector2d& corner : corners) {
    result.push_back({corner.x(), corner.y()});
  }
  return result;
}

json to_json(const Detection& detection) {
  json covariance = json::array();
  for (int i = 0; i < 9; ++i) {
    covariance.push_back(detection.covariance(i / 3, i % 3));
  }
  const Pose2& pose = detection.robot_from_fixture;
  return {{"shape", kShapes[static_cast<std::size_t>(detection.shape)]},
          {"state", kStates[static_cast<std::size_t>(detection.state)]},
          {"corners_px", to_json(detection.corners_px)},
          {"centre_px", {detection.centre_px.x(), detection.centre_px.y()}},
          {"robot_from_fixture", {pose.x, pose.y, pose.theta}},
          {"has_theta", detection.has_theta},
          {"covariance", covariance},
          {"clipped", detection.clipped},
          {"near_end_visible", detection.near_end_visible},
          {"far_end_visible", detection.far_end_visible},
          {"length", detection.length},
          {"width", detection.width},
          {"fit", detection.fit}};
}

GreyImage read_picture(const std::string& file) {
  const cv::Mat picture = cv::imread(file, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
  if (picture.empty()) {
    throw std::runtime_error(file + ": cannot be read as a picture");
  }
  GreyImage image{picture.cols, picture.rows, {}};
  for (int row = 0; row < picture.rows; ++row) {
    image.pixels.insert(image.pixels.end(), picture.ptr(row), picture.ptr(row) + picture.cols);
  }
  return image;
}

struct Output {
  std::string json_file;     // "" or "-" = standard output
  std::string debug_folder;  // "" = none
  std::string sheet_file;    // "" = none
  bool is_timed = false;     // what is timed is never the same twice
};

json tried(const DetectorTrace& trace) {
  json result = json::array();
  for (std::size_t i = 0; i < trace.verdicts.size(); ++i) {
    result.push_back({{"corners_px", to_json(trace.rectangles[i])}, {"verdict", trace.verdicts[i]}});
  }
  return result;
}

/// The stem, or STEM-2, STEM-3, ... where pictures of several folders have the same one.
std::string free_name(const std::string& stem, std::set<std::string>& taken) {
  std::string name = stem;
  for (int number = 2; !taken.insert(name).second; ++number) {
    name = stem + "-" + std::to_string(number);
  }
  return name;
}

int detect_all(const DetectorConfig& config, const std::vector<std::string>& files, const Output& output) {
  Detector detector(config.params, config.camera, config.catalogue);
  if (!output.debug_folder.empty()) {
    fs::create_directories(output.debug_folder);
  }
  ContactSheet sheet;
  std::set<std::string> taken;
  json result = json::array();
  int failed = 0;
  for (const std::string& file : files) {
    json entry{{"image", file}, {"detections", json::array()}};
    try {
      const GreyImage image = read_picture(file);
      if (!detector.accepts(image.view())) {
        throw std::runtime_error(file + ": " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                                 " px, the camera is calibrated for " + std::to_string(config.camera.intrinsics.width) +
                                 " x " + std::to_string(config.camera.intrinsics.height));
      }
      const bool is_drawn = !output.debug_folder.empty() || !output.sheet_file.empty();
      DetectorTrace trace;
      const std::clock_t before = std::clock();
      const std::vector<Detection>& detections = detector.detect(image.view(), is_drawn ? &trace : nullptr);
      if (output.is_timed) {
        entry["cpu_ms"] = 1e3 * static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
      }
      for (const Detection& detection : detections) {
        entry["detections"].push_back(to_json(detection));
      }
      entry["width"] = image.width;
      entry["height"] = image.height;
      entry["median_grey"] = detector.median_grey();
      if (is_drawn) {
        const cv::Mat picture = draw_debug_picture(image.view(), trace, detections);
        // what was found, without the way there
        sheet.add(draw_debug_picture(image.view(), {}, detections), fs::path(file).stem().string());
        if (!output.debug_folder.empty()) {
          entry["tried"] = tried(trace);
          write_picture(fs::path(output.debug_folder) / (free_name(fs::path(file).stem().string(), taken) + ".png"),
                        picture);
        }
      }
    } catch (const std::exception& error) {
      std::fprintf(stderr, "detect: %s\n", error.what());
      entry["error"] = error.what();
      ++failed;
    }
    result.push_back(std::move(entry));
  }
  // File names are bytes; JSON is UTF-8.
  const std::string text = result.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
  if (!output.sheet_file.empty() && !sheet.empty()) {
    write_picture(output.sheet_file, sheet.draw(), {cv::IMWRITE_JPEG_QUALITY, 75});
  }
  write_whole_file(output.json_file.empty() ? "-" : output.json_file, text);
  return failed == 0 ? 0 : 1;
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  return luminav::run_guarded("detect", [&] {
    std::string robot_file;
    std::string building_file;
    std::string mode;
    luminav::Output output;
    std::vector<std::string> files;
    luminav::CommandLine command_line("detect", "Finds light fixtures in pictures of ceilings.");
    command_line.robot_file(robot_file).building_file(building_file);
    command_line.text("--mode", mode, "paper or modern instead of the robot file's")
        .output_file("--json", output.json_file, "where to write the detections (- or left out: standard output)")
        .text("--debug", output.debug_folder,
              "folder for pictures of what was tried (green) and found (blue): STEM.png, STEM-2.png, ...")
        .output_file("--png,--sheet", output.sheet_file, "one picture of them all")
        .flag("--time", output.is_timed, "say what CPU time each picture took (cpu_ms)")
        .positional("images", files, "PNG, JPEG, PGM, ...", true);
    if (const auto status = command_line.parse(argc, argv)) {
      return *status;
    }
    luminav::DetectorConfig config = luminav::read_detector_config(robot_file, building_file);
    if (mode == "paper" || mode == "modern") {
      config.params.mode = mode == "paper" ? luminav::DetectorMode::kPaper : luminav::DetectorMode::kModern;
    } else if (!mode.empty()) {
      throw luminav::ConfigurationError("--mode = " + mode + ": must be paper or modern");
    }
    return luminav::detect_all(config, files, output);
  });
}
