#include "drivers/camera/calibration/chessboard_calibration.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>

#include "drivers/camera/calibration/lens_file_text.hpp"
#include "drivers/camera/calibration/live_views.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/image/jpeg_codec.hpp"

namespace luminav {
namespace {

const std::filesystem::path kPictures = std::filesystem::path(LUMINAV_SOURCE_DIR) / "tests/data/camera_calibration";

GreyImage read_jpeg(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
  GreyImage image;
  JpegDecoder decoder;
  EXPECT_TRUE(decoder.decode({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, image)) << file;
  return image;
}

std::vector<BoardView> real_views() {
  std::vector<BoardView> views;
  for (int i = 1; i <= 14; ++i) {
    const std::string name = fmt::format("left{:02d}.jpg", i);
    if (std::filesystem::exists(kPictures / name)) {
      const auto view = find_chessboard(read_jpeg(kPictures / name).view(), {});
      EXPECT_TRUE(view) << name;
      views.push_back(view.value_or(BoardView{}));
    }
  }
  return views;
}

/// A board held before a known lens in many directions; corners seen with Gaussian noise.
std::vector<BoardView> seen_through(const CameraIntrinsics& lens, const Chessboard& board, double noise_px) {
  const CeilingCamera camera(lens, {});
  std::mt19937 rng(5);
  std::normal_distribution<double> noise(0.0, noise_px);
  std::uniform_real_distribution<double> turn(-0.5, 0.5);
  std::uniform_real_distribution<double> shift(-0.04, 0.04);
  std::vector<BoardView> views;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Matrix3d rotation = (Eigen::AngleAxisd(turn(rng), Eigen::Vector3d::UnitX()) *
                                      Eigen::AngleAxisd(turn(rng), Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(turn(rng), Eigen::Vector3d::UnitZ()))
                                         .toRotationMatrix();
    const Eigen::Vector3d place(-0.1 + shift(rng), -0.06 + shift(rng), 0.35);
    BoardView& view = views.emplace_back();
    for (int row = 0; row < board.rows; ++row) {
      for (int column = 0; column < board.columns; ++column) {
        const Eigen::Vector3d corner =
            rotation * Eigen::Vector3d(column * board.square, row * board.square, 0.0) + place;
        view.push_back(camera.pixel_of(corner).value() + Eigen::Vector2d(noise(rng), noise(rng)));
      }
    }
  }
  return views;
}

TEST(ChessboardCalibration, FindsTheRealBoardsAndTheirKnownLens) {
  const LensCalibration found = calibrate_lens(real_views(), {}, LensModel::kPinhole, 640, 480);
  ASSERT_EQ(found.view_rms_px.size(), 13U);
  EXPECT_NEAR(found.rms_px, 0.409, 0.01);
  EXPECT_NEAR(found.intrinsics.fx, 536.07, 2.0);
  EXPECT_NEAR(found.intrinsics.fy, 536.02, 2.0);
  EXPECT_NEAR(found.intrinsics.cx, 342.37, 2.0);
  EXPECT_NEAR(found.intrinsics.cy, 235.54, 2.0);
  EXPECT_NEAR(found.intrinsics.distortion[0], -0.265, 0.02);
  EXPECT_NEAR(found.intrinsics.distortion[1], -0.047, 0.02);
}

TEST(ChessboardCalibration, RecoversAPinholeAndAFisheyeWithinTheirNoise) {
  const CameraIntrinsics pinhole{.fx = 560.0, .fy = 555.0, .cx = 325.0, .cy = 236.0, .distortion = {-0.1, 0.02}};
  const CameraIntrinsics fisheye{
      .model = LensModel::kFisheye, .fx = 300.0, .fy = 301.0, .cx = 316.0, .cy = 243.0, .distortion = {0.02, -0.01}};
  for (const CameraIntrinsics& truth : {pinhole, fisheye}) {
    const LensCalibration found = calibrate_lens(seen_through(truth, {}, 0.1), {}, truth.model, 640, 480);
    EXPECT_NEAR(found.intrinsics.fx, truth.fx, 1.5);
    EXPECT_NEAR(found.intrinsics.fy, truth.fy, 1.5);
    EXPECT_NEAR(found.intrinsics.cx, truth.cx, 1.5);
    EXPECT_NEAR(found.intrinsics.cy, truth.cy, 1.5);
    EXPECT_NEAR(found.intrinsics.distortion[0], truth.distortion[0], 0.03);
    EXPECT_NEAR(found.rms_px, 0.1 * std::sqrt(2.0), 0.01);  // in x and y
  }
}

TEST(ChessboardCalibration, FindsNoBoardWhereThereIsNone) {
  const GreyImage black{640, 480, std::vector<std::uint8_t>(640 * 480, 0)};
  const GreyImage white{640, 480, std::vector<std::uint8_t>(640 * 480, 255)};
  EXPECT_FALSE(find_chessboard(black.view(), {}));
  EXPECT_FALSE(find_chessboard(white.view(), {}));
}

TEST(ChessboardCalibration, RefusesViewsThatDetermineNoCamera) {
  const std::vector<BoardView> views = seen_through({}, {}, 0.0);
  EXPECT_THROW(calibrate_lens({views[0], views[1]}, {}, LensModel::kPinhole, 640, 480), std::runtime_error);
  for (const LensModel model : {LensModel::kPinhole, LensModel::kFisheye}) {
    EXPECT_THROW(calibrate_lens({views[0], views[0], views[0], views[0]}, {}, model, 640, 480), std::runtime_error);
  }
  const BoardView all_in_one(54, Eigen::Vector2d(100.0, 100.0));
  EXPECT_THROW(calibrate_lens({all_in_one, all_in_one, all_in_one, all_in_one}, {}, LensModel::kFisheye, 640, 480),
               std::runtime_error);
}

TEST(ChessboardCalibration, WritesTheLensIntoTheRobotsFileAndLeavesTheRest) {
  std::ifstream in(std::string(LUMINAV_SOURCE_DIR) + "/launch/robots/p3dx.toml");
  std::stringstream text;
  text << in.rdbuf();
  const RobotDescription before = read_robot(std::filesystem::path(LUMINAV_SOURCE_DIR) / "launch/robots/p3dx.toml");
  LensCalibration found;
  found.intrinsics = {.model = LensModel::kFisheye, .fx = 301.25, .fy = 302.5, .cx = 310.0, .cy = 230.0};
  found.intrinsics.distortion = {0.1, -0.2, 0.3, -0.4, 0.0};
  found.view_rms_px = {0.2, 0.3};
  found.focal_sigma_px = 0.5;
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "robot_with_lens.toml";
  std::ofstream(file) << with_lens(with_lens(text.str(), found), found);
  const RobotDescription after = read_robot(file);
  EXPECT_EQ(after.camera.intrinsics.model, LensModel::kFisheye);
  EXPECT_NEAR(after.camera.intrinsics.fx, 301.25, 1e-9);
  EXPECT_NEAR(after.camera.intrinsics.distortion[3], -0.4, 1e-9);
  EXPECT_EQ(after.camera.mounting.z, before.camera.mounting.z);
  EXPECT_EQ(after.camera.row_time, before.camera.row_time);
  EXPECT_EQ(after.sonar.robot_from_sonar.size(), before.sonar.robot_from_sonar.size());
}

TEST(ViewCollector, KeepsAViewOnceAndOnlyWhenTheBoardIsHeldStill) {
  const std::vector<BoardView> views = seen_through({}, {}, 0.0);
  ViewCollector collector(640);
  EXPECT_FALSE(collector.offer(views[0]));  // nobody knows yet whether it moves
  EXPECT_TRUE(collector.offer(views[0]));
  EXPECT_FALSE(collector.offer(views[0]));  // known
  BoardView elsewhere = views[0];
  for (Eigen::Vector2d& corner : elsewhere) {
    corner.x() += 80.0;
  }
  EXPECT_FALSE(collector.offer(elsewhere));
  EXPECT_TRUE(collector.offer(elsewhere));
  EXPECT_EQ(collector.views().size(), 2U);
}

}  // namespace
}  // namespace luminav
