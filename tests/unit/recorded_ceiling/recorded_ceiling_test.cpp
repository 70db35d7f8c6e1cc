// A real robot's drive under a real ceiling, through detector and localizer. The recording has no odometry: visual
// increments stand in for it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "services/common/geometry/angle.hpp"
#include "tests/unit/recorded_ceiling/recorded_run.hpp"
#include "tests/unit/recorded_ceiling/visual_odometry.hpp"

namespace luminav::testing {
namespace {

constexpr double kFoot = 0.3048;  // [m]
// The reference is the author's own tracker, which takes all that is white for lamps: without what lies beside them it
// would say up to 0.11 m else.
constexpr double kSharp = 0.3 * kFoot;          // [m]
constexpr double kSharpTurn = radians(3.0);     // [rad]
constexpr std::size_t kMinSharp = 120;          // images
constexpr double kFollowed = 0.15;              // [m]
constexpr double kFollowedTurn = radians(2.0);  // [rad]
constexpr std::size_t kGap = 4;                 // images without a fixture, while this robot may turn by 25 degrees

/// Index of the first image of a gap; their number if there is none.
std::size_t first_gap(const RecordedRun& run) {
  std::size_t empty = 0;
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    empty = run.frames[i].seen.sightings.empty() ? empty + 1 : 0;
    if (empty == kGap) {
      return i + 1 - kGap;
    }
  }
  return run.frames.size();
}

const RecordedRun& recorded_run() {
  static const RecordedRun run = read_recorded_run();
  return run;
}

/// What the localizer says after each image.
std::vector<LocalizerEstimate> follow(Localizer& localizer, const RecordedRun& run) {
  VisualOdometry odometry;
  std::vector<LocalizerEstimate> estimates;
  for (const RecordedRun::Frame& frame : run.frames) {
    localizer.add_odometry({frame.seen.utime, 1, odometry.step(frame.seen.sightings)});
    localizer.add_frame(frame.seen);
    estimates.push_back(localizer.estimate());
  }
  return estimates;
}

/// Visual increments are far worse than wheels; the outlines of what is above a threshold, far out in a fisheye, are
/// nothing that averages. Chosen on this recording.
LocalizerConfig config_of(const RecordedRun& run) {
  LocalizerConfig config = run.config;
  config.errors.odometry_position = 0.15;
  config.errors.odometry_heading = radians(8.0);
  config.errors.camera_time_offset = 0.002;
  config.errors.camera_tilt = radians(0.1);
  config.errors.camera_yaw = radians(0.1);
  config.errors.camera_scale = 0.002;
  config.errors.lens_residual = 0.002;
  config.errors.fixture_position = 0.002;
  config.errors.sighting_position = 0.2;
  config.errors.sighting_heading = radians(3.0);
  return config;
}

TEST(RecordedCeiling, FollowsTheRobotFromItsFirstPose) {
  const RecordedRun& run = recorded_run();
  const LocalizerConfig config = config_of(run);
  const auto localizer = make_localizer(config);
  localizer->add_odometry({run.frames.front().seen.utime - 10'000, 1, {}});
  localizer->recall({run.frames.front().world_from_robot, Eigen::Vector3d(0.01, 0.01, 0.001).asDiagonal()});
  const std::vector<LocalizerEstimate> estimates = follow(*localizer, run);
  const std::size_t end = first_gap(run);
  std::size_t sharp = 0;
  double farthest = 0.0;
  double max_turned = 0.0;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const Eigen::Vector3d offset =
        offset_modulo_grid(estimates[i].belief.pose, run.frames[i].world_from_robot, run.pitch);
    const double apart = offset.head<2>().norm();
    if (i < end) {
      sharp += apart < kSharp && std::abs(offset.z()) < kSharpTurn ? 1 : 0;
      farthest = std::max(farthest, apart);
      max_turned = std::max(max_turned, std::abs(offset.z()));
    } else if (estimates[i].state == LocalizerState::kTracking) {
      EXPECT_LT(apart, 0.5) << "sure of a wrong place in image " << i;
    }
  }
  std::printf(
      "images with fixtures before the first gap: %zu; within 0.3 ft and 3 degrees %zu; farthest %.2f m, %.1f "
      "degrees\n",
      end, sharp, farthest, degrees(max_turned));
  EXPECT_GE(end, 95U) << "images until the detector sees nothing for a while";
  EXPECT_GE(sharp, kMinSharp);
  EXPECT_LT(farthest, kFollowed);
  EXPECT_LT(max_turned, kFollowedTurn);
}

TEST(RecordedCeiling, FollowsTheRobotInModePaper) {
  const RecordedRun run = read_recorded_run(DetectorMode::kPaper);
  LocalizerConfig config = config_of(run);
  config.mode = LocalizerMode::kPaper;
  const auto localizer = make_localizer(config);
  localizer->add_odometry({run.frames.front().seen.utime - 10'000, 1, {}});
  localizer->recall({run.frames.front().world_from_robot, Eigen::Vector3d(0.01, 0.01, 0.001).asDiagonal()});
  const std::vector<LocalizerEstimate> estimates = follow(*localizer, run);
  std::size_t followed = 0;
  std::size_t sharp = 0;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const Eigen::Vector3d offset =
        offset_modulo_grid(estimates[i].belief.pose, run.frames[i].world_from_robot, run.pitch);
    const bool is_near = offset.head<2>().norm() < kFollowed && std::abs(offset.z()) < kSharpTurn;
    followed += is_near && estimates[i].state == LocalizerState::kTracking ? 1 : 0;
    sharp += offset.head<2>().norm() < kSharp && std::abs(offset.z()) < kSharpTurn ? 1 : 0;
  }
  std::printf("mode paper: %zu of %zu images followed within 0.15 m and 3 degrees, %zu within 0.3 ft\n", followed,
              estimates.size(), sharp);
  EXPECT_GE(followed, 100U);
}

TEST(RecordedCeiling, IsNotSureOfItsPlaceUnderAGridOfEqualFixtures) {
  const RecordedRun& run = recorded_run();
  const auto localizer = make_localizer(config_of(run));
  const std::vector<LocalizerEstimate> estimates = follow(*localizer, run);
  const auto tracking = std::count_if(estimates.begin(), estimates.end(),
                                      [](const LocalizerEstimate& e) { return e.state == LocalizerState::kTracking; });
  const auto ambiguous = std::count_if(estimates.begin(), estimates.end(), [](const LocalizerEstimate& e) {
    return e.state == LocalizerState::kAmbiguous;
  });
  std::printf("ambiguous in %ld of %zu images\n", static_cast<long>(ambiguous), estimates.size());
  EXPECT_EQ(tracking, 0);
  EXPECT_GE(ambiguous, static_cast<long>(estimates.size()) - 5);
}

}  // namespace
}  // namespace luminav::testing
