#include "services/localizer/calibration/drive_calibration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <limits>
#include <luminav/fixture_detections_t.hpp>
#include <luminav/odometry_t.hpp>
#include <sstream>
#include <stdexcept>

#include "services/common/process/channels.hpp"
#include "tests/unit/localizer/synthetic_world.hpp"

namespace luminav {
namespace {

const std::string kLaunch = std::string(LUMINAV_SOURCE_DIR) + "/launch";

LocalizerConfig laboratory() {
  return read_localizer_config(kLaunch + "/robots/p3dx.toml", kLaunch + "/buildings/laboratory/building.toml");
}

DriveLog drive(testing::SyntheticWorld& world, double seconds) {
  DriveLog log;
  for (int i = 0; i < static_cast<int>(30.0 * seconds); ++i) {
    const auto output = world.step();
    if (output.frame) {
      log.frames.push_back(*output.frame);
      log.frames.back().utime -=
          std::llround(1e6 * world.believed_robot().camera.time_offset);  // the image's own stamp
    }
    if (output.odometry) {
      log.odometry.push_back(*output.odometry);
    }
  }
  return log;
}

/// Errors of wheel scale, ratio and base, camera roll, pitch, yaw, height and time offset.
constexpr std::array kNames = {"wheel scale", "wheel ratio", "wheel base", "roll",
                               "pitch",       "yaw",         "height",     "time offset"};
constexpr double kShare = 0.25;  // that may be left of each
using Errors = std::array<double, kNames.size()>;

Errors errors_of(const RobotDescription& robot, const WheelCorrection& wheels, double ceiling,
                 const testing::SyntheticWorld& world) {
  const CameraMounting& believed = robot.camera.mounting;
  const CameraMounting& truth = world.true_robot().camera.mounting;
  const double height = world.true_ceiling_height() - truth.z;
  return {wheels.scale - world.true_wheel_scale(),
          wheels.ratio - world.true_wheel_ratio(),
          wheels.base - (world.true_wheel_base() / robot.wheel_base - 1.0),
          believed.roll - truth.roll,
          believed.pitch - truth.pitch,
          believed.yaw - truth.yaw,
          (ceiling - believed.z) / height - 1.0,
          robot.camera.time_offset - world.true_robot().camera.time_offset};
}

/// Position error, squared, that the wheels' constant errors make of 3 m straight on by odometry alone; the noise,
/// which no calibration takes away, left out.
double squared_error_after_three_metres(const WheelCorrection& wheels, const testing::SyntheticWorld& world) {
  constexpr double kDistance = 3.0;
  const double base = world.believed_robot().wheel_base;
  const WheelCorrection truth{world.true_wheel_scale(), world.true_wheel_ratio(), world.true_wheel_base() / base - 1.0};
  CorrectedOdometry believed(wheels, base);
  CorrectedOdometry real(truth, base);
  Pose2 by_belief = believed.correct({});
  Pose2 by_truth = real.correct({});
  for (int i = 1; i <= 300; ++i) {
    const Pose2 odometry{kDistance * i / 300.0, 0.0, 0.0};
    by_belief = believed.correct(odometry);
    by_truth = real.correct(odometry);
  }
  return std::pow(distance(by_belief, by_truth), 2);
}

/// As the README tells people to drive; the first seconds pass until the pose is known.
testing::SyntheticOptions options_of(std::uint64_t seed) {
  testing::SyntheticOptions options;
  options.seed = seed;
  options.spin_distance = 4.0;
  return options;
}

// Of ten robots alone, one unlucky drive decides.
TEST(DriveCalibration, ErrorsOfThirtyRobotsShrinkToAQuarterAfterThreeMinutes) {
  const LocalizerConfig config = laboratory();
  const double ceiling = config.building.ceiling_height;
  Errors before{};
  Errors after{};
  double blind_before = 0.0;
  double blind_after = 0.0;
  int robots = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    testing::SyntheticWorld world(config.building, config.walls, config.robot, options_of(seed));
    const DriveLog log = drive(world, 200.0);
    const DriveCalibration found = calibrate_drive(follow_drive(log, config, 0.10, radians(5.0)).frames, config);
    if (!found.fits()) {
      continue;  // a drive on which the pose never became known
    }
    ++robots;
    const WheelCorrection wheels{found.wheel_scale.value, found.wheel_ratio.value, found.wheel_base.value};
    blind_before += squared_error_after_three_metres({}, world);
    blind_after += squared_error_after_three_metres(wheels, world);
    const Errors old_errors = errors_of(config.robot, {}, ceiling, world);
    const Errors new_errors = errors_of(apply(found, config.robot, ceiling), wheels, ceiling, world);
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      before[i] += old_errors[i] * old_errors[i];
      after[i] += new_errors[i] * new_errors[i];
    }
  }
  EXPECT_GE(robots, 28);
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const double share = std::sqrt(after[i] / before[i]);
    RecordProperty(kNames[i], std::to_string(share));
    std::printf("%-12s %.5f -> %.5f: %.3f\n", kNames[i], std::sqrt(before[i] / robots), std::sqrt(after[i] / robots),
                share);
    EXPECT_LT(share, kShare) << kNames[i];
  }
  std::printf("after 3 m without a fixture: %.1f mm -> %.1f mm\n", 1e3 * std::sqrt(blind_before / robots),
              1e3 * std::sqrt(blind_after / robots));
  EXPECT_LT(blind_after, 0.25 * blind_before);
}

TEST(DriveCalibration, ADriveThroughAWrongPoseFitsNoRobot) {
  const LocalizerConfig config = laboratory();
  testing::SyntheticWorld world(config.building, config.walls, config.robot, options_of(2));
  const DriveLog log = drive(world, 200.0);
  std::vector<KnownFrame> frames = follow_drive(log, config, 0.10, radians(5.0)).frames;
  ASSERT_TRUE(calibrate_drive(frames, config).fits());
  for (std::size_t i = frames.size() / 2; i < frames.size(); ++i) {
    for (KnownSighting& sighting : frames[i].sightings) {
      sighting.fixture = (sighting.fixture + 1) % static_cast<int>(config.building.fixtures.size());
    }
  }
  EXPECT_FALSE(calibrate_drive(frames, config).fits());
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

TEST(DriveCalibration, ASecondOneKeepsWhatTheFirstFound) {
  const LocalizerConfig config = laboratory();
  const double ceiling = config.building.ceiling_height;
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "calibrated_twice.toml";
  Errors before{};
  Errors after{};
  constexpr std::uint64_t kRobots = 10;
  for (std::uint64_t seed = 1; seed <= kRobots; ++seed) {
    testing::SyntheticWorld world(config.building, config.walls, config.robot, options_of(seed));
    const Errors old_errors = errors_of(config.robot, {}, ceiling, world);
    LocalizerConfig calibrated = config;
    std::string text = text_of(kLaunch + "/robots/p3dx.toml");
    for (int round = 1; round <= 2; ++round) {
      const DriveLog log = drive(world, 200.0);
      const DriveCalibration found =
          calibrate_drive(follow_drive(log, calibrated, 0.10, radians(5.0)).frames, calibrated);
      ASSERT_TRUE(found.has_converged) << seed;
      text = write_into(text, found, calibrated);
      std::ofstream(file) << text;
      calibrated = read_localizer_config(file, kLaunch + "/buildings/laboratory/building.toml");
      world.believe(calibrated.robot);
    }
    const Errors new_errors = errors_of(calibrated.robot, calibrated.wheels, ceiling, world);
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      before[i] += old_errors[i] * old_errors[i];
      after[i] += new_errors[i] * new_errors[i];
    }
  }
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const double share = std::sqrt(after[i] / before[i]);
    std::printf("%-12s %.5f -> %.5f: %.3f\n", kNames[i], std::sqrt(before[i] / kRobots), std::sqrt(after[i] / kRobots),
                share);
    EXPECT_LT(share, kShare) << kNames[i];
  }
}

TEST(DriveLog, ReadsWhatTheLoggerWroteAndLeavesOutWhatCannotBe) {
  const std::string file = ::testing::TempDir() + "/drive.lcmlog";
  {
    lcm::LogFile log(file, "w");
    std::int64_t number = 0;
    const auto write = [&](const char* channel, const auto& message) {
      std::vector<char> bytes(static_cast<std::size_t>(message.getEncodedSize()));
      message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
      lcm::LogEvent event;
      event.eventnum = number++;
      event.timestamp = message.utime;
      event.channel = channel;
      event.data = bytes.data();
      event.datalen = static_cast<int>(bytes.size());
      log.writeEvent(&event);
    };
    odometry_t odometry{};
    for (const double x : {0.0, 0.1, std::numeric_limits<double>::quiet_NaN(), 0.2}) {
      odometry.utime += 100'000;
      odometry.session = 7;
      odometry.x = x;
      write(channels::kOdometry, odometry);
    }
    write(channels::kOdometry, odometry);  // the same stamp again
    fixture_detections_t seen{};
    seen.utime = 150'000;
    seen.count = 2;
    seen.detections.resize(2);
    for (fixture_detection_t& detection : seen.detections) {
      detection.length = 1.2;
      detection.width = 0.3;
      detection.covariance[0] = detection.covariance[4] = detection.covariance[8] = 1e-4;
    }
    seen.detections[1].x = 1e9;
    write(channels::kFixtureDetections, seen);
  }
  const DriveLog log = read_drive_log(file);
  std::vector<double> x;
  for (const OdometryReading& reading : log.odometry) {
    x.push_back(reading.odom_from_robot.x);
  }
  EXPECT_THAT(x, ::testing::ElementsAre(0.0, 0.1, 0.2));
  ASSERT_FALSE(log.odometry.empty());
  EXPECT_EQ(log.odometry.back().odom_from_robot.x, 0.2);
  EXPECT_EQ(log.odometry.back().session, 7);
  ASSERT_EQ(log.frames.size(), 1U);
  EXPECT_EQ(log.frames.front().sightings.size(), 1U);
  EXPECT_THROW(read_drive_log(file + ".none"), std::runtime_error);
}

TEST(DriveCalibration, FindsNothingInADriveTooShort) {
  const DriveCalibration found = calibrate_drive({}, laboratory());
  EXPECT_FALSE(found.has_converged);
  EXPECT_EQ(found.wheel_scale.value, 0.0);
}

TEST(DriveCalibration, WritesTheRobotsFileSoThatItReadsBack) {
  const LocalizerConfig config = laboratory();
  DriveCalibration found;
  found.yaw = {0.01, 0.001};
  found.tilt_x = {0.004, 0.0005};
  found.time_offset = {0.012, 0.002};
  found.wheel_scale = {0.007, 0.0003};
  const std::string text = text_of(kLaunch + "/robots/p3dx.toml");
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "calibrated_robot.toml";
  std::ofstream(file) << write_into(text, found, config);
  const LocalizerConfig read = read_localizer_config(file, kLaunch + "/buildings/laboratory/building.toml");
  EXPECT_NEAR(read.robot.camera.mounting.yaw, -0.01, 1e-6);
  EXPECT_NEAR(read.robot.camera.mounting.pitch, -0.004, 1e-6);
  EXPECT_NEAR(read.robot.camera.time_offset, 0.012, 1e-6);
  EXPECT_NEAR(read.wheels.scale, 0.007, 1e-6);
  EXPECT_NEAR(read.errors.wheel_scale, 0.0003, 1e-6);
  EXPECT_EQ(read.robot.footprint.size(), 4U);
  // written twice, it reads the same
  std::ofstream(file) << write_into(write_into(text, found, config), found, config);
  EXPECT_NO_THROW(read_localizer_config(file, kLaunch + "/buildings/laboratory/building.toml"));
}

TEST(WheelCorrection, UndoesWhatWrongWheelsMadeOfTheWay) {
  const WheelCorrection wheels{0.01, 0.02, -0.01};
  CorrectedOdometry odometry(wheels, 0.33);
  odometry.correct({});
  // 1 m straight by odometry: the right wheel is larger, so the robot went left
  Pose2 corrected;
  for (int i = 1; i <= 100; ++i) {
    corrected = odometry.correct({0.01 * i, 0.0, 0.0});
  }
  const double turn = 1.01 * 0.02 / (0.33 * 0.99);
  EXPECT_NEAR(corrected.theta, turn, 1e-9);
  EXPECT_NEAR(std::hypot(corrected.x, corrected.y), 1.01, 1e-3);
  EXPECT_NEAR(std::atan2(corrected.y, corrected.x), 0.5 * turn, 1e-4);
}

TEST(WheelCorrection, LeavesOdometryAsItIsWithoutACalibration) {
  CorrectedOdometry odometry({}, 0.33);
  const Pose2 pose{3.0, -2.0, 1.0};
  EXPECT_EQ(odometry.correct(pose).x, pose.x);
  EXPECT_EQ(odometry.correct(pose).theta, pose.theta);
}

}  // namespace
}  // namespace luminav
