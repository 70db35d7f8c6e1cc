#include "drivers/camera/simulated/renderer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

namespace luminav::simulated {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Fixture fixture_at(const Pose2& pose, FixtureShape shape = FixtureShape::kRectangle) {
  Fixture fixture;
  fixture.world_from_fixture = pose;
  fixture.shape = shape;
  fixture.height = 2.8;
  if (shape != FixtureShape::kRectangle) {
    fixture.length = fixture.width = 0.6;
  }
  return fixture;
}

/// A webcam 0.3 m above the floor below a ceiling at 2.8 m with one fixture at the origin.
CeilingModel model_with(const Fixture& fixture) {
  CeilingModel model;
  model.building.ceiling_height = 2.8;
  model.building.fixtures.push_back(fixture);
  model.intrinsics.distortion = {-0.1, 0.02, 0.001, -0.001, 0.0};
  model.mounting.z = 0.3;
  model.unlit_darker = {20.0};
  model.seed = 7;
  return model;
}

TruePose at(double x, double y, double theta) {
  return {{x, y, theta}, 0.0, 0.0};
}

GreyImage render(CeilingRenderer& renderer, const TruePose& pose, const Exposure& exposure = {}) {
  GreyImage image;
  renderer.render(exposure, std::span(&pose, 1), image);
  return image;
}

/// Centre of gravity of all pixels at or above a grey level.
Vector2d bright_centre(const GreyImage& image, int level) {
  Vector2d sum = Vector2d::Zero();
  double count = 0.0;
  for (int row = 0; row < image.height; ++row) {
    for (int column = 0; column < image.width; ++column) {
      if (image.pixels[static_cast<std::size_t>(row * image.width + column)] >= level) {
        sum += Vector2d(column, row);
        ++count;
      }
    }
  }
  return sum / count;
}

/// Where the true camera model sees the outline's inner area: the mean of the pixels that project into the shape, by
/// brute force over the pixels. `pose_of_row` gives the robot's pose for each row.
template <typename PoseOfRow>
Vector2d expected_centre(const CeilingModel& model, const Fixture& fixture, PoseOfRow pose_of_row) {
  const CeilingCamera camera(model.intrinsics, model.mounting);
  Vector2d sum = Vector2d::Zero();
  double count = 0.0;
  for (int row = 0; row < model.intrinsics.height; ++row) {
    const TruePose pose = pose_of_row(row);
    const Eigen::Matrix3d tilt =
        CameraMounting{0.0, 0.0, 0.0, pose.roll, pose.pitch, 0.0}.rotation() * CameraMounting{}.rotation().transpose();
    for (int column = 0; column < model.intrinsics.width; ++column) {
      const Vector3d ray = tilt * camera.rotation() * camera.ray_in_camera({column, row}).value();
      const Vector3d lens = tilt * Vector3d(model.mounting.x, model.mounting.y, model.mounting.z);
      const Vector2d in_robot = lens.head<2>() + (fixture.height - lens.z()) / ray.z() * ray.head<2>();
      const Vector2d in_fixture = fixture.world_from_fixture.inverse() * (pose.world_from_robot * in_robot);
      const bool inside = fixture.shape == FixtureShape::kRound ? in_fixture.norm() <= 0.5 * fixture.length
                                                                : std::abs(in_fixture.x()) <= 0.5 * fixture.length &&
                                                                      std::abs(in_fixture.y()) <= 0.5 * fixture.width;
      if (inside) {
        sum += Vector2d(column, row);
        ++count;
      }
    }
  }
  return sum / count;
}

constexpr double kCentreTolerance = 0.15;  // [px] noise, blooming over a slope of light and whole pixels here

TEST(CeilingRenderer, ShowsAFixtureWhereTheCameraModelSaysForAnyMounting) {
  for (const FixtureShape shape : {FixtureShape::kRectangle, FixtureShape::kSquare, FixtureShape::kRound}) {
    for (const double height : {2.8, 2.4}) {
      Fixture fixture = fixture_at({3.0, -2.0, 0.7}, shape);
      fixture.height = height;
      CeilingModel model = model_with(fixture);
      model.mounting.x = 0.1;
      model.mounting.y = -0.05;
      model.mounting.roll = 0.03;
      model.mounting.pitch = -0.02;
      model.mounting.yaw = 0.2;
      CeilingRenderer renderer(model);
      TruePose pose = at(2.8, -2.1, 2.5);
      pose.roll = 0.01;
      pose.pitch = -0.015;
      const Vector2d seen = bright_centre(render(renderer, pose), 235);
      const Vector2d expected = expected_centre(model, fixture, [&](int) { return pose; });
      EXPECT_NEAR(seen.x(), expected.x(), kCentreTolerance);
      EXPECT_NEAR(seen.y(), expected.y(), kCentreTolerance);
    }
  }
}

TEST(CeilingRenderer, FollowsAFisheyeLensToo) {
  const Fixture fixture = fixture_at({1.0, 0.5, 0.3});
  CeilingModel model = model_with(fixture);
  model.intrinsics.model = LensModel::kFisheye;
  model.intrinsics.fx = model.intrinsics.fy = 250.0;
  model.intrinsics.distortion = {0.01, -0.002, 0.0, 0.0, 0.0};
  CeilingRenderer renderer(model);
  const TruePose pose = at(0.0, 0.0, 0.0);
  const Vector2d seen = bright_centre(render(renderer, pose), 235);
  const Vector2d expected = expected_centre(model, fixture, [&](int) { return pose; });
  EXPECT_NEAR(seen.x(), expected.x(), 2.0 * kCentreTolerance);
  EXPECT_NEAR(seen.y(), expected.y(), 2.0 * kCentreTolerance);
}

TEST(CeilingRenderer, TheRollingShutterShearsWhatARobotSeesWhileItTurns) {
  const Fixture fixture = fixture_at({0.0, 0.3, 0.0});
  const CeilingModel model = model_with(fixture);
  CeilingRenderer renderer(model);
  const auto turning = [&](int row) { return at(0.0, 0.0, 1.0 * (row - 239.5) * 52e-6); };  // 1 rad/s
  std::vector<TruePose> rows;
  for (int row = 0; row < 480; ++row) {
    rows.push_back(turning(row));
  }
  Exposure exposure;
  exposure.row_time_us = 52.0;
  exposure.angular = 1.0;
  GreyImage image;
  renderer.render(exposure, rows, image);
  const Vector2d seen = bright_centre(image, 235);
  const Vector2d expected = expected_centre(model, fixture, turning);
  EXPECT_NEAR(seen.x(), expected.x(), kCentreTolerance);
  EXPECT_NEAR(seen.y(), expected.y(), kCentreTolerance);
}

/// Mean grey over a square of pixels.
double mean_around(const GreyImage& image, const Vector2d& centre, int half) {
  double sum = 0.0;
  for (int row = static_cast<int>(centre.y()) - half; row <= static_cast<int>(centre.y()) + half; ++row) {
    for (int column = static_cast<int>(centre.x()) - half; column <= static_cast<int>(centre.x()) + half; ++column) {
      sum += image.pixels[static_cast<std::size_t>(row * image.width + column)];
    }
  }
  return sum / ((2.0 * half + 1.0) * (2.0 * half + 1.0));
}

TEST(CeilingRenderer, AnUnlitFixtureIsAsMuchDarkerThanItsTileAsTheTruthSays) {
  for (const double darker : {10.0, 25.0, 40.0}) {
    CeilingModel model = model_with(fixture_at({0.0, 0.0, 0.0}, FixtureShape::kRound));
    model.unlit_darker = {darker};
    model.grey_noise = 0.0;
    CeilingRenderer renderer(model);
    renderer.set_world(0.5, {LampState::kOff}, {});
    Exposure exposure;
    const double grey = mean_around(render(renderer, at(1.1, 0.0, 0.0), exposure), {320, 240}, 40);
    exposure.exposure_us *= 100.0 / grey;  // tiles at level 100
    const double tile = mean_around(render(renderer, at(1.1, 0.0, 0.0), exposure), {320, 240}, 40);
    const double fixture = mean_around(render(renderer, at(0.0, 0.0, 0.0), exposure), {320, 240}, 30);
    EXPECT_NEAR(tile - fixture, darker, 4.0);  // tiles differ by 2 of 100
  }
}

TEST(CeilingRenderer, HalfLitIsBrightOnOneSideOnly) {
  CeilingModel model = model_with(fixture_at({0.0, 0.0, 0.0}));
  model.building.fixtures[0].lamps = 2;
  model.grey_noise = 0.0;
  CeilingRenderer renderer(model);
  renderer.set_world(0.3, {LampState::kHalf}, {});
  const GreyImage image = render(renderer, at(0.0, 0.0, 0.0));
  const double left = mean_around(image, {319 - 17, 240}, 4);  // image right is the robot's left
  const double right = mean_around(image, {319 + 17, 240}, 4);
  EXPECT_GT(std::max(left, right), 250.0);
  EXPECT_LT(std::min(left, right), 180.0);
}

TEST(CeilingRenderer, AFlickeringLampIsOnHalfOfTheTime) {
  CeilingModel model = model_with(fixture_at({0.0, 0.0, 0.0}));
  CeilingRenderer renderer(model);
  renderer.set_world(0.3, {LampState::kFlicker}, {});
  int on = 0;
  for (int i = 0; i < 100; ++i) {
    Exposure exposure;
    exposure.utime = i * 66'667.0;
    on += mean_around(render(renderer, at(0.0, 0.0, 0.0), exposure), {319, 240}, 5) > 200.0 ? 1 : 0;
  }
  EXPECT_GT(on, 30);
  EXPECT_LT(on, 70);
}

TEST(CeilingRenderer, BrightnessGoesWithExposureAndGainUntilItSaturates) {
  CeilingModel model = model_with(fixture_at({9.0, 9.0, 0.0}));
  model.grey_noise = 0.0;
  CeilingRenderer renderer(model);
  renderer.set_world(0.8, {LampState::kOff}, {});
  Exposure exposure;
  exposure.exposure_us = 4000.0;
  const double once = mean_around(render(renderer, at(0.0, 0.0, 0.0), exposure), {320, 240}, 60);
  exposure.exposure_us = 12000.0;
  const double thrice = mean_around(render(renderer, at(0.0, 0.0, 0.0), exposure), {320, 240}, 60);
  exposure.exposure_us = 4000.0;
  exposure.gain = 3.0;
  const double by_gain = mean_around(render(renderer, at(0.0, 0.0, 0.0), exposure), {320, 240}, 60);
  EXPECT_NEAR(thrice / once, 3.0, 0.1);
  EXPECT_NEAR(by_gain, thrice, 0.01);
  exposure.exposure_us = 1e7;
  EXPECT_EQ(mean_around(render(renderer, at(0.0, 0.0, 0.0), exposure), {320, 240}, 60), 255.0);
}

TEST(CeilingRenderer, CloserToAWindowTheCeilingIsBrighterInProportionToTheDay) {
  CeilingModel model = model_with(fixture_at({50.0, 50.0, 0.0}));
  model.building.windows.push_back({{0.0, 0.0, 0.0}, 1.8});  // looks along +x
  model.grey_noise = 0.0;
  CeilingRenderer renderer(model);
  const auto level = [&](double daylight, double x) {
    renderer.set_world(daylight, {LampState::kOff}, {});
    return mean_around(render(renderer, at(x, 0.0, 0.0)), {320, 240}, 20);
  };
  EXPECT_GT(level(0.5, 1.0), 1.3 * level(0.5, 2.0));
  EXPECT_GT(level(0.5, 2.0), 1.3 * level(0.5, 4.0));
  EXPECT_NEAR(level(0.5, 3.0) / level(0.25, 3.0), 2.0, 0.15);
}

TEST(CeilingRenderer, NoiseHasTheDeviationOfTheTruth) {
  CeilingModel model = model_with(fixture_at({9.0, 9.0, 0.0}));
  CeilingRenderer renderer(model);
  renderer.set_world(0.8, {LampState::kOff}, {});
  Exposure first;
  first.exposure_us = 12000.0;
  Exposure second = first;
  second.number = 1;
  const GreyImage a = render(renderer, at(0.0, 0.0, 0.0), first);
  const GreyImage b = render(renderer, at(0.0, 0.0, 0.0), second);
  double squares = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    squares += std::pow(double{1} * a.pixels[i] - b.pixels[i], 2);
  }
  // Two frames' noise and two roundings (1/12 each).
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(a.pixels.size())), std::sqrt(2.0 * (16.0 + 1.0 / 12.0)), 0.1);
}

TEST(CeilingRenderer, SameSeedSameBytesOtherSeedOtherBytes) {
  CeilingModel model = model_with(fixture_at({0.0, 0.0, 0.3}));
  CeilingRenderer one(model);
  CeilingRenderer two(model);
  model.seed = 8;
  CeilingRenderer other(model);
  const TruePose pose = at(0.2, 0.1, 0.5);
  EXPECT_EQ(render(one, pose).pixels, render(two, pose).pixels);
  EXPECT_NE(render(one, pose).pixels, render(other, pose).pixels);
}

TEST(CeilingRenderer, MotionBlurSoftensEdgesAcrossItAndNotAlongIt) {
  CeilingModel model = model_with(fixture_at({0.0, 0.0, 0.0}, FixtureShape::kSquare));
  model.grey_noise = 0.0;
  CeilingRenderer renderer(model);
  renderer.set_world(1.0, {LampState::kOff}, {});
  Exposure exposure;
  exposure.exposure_us = 20000.0;
  exposure.velocity = {1.0, 0.0};  // 20 mm, more than 4 px, along the image's columns
  const GreyImage still = render(renderer, at(0.0, 0.0, 0.0), {.exposure_us = 20000.0});
  const GreyImage moved = render(renderer, at(0.0, 0.0, 0.0), exposure);
  const auto steepest = [](const GreyImage& image, int step_row, int step_column) {
    double max = 0.0;
    for (int i = 150; i < 330; ++i) {
      double difference = 0.0;
      for (int j = -20; j <= 20; ++j) {
        const int row = step_row != 0 ? i : 240 + j;
        const int column = step_column != 0 ? i + 80 : 320 + j;
        difference += image.pixels[static_cast<std::size_t>((row + step_row) * image.width + column + step_column)] -
                      image.pixels[static_cast<std::size_t>(row * image.width + column)];
      }
      max = std::max(max, std::abs(difference) / 41.0);
    }
    return max;
  };
  EXPECT_LT(steepest(moved, 1, 0), 0.85 * steepest(still, 1, 0));
  EXPECT_NEAR(steepest(moved, 0, 1), steepest(still, 0, 1), 0.1 * steepest(still, 0, 1));
}

TEST(CeilingRenderer, AMovedLampIsSeenWhereItIsNow) {
  const Fixture fixture = fixture_at({0.0, 0.0, 0.0});
  const CeilingModel model = model_with(fixture);
  CeilingRenderer renderer(model);
  renderer.set_world(0.2, {LampState::kOn}, {{0, 0.3, -0.2, 0.5}});
  Fixture displaced = fixture;
  displaced.world_from_fixture = {0.3, -0.2, 0.5};
  const TruePose pose = at(0.2, 0.0, 0.0);
  const Vector2d seen = bright_centre(render(renderer, pose), 235);
  const Vector2d expected = expected_centre(model, displaced, [&](int) { return pose; });
  EXPECT_NEAR(seen.x(), expected.x(), kCentreTolerance);
  EXPECT_NEAR(seen.y(), expected.y(), kCentreTolerance);
}

TEST(CeilingRenderer, AnEmptyBuildingIsABareCeiling) {
  CeilingModel model;
  CeilingRenderer renderer(model);
  renderer.set_world(1.0, {}, {});
  const GreyImage image = render(renderer, at(-1000.0, 2000.0, 0.0), {.exposure_us = 30000.0});
  EXPECT_GT(mean_around(image, {320, 240}, 100), 20.0);
}

// What the simulated camera shows must not depend on what services believe.
TEST(SimulatedSources, IncludeNothingFromServicesButGeometryBuildingConfigurationAndImages) {
  const std::string include = "#include \"services/";
  int files = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(LUMINAV_SOURCE_DIR "/drivers/camera/simulated")) {
    if (!entry.is_regular_file()) {
      continue;
    }
    ++files;
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);) {
      if (!line.starts_with(include)) {
        continue;
      }
      const std::string rest = line.substr(include.size());
      const bool allowed = std::ranges::any_of(
          std::array{"common/geometry/", "common/building/", "common/configuration/", "common/image/"},
          [&](const char* folder) { return rest.starts_with(folder); });
      EXPECT_TRUE(allowed) << entry.path() << ": " << line;
    }
  }
  EXPECT_GE(files, 10);
}

}  // namespace
}  // namespace luminav::simulated
