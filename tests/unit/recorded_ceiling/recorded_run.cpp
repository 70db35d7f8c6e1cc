#include "tests/unit/recorded_ceiling/recorded_run.hpp"

#include <cmath>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <stdexcept>
#include <string>

#include "services/common/geometry/angle.hpp"
#include "services/detector/detector.hpp"
#include "services/detector/detector_config.hpp"

namespace luminav::testing {
namespace {

namespace fs = std::filesystem;

constexpr double kFoot = 0.3048;                       // [m]
constexpr std::int64_t kFramePeriod = 1'000'000 / 30;  // [us] by the author's replay code
constexpr int kGridHalf = 8;                           // fixtures on either side of the place where the run begins

FixtureSighting to_sighting(const Detection& detection) {
  FixtureSighting sighting;
  sighting.robot_from_fixture = detection.robot_from_fixture;
  sighting.covariance = detection.covariance;
  sighting.state = SightingState::kLit;
  sighting.has_theta = detection.has_theta;
  sighting.length = detection.length;
  sighting.width = detection.width;
  sighting.clipped = detection.clipped;
  sighting.near_end_visible = detection.near_end_visible;
  sighting.far_end_visible = detection.far_end_visible;
  sighting.fit = detection.fit;
  return sighting;
}

/// Poses (u, v, theta): a ceiling point (X, Y) in the robot frame, in ceiling heights, is at (cos X + sin Y - u,
/// cos Y - sin X - v) of the grid.
std::vector<Pose2> read_reference(const fs::path& file, double height) {
  std::ifstream in(file);
  std::string line;
  std::vector<Pose2> poses;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    double frame = 0.0;
    double u = 0.0;
    double v = 0.0;
    double theta = 0.0;
    char comma = 0;
    fields >> frame >> comma >> u >> comma >> v >> comma >> theta;
    if (!fields) {
      throw std::runtime_error(file.string() + ": not a pose: " + line);
    }
    poses.push_back({-height * u, -height * v, wrap_angle(-theta)});
  }
  return poses;
}

GreyImage read_grey(const fs::path& file) {
  const cv::Mat picture = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  if (picture.empty()) {
    throw std::runtime_error(file.string() + ": cannot be read");
  }
  GreyImage image{picture.cols, picture.rows, {}};
  for (int row = 0; row < picture.rows; ++row) {
    image.pixels.insert(image.pixels.end(), picture.ptr(row), picture.ptr(row) + picture.cols);
  }
  return image;
}

Building hall(Building building, const Eigen::Vector2d& pitch) {
  const Fixture lamp = building.fixtures.front();
  building.fixtures.clear();
  for (int i = -kGridHalf; i <= kGridHalf; ++i) {
    for (int j = -kGridHalf; j <= kGridHalf; ++j) {
      Fixture fixture = lamp;
      fixture.id = static_cast<int>(building.fixtures.size()) + 1;
      fixture.world_from_fixture = {i * pitch.x(), j * pitch.y(), 0.5 * kPi};
      building.fixtures.push_back(fixture);
    }
  }
  return building;
}

}  // namespace

fs::path recording_folder() {
  return fs::path(LUMINAV_SOURCE_DIR) / "tests/data/ceiling_office_robot";
}

RecordedRun read_recorded_run(DetectorMode mode, const std::string& robot) {
  const fs::path folder = recording_folder();
  RecordedRun run;
  run.config = read_localizer_config(folder / robot, folder / "fisheye-building.toml");
  run.pitch = {10.0 * kFoot, 12.0 * kFoot};
  run.config.building = hall(run.config.building, run.pitch);
  DetectorConfig seeing = read_detector_config(folder / robot, folder / "fisheye-building.toml");
  seeing.params.mode = mode;
  Detector detector(seeing.params, seeing.camera, seeing.catalogue);
  const std::vector<Pose2> reference = read_reference(folder / "poses.csv", 8.25 * kFoot);
  for (std::size_t i = 0; i < reference.size(); ++i) {
    char name[32];
    std::snprintf(name, sizeof(name), "frame_%03zu.png", i);
    const GreyImage image = read_grey(folder / "frames" / name);
    RecordedRun::Frame frame;
    frame.world_from_robot = reference[i];
    frame.seen.utime = 1'000'000 + static_cast<std::int64_t>(i) * kFramePeriod;
    for (const Detection& detection : detector.detect(image.view())) {
      frame.seen.sightings.push_back(to_sighting(detection));
    }
    run.frames.push_back(std::move(frame));
  }
  return run;
}

Eigen::Vector3d offset_modulo_grid(const Pose2& pose, const Pose2& reference, const Eigen::Vector2d& pitch) {
  const auto modulo = [](double value, double period) { return value - period * std::round(value / period); };
  return {modulo(pose.x - reference.x, pitch.x()), modulo(pose.y - reference.y, pitch.y()),
          wrap_angle(pose.theta - reference.theta)};
}

}  // namespace luminav::testing
