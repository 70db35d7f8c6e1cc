#include "tests/unit/detector/score/detector_score.hpp"

#include <fmt/format.h>
#include <time.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "drivers/camera/exposure_control.hpp"
#include "drivers/camera/simulated_renderer.hpp"
#include "drivers/simulator/random_stream.hpp"
#include "drivers/simulator/world_truth.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/image/jpeg_codec.hpp"
#include "services/detector/detector.hpp"

namespace luminav::score {
namespace {

using Eigen::Vector2d;
using simulated::Exposure;
using simulated::LampState;
using simulated::TruePose;

constexpr double kLeastShare = 0.3;
constexpr double kNear = 0.3;         // [m] across: farther ones are others
constexpr double kMostAcross = 0.03;  // [m] a detection farther off is wrong
constexpr double kMostAlong = 0.03;   // [m] or 3.5 sigma
constexpr double kMostHeading = radians(2.0);

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct VisibleFixture {
  ImagedFixture imaged;
  const Fixture* fixture = nullptr;
  LampState lamp = LampState::kOn;
  bool taken = false;
};

DetectionState expected_state(const VisibleFixture& truth) {
  switch (truth.lamp) {
    case LampState::kOff:
      return DetectionState::kUnlit;
    case LampState::kHalf:  // the only tube of a fixture, half burnt, is lit
      return truth.fixture->lamps < 2 ? DetectionState::kLit : DetectionState::kHalf;
    case LampState::kOn:
    case LampState::kFlicker:
      break;
  }
  return DetectionState::kLit;
}

double period_of(const Fixture& fixture) {
  return symmetry_period(fixture.shape);
}

/// Sums up how far a detection is from its fixture; false when too far to be called found.
bool compare(const Detection& detection, VisibleFixture& truth, DetectorScore& score, std::string& complaint) {
  const Pose2& imaged = truth.imaged.as_imaged;
  const Pose2 error = imaged.inverse() * detection.robot_from_fixture;
  const double heading = wrap_modulo(error.theta, period_of(*truth.fixture));
  const Vector2d along(std::cos(imaged.theta), std::sin(imaged.theta));
  const Vector2d across(-along.y(), along.x());
  const auto spread = [&](const Vector2d& direction) {
    return std::sqrt(direction.dot(detection.covariance.topLeftCorner<2, 2>() * direction));
  };
  const std::string figures = fmt::format(
      "off by {:.1f} mm along (sigma {:.1f}), {:.1f} across ({:.1f}), {:.3f} deg ({:.3f}), {:.2f} px; share {:.2f}, "
      "state {} lamp {}, width {:.3f} of {:.2f}, ends {} {}, at {:.0f} {:.0f}",
      1e3 * error.x, 1e3 * spread(along), 1e3 * error.y, 1e3 * spread(across), degrees(heading),
      degrees(std::sqrt(detection.covariance(2, 2))), (detection.centre_px - truth.imaged.centre_px).norm(),
      truth.imaged.share, static_cast<int>(detection.state), static_cast<int>(truth.lamp), detection.width,
      truth.fixture->width, detection.near_end_visible, detection.far_end_visible, detection.centre_px.x(),
      detection.centre_px.y());
  truth.taken = true;
  if (std::abs(error.y) > kMostAcross || std::abs(heading) > kMostHeading ||
      std::abs(error.x) > std::max(kMostAlong, 3.5 * spread(along))) {
    complaint = "wrong: " + figures;
    return false;
  }
  if (truth.lamp != LampState::kFlicker && detection.state != expected_state(truth)) {
    ++score.wrong_state;
    complaint = "state: " + figures;
  }
  score.seen += truth.imaged.share >= kLeastShare ? 1 : 0;
  if (truth.imaged.is_whole) {
    ++score.whole_seen;
    ++score.measured;
    const double px = (detection.centre_px - truth.imaged.centre_px).norm();
    score.centre_px2 += px * px;
    score.worst_px = std::max(score.worst_px, px);
    score.heading2 += heading * heading;
    const Pose2 in_robot = truth.imaged.robot_from_fixture.inverse() * detection.robot_from_fixture;
    score.position2 += in_robot.position().squaredNorm();
    score.robot_heading2 += std::pow(wrap_modulo(in_robot.theta, period_of(*truth.fixture)), 2);
  } else {
    ++score.cut_measured;
    score.across2 += error.y * error.y;
    score.cut_heading2 += heading * heading;
  }
  const Eigen::Vector3d difference(detection.robot_from_fixture.x - imaged.x, detection.robot_from_fixture.y - imaged.y,
                                   heading);
  const double normalised = difference.dot(detection.covariance.inverse() * difference) / 3.0;
  score.normalised += normalised;
  score.normalised_along += std::pow(error.x / spread(along), 2);
  score.normalised_across += std::pow(error.y / spread(across), 2);
  score.normalised_heading += heading * heading / detection.covariance(2, 2);
  ++score.normalised_count;
  if (normalised > 5.0 && complaint.empty()) {
    complaint = "far: " + figures;
  }
  return true;
}

bool match(const Detection& detection, std::vector<VisibleFixture>& visible, DetectorScore& score,
           std::string& complaint) {
  VisibleFixture* nearest = nullptr;
  double least = 1e9;
  for (VisibleFixture& truth : visible) {
    const Pose2 error = truth.imaged.as_imaged.inverse() * detection.robot_from_fixture;
    const double apart = error.position().norm();
    if (!truth.taken && std::abs(error.y) < kNear && std::abs(error.x) < 0.6 * truth.fixture->length + kNear &&
        apart < least) {
      nearest = &truth;
      least = apart;
    }
  }
  if (nearest == nullptr) {
    complaint = fmt::format(
        "wrong: nothing there; state {}, {:.2f} x {:.3f} m, clipped {}, ends {} {}, fit {:.2f}, at {:.0f} {:.0f}",
        static_cast<int>(detection.state), detection.length, detection.width, detection.clipped,
        detection.near_end_visible, detection.far_end_visible, detection.fit, detection.centre_px.x(),
        detection.centre_px.y());
    return false;
  }
  return compare(detection, *nearest, score, complaint);
}

/// Elements are compared by place alone.
void count_elements(const WorldTruth& world, const FrameMotion& motion, const CeilingCamera& camera,
                    const std::vector<Detection>& detections, DetectorScore& score) {
  std::vector<Vector2d> there;
  std::vector<bool> is_whole;
  for (const CeilingElement& element : world.building.elements) {
    const bool round = element.kind == ElementKind::kDetector || element.kind == ElementKind::kSpeaker;
    const Fixture shape{.id = 0,
                        .shape = round ? FixtureShape::kRound : FixtureShape::kRectangle,
                        .world_from_fixture = element.world_from_element,
                        .length = element.length,
                        .width = round ? element.length : element.width,
                        .height = world.building.ceiling_height,
                        .lamps = 0};
    if (const auto imaged = image_of(shape, motion, camera)) {
      there.push_back(imaged->as_imaged.position());
      is_whole.push_back(imaged->is_whole);
      score.elements_visible += imaged->is_whole ? 1 : 0;
    }
  }
  for (const Detection& detection : detections) {
    if (detection.shape != DetectionShape::kElement) {
      continue;
    }
    ++score.elements_reported;
    bool found = false;
    for (std::size_t i = 0; i < there.size() && !found; ++i) {
      if ((there[i] - detection.robot_from_fixture.position()).norm() < 0.05) {
        found = true;
        score.elements_seen += is_whole[i] ? 1 : 0;
        there[i] = Vector2d(1e9, 1e9);
      }
    }
    score.elements_wrong += found ? 0 : 1;
  }
}

std::vector<LampState> draw_lamps(const Condition& condition, std::size_t count, RandomStream& random) {
  std::vector<LampState> lamps(count, LampState::kOn);
  for (LampState& lamp : lamps) {
    const double draw = random.uniform();
    lamp = draw < condition.off                                        ? LampState::kOff
           : draw < condition.off + condition.half                     ? LampState::kHalf
           : draw < condition.off + condition.half + condition.flicker ? LampState::kFlicker
                                                                       : LampState::kOn;
  }
  return lamps;
}

/// Sets what the exposure control would settle at, then the condition's error of it.
void expose(simulated::CeilingRenderer& renderer, const Pose2& pose, double factor, Exposure& exposure) {
  const std::vector<TruePose> still{{pose, 0.0, 0.0}};
  const ExposureParams params;
  GreyImage image;
  double product = 8000.0;  // exposure x gain
  const auto set = [&] {
    exposure.exposure_us = std::min(product, params.exposure_most_us);
    exposure.gain = std::clamp(product / params.exposure_most_us, 1.0, params.gain_most);
  };
  const double most = params.exposure_most_us * params.gain_most;
  for (int i = 0; i < 6; ++i) {
    set();
    renderer.render(exposure, still, image);
    const double mean = measure_brightness(image.view(), params.lamp_grey).mean;
    if (mean > params.target_least && mean < params.target_most) {
      break;
    }
    product = std::clamp(product * std::clamp(100.0 / std::max(mean, 1.0), 0.2, 5.0), params.exposure_least_us, most);
  }
  product = std::clamp(product * factor, params.exposure_least_us, most);
  set();
}

struct Place {
  FrameMotion motion;
  double daylight = 0.5;
};

Place draw_place(const Condition& condition, const WorldTruth& world, RandomStream& random,
                 std::uint64_t& generator_state) {
  Place place;
  Pose2& pose = place.motion.world_from_robot;
  if (condition.at_window && !world.building.windows.empty()) {
    const Window& window = world.building.windows[random.below(world.building.windows.size())];
    pose = window.world_from_window * Pose2{random.uniform(0.6, 2.0), random.uniform(-1.0, 1.0), 0.0};
  } else {
    const Vector2d point = draw_free_point(world.walls, 0.3, generator_state);
    pose = {point.x(), point.y(), 0.0};
  }
  pose.theta = random.uniform(-kPi, kPi);
  if (condition.moving) {
    place.motion.velocity = {random.uniform(-0.35, 0.35), random.uniform(-0.35, 0.35)};
    place.motion.angular = random.uniform(-0.5, 0.5);
    place.motion.row_time = world.robot.camera.row_time;
  }
  place.daylight = random.uniform(condition.daylight_least, condition.daylight_most);
  return place;
}

void render(simulated::CeilingRenderer& renderer, const FrameMotion& motion, Exposure& exposure, GreyImage& image) {
  exposure.velocity = motion.velocity;
  exposure.angular = motion.angular;
  exposure.row_time_us = 1e6 * motion.row_time;
  std::vector<TruePose> rows;
  for (int row = 0; row < renderer.height(); ++row) {
    rows.push_back({motion.world_from_robot_at(row, renderer.height()), 0.0, 0.0});
  }
  renderer.render(exposure, rows, image);
}

/// Counts what one frame shows and what was reported; returns what is to be said against it.
std::vector<std::string> judge(const std::vector<Detection>& detections, std::vector<VisibleFixture>& visible,
                               DetectorScore& score) {
  std::vector<std::string> complaints;
  bool any_whole = false;
  bool any_cut = false;
  for (const VisibleFixture& fixture : visible) {
    score.visible += fixture.imaged.share >= kLeastShare ? 1 : 0;
    score.whole += fixture.imaged.is_whole ? 1 : 0;
    any_whole = any_whole || fixture.imaged.is_whole;
    any_cut = any_cut || (fixture.imaged.share >= kLeastShare && !fixture.imaged.is_whole);
  }
  bool used = false;
  for (const Detection& detection : detections) {
    if (detection.shape == DetectionShape::kElement) {
      continue;
    }
    ++score.reported;
    std::string complaint;
    const bool found = match(detection, visible, score, complaint);
    used = used || found;
    score.wrong += found ? 0 : 1;
    if (!complaint.empty()) {
      complaints.push_back(complaint);
    }
  }
  if (any_cut && !any_whole) {
    ++score.cut_only_frames;
    score.cut_used_frames += used ? 1 : 0;
  }
  for (const VisibleFixture& fixture : visible) {
    if (fixture.imaged.share >= kLeastShare && !fixture.taken) {
      complaints.push_back(fmt::format("missed: share {:.2f}, lamp {}, width {:.2f}, at {:.0f} {:.0f}",
                                       fixture.imaged.share, static_cast<int>(fixture.lamp), fixture.fixture->width,
                                       fixture.imaged.centre_px.x(), fixture.imaged.centre_px.y()));
    }
  }
  return complaints;
}

/// The building as the detector is told it, with true heights unless it is to work with those of the file.
CeilingCatalogue catalogue_for(const DetectorScoreOptions& options, const Building& believed, const WorldTruth& world) {
  Building building = believed;
  if (!options.believed_camera) {
    building.ceiling_height = world.building.ceiling_height;
    for (std::size_t i = 0; i < believed.fixtures.size(); ++i) {
      building.fixtures[i].height = world.building.fixtures[i].height;
    }
  }
  return catalogue_of(building);
}

void score_world(const DetectorScoreOptions& options, const Condition& condition, int world_index,
                 const FrameListener& listener, DetectorScore& score) {
  Scenario scenario = read_scenario(options.scenario);
  scenario.seed = options.first_seed + static_cast<std::uint64_t>(world_index);
  scenario.world.calibrated = true;
  const Building believed = read_building(scenario.building_file);
  const RobotDescription robot = read_robot(scenario.robot_file);
  const WorldTruth world = draw_world(scenario, believed, robot);
  RandomStream random(scenario.seed, "detector_score " + condition.name);
  const std::vector<LampState> lamps = draw_lamps(condition, world.building.fixtures.size(), random);
  simulated::CeilingRenderer renderer({.building = world.building,
                                       .intrinsics = world.robot.camera.intrinsics,
                                       .mounting = world.robot.camera.mounting,
                                       .grey_noise = world.grey_noise,
                                       .unlit_darker = world.unlit_darker,
                                       .seed = scenario.seed});
  const CeilingCamera camera(world.robot.camera.intrinsics, world.robot.camera.mounting);
  DetectorParams params;
  params.mode = options.mode;
  Detector detector(params, options.believed_camera ? robot.camera : world.robot.camera,
                    catalogue_for(options, believed, world));
  JpegEncoder encoder;
  JpegDecoder decoder;
  std::uint64_t generator_state = scenario.seed * 77 + 5;

  for (int frame = 0; frame < options.frames; ++frame) {
    const Place place = draw_place(condition, world, random, generator_state);
    renderer.set_world(place.daylight, lamps, {});
    Exposure exposure;
    exposure.number = static_cast<std::uint64_t>(frame);
    exposure.utime = 1e6 * frame + 1e6 * random.uniform();
    expose(renderer, place.motion.world_from_robot, condition.brightness, exposure);
    GreyImage image;
    render(renderer, place.motion, exposure, image);
    if (options.jpeg) {
      const auto bytes = encoder.encode(image.view(), 85);
      if (!decoder.decode(bytes, image)) {
        throw std::runtime_error("detector score: a JPEG of ours cannot be read");
      }
    }
    std::vector<VisibleFixture> visible;
    for (std::size_t i = 0; i < world.building.fixtures.size(); ++i) {
      const Fixture& fixture = world.building.fixtures[i];
      if (const auto imaged = image_of(fixture, place.motion, camera)) {
        visible.push_back({*imaged, &fixture, lamps[i], false});
      }
    }
    const double before = thread_seconds();
    DetectorTrace trace;
    std::vector<Detection> detections = detector.detect(image.view(), listener ? &trace : nullptr);
    score.seconds += thread_seconds() - before;
    ++score.frames;
    std::vector<std::string> complaints = judge(detections, visible, score);
    count_elements(world, place.motion, camera, detections, score);
    if (listener) {
      listener({fmt::format("{}_{}_{}", condition.name, scenario.seed, frame), &image, std::move(detections),
                std::move(complaints), std::move(trace)});
    }
  }
}

double ratio(double part, double whole) {
  return whole > 0.0 ? part / whole : 0.0;
}

}  // namespace

const std::vector<Condition>& lighting_matrix() {
  static const std::vector<Condition> matrix{
      {.name = "all on", .lamps_on = true},
      {.name = "all on, moving", .lamps_on = true, .moving = true},
      {.name = "all on at night", .lamps_on = true, .daylight_least = 0.0, .daylight_most = 0.0},
      {.name = "third off", .off = 0.33},
      {.name = "third off, moving", .off = 0.33, .moving = true},
      {.name = "all off by day", .daylight_least = 0.8, .daylight_most = 0.8, .off = 1.0},
      {.name = "off by day, moving", .daylight_least = 0.8, .daylight_most = 0.8, .off = 1.0, .moving = true},
      {.name = "half tubes", .half = 0.5},
      {.name = "flicker", .off = 0.2, .flicker = 0.3},
      {.name = "sunrise sweep", .daylight_least = 0.05, .daylight_most = 1.0, .off = 0.5},
      {.name = "window glare", .daylight_least = 1.0, .daylight_most = 1.0, .off = 0.3, .at_window = true},
      {.name = "dim", .daylight_least = 0.1, .daylight_most = 0.1, .off = 0.6, .brightness = 0.45},
      {.name = "bright", .off = 0.2, .brightness = 1.25},
  };
  return matrix;
}

void DetectorScore::add(const DetectorScore& o) {
  frames += o.frames;
  visible += o.visible;
  seen += o.seen;
  whole += o.whole;
  whole_seen += o.whole_seen;
  reported += o.reported;
  wrong += o.wrong;
  wrong_state += o.wrong_state;
  cut_only_frames += o.cut_only_frames;
  cut_used_frames += o.cut_used_frames;
  elements_visible += o.elements_visible;
  elements_seen += o.elements_seen;
  elements_reported += o.elements_reported;
  elements_wrong += o.elements_wrong;
  measured += o.measured;
  centre_px2 += o.centre_px2;
  worst_px = std::max(worst_px, o.worst_px);
  heading2 += o.heading2;
  position2 += o.position2;
  robot_heading2 += o.robot_heading2;
  cut_measured += o.cut_measured;
  across2 += o.across2;
  cut_heading2 += o.cut_heading2;
  normalised_count += o.normalised_count;
  normalised += o.normalised;
  normalised_along += o.normalised_along;
  normalised_across += o.normalised_across;
  normalised_heading += o.normalised_heading;
  seconds += o.seconds;
}

double DetectorScore::precision() const {
  return reported == 0 ? 1.0 : ratio(reported - wrong, reported);
}
double DetectorScore::recall() const {
  return ratio(seen, visible);
}
double DetectorScore::whole_recall() const {
  return ratio(whole_seen, whole);
}
double DetectorScore::cut_use() const {
  return ratio(cut_used_frames, cut_only_frames);
}
double DetectorScore::centre_rms_px() const {
  return std::sqrt(ratio(centre_px2, measured));
}
double DetectorScore::heading_rms_deg() const {
  return degrees(std::sqrt(ratio(heading2, measured)));
}
double DetectorScore::position_rms_mm() const {
  return 1e3 * std::sqrt(ratio(position2, measured));
}
double DetectorScore::robot_heading_rms_deg() const {
  return degrees(std::sqrt(ratio(robot_heading2, measured)));
}
double DetectorScore::cut_across_rms_mm() const {
  return 1e3 * std::sqrt(ratio(across2, cut_measured));
}
double DetectorScore::cut_heading_rms_deg() const {
  return degrees(std::sqrt(ratio(cut_heading2, cut_measured)));
}
double DetectorScore::consistency() const {
  return ratio(normalised, normalised_count);
}
double DetectorScore::milliseconds() const {
  return 1e3 * ratio(seconds, frames);
}

DetectorScore score_detector(const DetectorScoreOptions& options, const Condition& condition,
                             const FrameListener& listener) {
  DetectorScore score;
  for (int world = 0; world < options.worlds; ++world) {
    score_world(options, condition, world, listener, score);
  }
  return score;
}

std::string score_table_header() {
  return fmt::format(
      "{:<20} {:>6} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>6} {:>5} {:>5} "
      "{:>5} {:>6} {:>7} {:>7}",
      "condition", "frames", "precis", "recall", "whole", "cutuse", "px rms", "px max", "deg rms", "mm rms", "deg rob",
      "cut mm", "cut deg", "nees", "n_al", "n_ac", "n_th", "state", "element", "ms");
}

std::string score_table_row(const std::string& name, const DetectorScore& s) {
  return fmt::format(
      "{:<20} {:>6} {:>7.4f} {:>7.4f} {:>7.4f} {:>7.4f} {:>7.3f} {:>7.2f} {:>7.4f} {:>7.2f} {:>7.3f} "
      "{:>7.2f} {:>7.3f} {:>6.2f} {:>5.2f} {:>5.2f} {:>5.2f} {:>6} {:>7.3f} {:>7.3f}",
      name, s.frames, s.precision(), s.recall(), s.whole_recall(), s.cut_use(), s.centre_rms_px(), s.worst_px,
      s.heading_rms_deg(), s.position_rms_mm(), s.robot_heading_rms_deg(), s.cut_across_rms_mm(),
      s.cut_heading_rms_deg(), s.consistency(), ratio(s.normalised_along, s.normalised_count),
      ratio(s.normalised_across, s.normalised_count), ratio(s.normalised_heading, s.normalised_count), s.wrong_state,
      ratio(s.elements_seen, s.elements_visible), s.milliseconds());
}

}  // namespace luminav::score
