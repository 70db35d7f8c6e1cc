// Scores the detector on rendered frames from random poses under many lights, against the truth of the simulated
// world. Not a test: `detector_score --help`.

#include <time.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "drivers/camera/exposure_control.hpp"
#include "drivers/camera/simulated_renderer.hpp"
#include "drivers/simulator/random_stream.hpp"
#include "drivers/simulator/world_truth.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/image/jpeg_codec.hpp"
#include "services/detector/detector.hpp"

namespace luminav {
namespace {

using simulated::Exposure;
using simulated::LampState;
using simulated::TruePose;

struct Condition {
  std::string name;
  double daylight = 0.5;
  double off = 0.0;  // share of the fixtures
  double half = 0.0;
  double flicker = 0.0;
  double brightness = 1.0;  // factor on the exposure that the control would choose
  bool at_window = false;
  bool moving = false;
};

const std::vector<Condition> kConditions{
    {.name = "all on"},
    {.name = "all on, moving", .moving = true},
    {.name = "third off", .off = 0.33},
    {.name = "third off, moving", .off = 0.33, .moving = true},
    {.name = "all off by day", .daylight = 0.8, .off = 1.0},
    {.name = "off by day, moving", .daylight = 0.8, .off = 1.0, .moving = true},
    {.name = "half tubes", .half = 0.5},
    {.name = "flicker", .off = 0.2, .flicker = 0.3},
    {.name = "dim", .daylight = 0.1, .off = 0.6, .brightness = 0.45},
    {.name = "bright", .off = 0.2, .brightness = 1.25},
    {.name = "sunrise, all off", .daylight = 0.25, .off = 1.0},
    {.name = "window glare", .daylight = 1.0, .off = 0.3, .at_window = true},
};

struct Tally {
  int frames = 0;
  int visible = 0;  // fixtures with at least 30 % in view
  int seen = 0;
  int whole = 0;  // of these, entirely in view
  int whole_seen = 0;
  int wrong = 0;  // detections of fixtures where there is none, or another pose than its covariance allows
  int reported = 0;
  int state_wrong = 0;
  int frames_only_cut = 0;  // frames with cut ones but no whole one in view
  int frames_cut_used = 0;
  double centre_px2 = 0.0;
  double heading2 = 0.0;
  double across2 = 0.0;
  int precise = 0;  // whole ones in centre_px2 ...
  int cut_precise = 0;
  double normalised = 0.0;
  double normalised_across = 0.0;
  double normalised_theta = 0.0;
  int normalised_count = 0;
  double seconds = 0.0;
  double worst_px = 0.0;
  void add(const Tally& o);
};

void Tally::add(const Tally& o) {
  frames += o.frames;
  visible += o.visible;
  seen += o.seen;
  whole += o.whole;
  whole_seen += o.whole_seen;
  wrong += o.wrong;
  reported += o.reported;
  state_wrong += o.state_wrong;
  frames_only_cut += o.frames_only_cut;
  frames_cut_used += o.frames_cut_used;
  centre_px2 += o.centre_px2;
  heading2 += o.heading2;
  across2 += o.across2;
  precise += o.precise;
  cut_precise += o.cut_precise;
  normalised += o.normalised;
  normalised_across += o.normalised_across;
  normalised_theta += o.normalised_theta;
  normalised_count += o.normalised_count;
  seconds += o.seconds;
  worst_px = std::max(worst_px, o.worst_px);
}

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct VisibleFixture {
  Pose2 robot_from_fixture;
  const Fixture* fixture;
  double share;  // of its area in the image
  Eigen::Vector2d centre_px;
  LampState lamp;
  bool taken = false;
};

std::vector<VisibleFixture> visible_fixtures(const WorldTruth& world, const CeilingCamera& camera,
                                             const Pose2& world_from_robot, const std::vector<LampState>& lamps) {
  std::vector<VisibleFixture> visible;
  for (std::size_t k = 0; k < world.building.fixtures.size(); ++k) {
    const Fixture& fixture = world.building.fixtures[k];
    const Pose2 pose = world_from_robot.inverse() * fixture.world_from_fixture;
    if (pose.position().norm() > 5.0) {
      continue;
    }
    int inside = 0;
    constexpr int kAlong = 24;
    constexpr int kAcross = 6;
    for (int i = 0; i < kAlong; ++i) {
      for (int j = 0; j < kAcross; ++j) {
        const Eigen::Vector2d place(fixture.length * ((i + 0.5) / kAlong - 0.5),
                                    fixture.width * ((j + 0.5) / kAcross - 0.5));
        const auto pixel = camera.pixel_of_ceiling_point(pose * place, fixture.height);
        inside += pixel && camera.is_in_image(*pixel) ? 1 : 0;
      }
    }
    if (inside > 0) {
      const auto centre = camera.pixel_of_ceiling_point(pose.position(), fixture.height);
      visible.push_back({pose, &fixture, static_cast<double>(inside) / (kAlong * kAcross),
                         centre.value_or(Eigen::Vector2d::Zero()), lamps[k]});
    }
  }
  return visible;
}

/// Matches one detection; false when it is no fixture that is there, or not where it is said to be.
/// `ahead` takes the true pose in the robot's frame at mid-frame to the instant of the detection's middle row, which
/// is the localizer's to know.
bool match(const Detection& detection, std::vector<VisibleFixture>& visible, const Pose2& later_from_robot,
           const CeilingCamera& camera, Tally& tally, std::string& why) {
  char text[200];
  for (VisibleFixture& truth : visible) {
    const Pose2 robot_from_fixture = later_from_robot * truth.robot_from_fixture;
    const Pose2 error = robot_from_fixture.inverse() * detection.robot_from_fixture;
    const double heading = wrap_axis(error.theta);
    if (std::abs(error.y) > 0.12 || std::abs(error.x) > 0.7 || truth.taken) {
      continue;
    }
    const double c = std::cos(robot_from_fixture.theta);
    const double s = std::sin(robot_from_fixture.theta);
    const Eigen::Vector2d along(c, s);
    const double sigma_along = std::sqrt(along.dot(detection.covariance.topLeftCorner<2, 2>() * along));
    if (std::abs(error.y) > 0.03 || std::abs(heading) > radians(2.0) ||
        std::abs(error.x) > std::max(0.03, 3.5 * sigma_along)) {
      std::snprintf(text, sizeof text, "off by %.3f %.3f m %.2f deg (sigma along %.3f)", error.x, error.y,
                    degrees(heading), sigma_along);
      why = text;
      truth.taken = true;
      return false;
    }
    truth.taken = true;
    const LampState lamp = truth.lamp;
    const bool lit = lamp == LampState::kOn;
    const DetectionState expected = lit                        ? DetectionState::kLit
                                    : lamp == LampState::kHalf ? DetectionState::kHalf
                                                               : DetectionState::kUnlit;
    if (lamp != LampState::kFlicker && detection.state != expected &&
        !(lamp == LampState::kHalf && truth.fixture->lamps < 2)) {
      ++tally.state_wrong;
    }
    if (truth.share >= 0.3) {
      ++tally.seen;
    }
    if (truth.share >= 0.999) {
      ++tally.whole_seen;
      const auto centre_px = camera.pixel_of_ceiling_point(robot_from_fixture.position(), truth.fixture->height);
      const double px = (detection.centre_px - centre_px.value_or(truth.centre_px)).norm();

      tally.centre_px2 += px * px;
      tally.worst_px = std::max(tally.worst_px, px);
      tally.heading2 += heading * heading;
      ++tally.precise;
    } else {
      tally.across2 += error.y * error.y;
      ++tally.cut_precise;
    }
    const Eigen::Vector3d difference(detection.robot_from_fixture.x - robot_from_fixture.x,
                                     detection.robot_from_fixture.y - robot_from_fixture.y, heading);
    tally.normalised += difference.dot(detection.covariance.inverse() * difference) / 3.0;
    const Eigen::Vector2d across(-s, c);
    tally.normalised_across += error.y * error.y / across.dot(detection.covariance.topLeftCorner<2, 2>() * across);
    tally.normalised_theta += heading * heading / detection.covariance(2, 2);
    ++tally.normalised_count;
    const double sigma_across = std::sqrt(across.dot(detection.covariance.topLeftCorner<2, 2>() * across));
    if (error.y * error.y > 16.0 * sigma_across * sigma_across ||
        heading * heading > 16.0 * detection.covariance(2, 2)) {
      std::snprintf(text, sizeof text,
                    "  far: %.1f %.1f mm (sigma across %.1f) %.2f deg state %d lamp %d share %.2f width %.3f of %.2f "
                    "ends %d %d px %.0f %.0f\n",
                    1e3 * error.x, 1e3 * error.y, 1e3 * sigma_across, degrees(heading),
                    static_cast<int>(detection.state), static_cast<int>(lamp), truth.share, detection.width,
                    truth.fixture->width, detection.near_end_visible, detection.far_end_visible,
                    detection.centre_px.x(), detection.centre_px.y());
      why = text;
    }
    return true;
  }
  why = "nothing there";
  return false;
}

struct Options {
  std::string scenario = LUMINAV_SOURCE_DIR "/launch/scenarios/laboratory.toml";
  DetectorMode mode = DetectorMode::kModern;
  std::uint64_t seed = 1;
  int worlds = 2;
  int frames = 40;
  bool jpeg = true;
  bool believed = false;
  std::string only;
  std::string dump;  // folder for pictures of failures
};

void write_pgm(const std::string& file, const GreyImage& image) {
  std::ofstream out(file, std::ios::binary);
  out << "P5\n" << image.width << " " << image.height << "\n255\n";
  out.write(reinterpret_cast<const char*>(image.pixels.data()), static_cast<std::streamsize>(image.pixels.size()));
}

void score(const Options& options, const Condition& condition, int world_index, Tally& tally) {
  Scenario scenario = read_scenario(options.scenario);
  scenario.seed = options.seed + static_cast<std::uint64_t>(world_index);
  scenario.world.calibrated = true;
  const Building believed = read_building(scenario.building_file);
  const RobotDescription robot = read_robot(scenario.robot_file);
  const WorldTruth world = draw_world(scenario, believed, robot);
  RandomStream random(scenario.seed, "detector_score " + condition.name);

  std::vector<LampState> lamps(world.building.fixtures.size(), LampState::kOn);
  for (LampState& lamp : lamps) {
    const double draw = random.uniform();
    lamp = draw < condition.off                                        ? LampState::kOff
           : draw < condition.off + condition.half                     ? LampState::kHalf
           : draw < condition.off + condition.half + condition.flicker ? LampState::kFlicker
                                                                       : LampState::kOn;
  }
  simulated::CeilingRenderer renderer({.building = world.building,
                                       .intrinsics = world.robot.camera.intrinsics,
                                       .mounting = world.robot.camera.mounting,
                                       .grey_noise = world.grey_noise,
                                       .unlit_darker = world.unlit_darker,
                                       .seed = scenario.seed});
  renderer.set_world(condition.daylight, lamps, {});
  const CeilingCamera camera(world.robot.camera.intrinsics, world.robot.camera.mounting);
  Building catalogue_of_truth = believed;
  catalogue_of_truth.ceiling_height = world.building.ceiling_height;
  for (std::size_t i = 0; i < believed.fixtures.size(); ++i) {
    catalogue_of_truth.fixtures[i].height = world.building.fixtures[i].height;
  }
  DetectorParams params;
  params.mode = options.mode;
  Detector detector(params, options.believed ? robot.camera : world.robot.camera,
                    catalogue_of(options.believed ? believed : catalogue_of_truth));
  JpegEncoder encoder;
  JpegDecoder decoder;
  std::uint64_t place_state = scenario.seed * 77 + 5;

  for (int frame = 0; frame < options.frames; ++frame) {
    Pose2 pose;
    if (condition.at_window && !world.building.windows.empty()) {
      const Window& window = world.building.windows[random.below(world.building.windows.size())];
      pose = window.world_from_window * Pose2{random.uniform(0.6, 2.0), random.uniform(-1.0, 1.0), 0.0};
    } else {
      const Eigen::Vector2d point = draw_free_point(world.walls, 0.3, place_state);
      pose = {point.x(), point.y(), 0.0};
    }
    pose.theta = random.uniform(-kPi, kPi);
    Exposure exposure;
    exposure.number = static_cast<std::uint64_t>(frame);
    exposure.utime = 1e6 * frame + 1e6 * random.uniform();
    GreyImage image;
    const std::vector<TruePose> still{{pose, 0.0, 0.0}};
    double product = 8000.0;
    for (int i = 0; i < 6; ++i) {  // what the exposure control would settle at
      exposure.exposure_us = std::min(product, 20000.0);
      exposure.gain = std::clamp(product / 20000.0, 1.0, 8.0);
      renderer.render(exposure, still, image);
      const double mean = measure_brightness(image.view(), 225.0).mean;
      if (mean > 80.0 && mean < 120.0) {
        break;
      }
      product = std::clamp(product * std::clamp(100.0 / std::max(mean, 1.0), 0.2, 5.0), 300.0, 160000.0);
    }
    product = std::clamp(product * condition.brightness, 300.0, 160000.0);
    exposure.exposure_us = std::min(product, 20000.0);
    exposure.gain = std::clamp(product / 20000.0, 1.0, 8.0);
    if (condition.moving) {
      exposure.velocity = {random.uniform(-0.35, 0.35), random.uniform(-0.35, 0.35)};
      exposure.angular = random.uniform(-0.5, 0.5);
      exposure.row_time_us = 1e6 * world.robot.camera.row_time;
      std::vector<TruePose> rows;
      for (int row = 0; row < renderer.height(); ++row) {
        const double dt = (row - 0.5 * (renderer.height() - 1)) * world.robot.camera.row_time;
        rows.push_back({{pose.x + dt * exposure.velocity.x(), pose.y + dt * exposure.velocity.y(),
                         wrap_angle(pose.theta + dt * exposure.angular)},
                        0.0,
                        0.0});
      }
      renderer.render(exposure, rows, image);
    } else {
      renderer.render(exposure, still, image);
    }
    if (options.jpeg) {
      const auto bytes = encoder.encode(image.view(), 85);
      const std::vector<std::uint8_t> copy(bytes.begin(), bytes.end());
      if (!decoder.decode(copy, image)) {
        std::puts("jpeg failed");
      }
    }
    std::vector<VisibleFixture> visible = visible_fixtures(world, camera, pose, lamps);
    const double before = thread_seconds();
    const std::vector<Detection> detections = detector.detect(image.view());
    tally.seconds += thread_seconds() - before;
    ++tally.frames;
    bool whole_in_view = false;
    bool cut_in_view = false;
    for (const VisibleFixture& fixture : visible) {
      tally.visible += fixture.share >= 0.3 ? 1 : 0;
      tally.whole += fixture.share >= 0.999 ? 1 : 0;
      whole_in_view = whole_in_view || fixture.share >= 0.999;
      cut_in_view = cut_in_view || (fixture.share >= 0.3 && fixture.share < 0.999);
    }
    bool used = false;
    std::string story;
    for (const Detection& detection : detections) {
      if (detection.shape == DetectionShape::kElement) {
        continue;
      }
      ++tally.reported;
      std::string why;
      Pose2 later_from_robot;
      if (condition.moving) {
        const double dt = (detection.centre_px.y() - 0.5 * (renderer.height() - 1)) * world.robot.camera.row_time;
        const Pose2 later{pose.x + dt * exposure.velocity.x(), pose.y + dt * exposure.velocity.y(),
                          wrap_angle(pose.theta + dt * exposure.angular)};
        later_from_robot = later.inverse() * pose;
      }
      if (match(detection, visible, later_from_robot, camera, tally, why)) {
        used = true;
        story += why;
      } else {
        ++tally.wrong;
        char text[300];
        std::snprintf(text, sizeof text,
                      "  wrong: %s; state %d, %.2f x %.3f m, clipped %d ends %d %d fit %.2f at px %.0f %.0f\n",
                      why.c_str(), static_cast<int>(detection.state), detection.length, detection.width,
                      detection.clipped, detection.near_end_visible, detection.far_end_visible, detection.fit,
                      detection.centre_px.x(), detection.centre_px.y());
        story += text;
      }
    }
    if (cut_in_view && !whole_in_view) {
      ++tally.frames_only_cut;
      tally.frames_cut_used += used ? 1 : 0;
    }
    for (const VisibleFixture& fixture : visible) {
      if (fixture.share >= 0.3 && !fixture.taken) {
        char text[200];
        std::snprintf(text, sizeof text, "  missed: share %.2f lamp %d width %.2f at px %.0f %.0f\n", fixture.share,
                      static_cast<int>(fixture.lamp), fixture.fixture->width, fixture.centre_px.x(),
                      fixture.centre_px.y());
        story += text;
      }
    }
    if (!options.dump.empty() && !story.empty()) {
      std::string name = condition.name;
      std::replace(name.begin(), name.end(), ' ', '_');
      name += "_" + std::to_string(world_index) + "_" + std::to_string(frame);
      write_pgm(options.dump + "/" + name + ".pgm", image);
      std::printf("%s gain %.1f\n%s", name.c_str(), exposure.gain, story.c_str());
    }
  }
}

void print(const std::string& name, const Tally& t) {
  const auto ratio = [](double a, double b) { return b > 0.0 ? a / b : 0.0; };
  std::printf("%-20s %6d %7.4f %7.4f %7.4f %7.3f %8.3f %8.3f %8.4f %8.2f %7.2f %6.2f %6.2f %5d %7.3f\n", name.c_str(),
              t.frames, ratio(t.reported - t.wrong, t.reported), ratio(t.seen, t.visible), ratio(t.whole_seen, t.whole),
              ratio(t.frames_cut_used, t.frames_only_cut), std::sqrt(ratio(t.centre_px2, t.precise)), t.worst_px,
              degrees(std::sqrt(ratio(t.heading2, t.precise))), 1e3 * std::sqrt(ratio(t.across2, t.cut_precise)),
              ratio(t.normalised, t.normalised_count), ratio(t.normalised_across, t.normalised_count),
              ratio(t.normalised_theta, t.normalised_count), t.state_wrong, 1e3 * ratio(t.seconds, t.frames));
}

int run(const Options& options) {
  std::printf("%-20s %6s %7s %7s %7s %7s %8s %8s %8s %8s %7s %6s %6s %5s %7s\n", "condition", "frames", "precis",
              "recall", "whole", "cutused", "px rms", "px max", "deg rms", "cut mm", "nees", "n_acr", "n_th", "state",
              "ms");
  Tally all;
  for (const Condition& condition : kConditions) {
    if (!options.only.empty() && condition.name != options.only) {
      continue;
    }
    Tally tally;
    for (int world = 0; world < options.worlds; ++world) {
      score(options, condition, world, tally);
    }
    print(condition.name, tally);
    all.add(tally);
  }
  print("all", all);
  return 0;
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  luminav::Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string key = argv[i];
    const std::string value = i + 1 < argc ? argv[i + 1] : "";
    if (key == "--raw") {
      options.jpeg = false;
      continue;
    }
    if (key == "--believed") {
      options.believed = true;
      continue;
    }
    ++i;
    if (key == "--scenario") {
      options.scenario = value;
    } else if (key == "--mode" && (value == "paper" || value == "modern")) {
      options.mode = value == "paper" ? luminav::DetectorMode::kPaper : luminav::DetectorMode::kModern;
    } else if (key == "--seed") {
      options.seed = std::strtoull(value.c_str(), nullptr, 10);
    } else if (key == "--worlds") {
      options.worlds = std::atoi(value.c_str());
    } else if (key == "--frames") {
      options.frames = std::atoi(value.c_str());
    } else if (key == "--only") {
      options.only = value;
    } else if (key == "--dump") {
      options.dump = value;
    } else {
      std::puts(
          "detector_score [--scenario F] [--mode paper|modern] [--seed N] [--worlds N] [--frames N] [--raw] "
          "[--believed] [--only CONDITION] [--dump DIR]");
      return key == "--help" ? 0 : 2;
    }
  }
  return luminav::run(options);
}
