#include "services/surveyor/drive/sonar_map.hpp"

#include <gtest/gtest.h>

#include "tests/unit/surveyor/survey/synthetic_drive.hpp"

namespace luminav {
namespace {

TEST(SurveyedPath, SharesOutWhatOdometryMissed) {
  const std::vector<OdometryReading> odometry = {{0, 1, {0.0, 0.0, 0.0}, 0.0, 0.0},
                                                 {500'000, 1, {0.5, 0.0, 0.0}, 1.0, 0.0},
                                                 {1'000'000, 1, {1.0, 0.0, 0.0}, 1.0, 0.0}};
  std::vector<KeyFrame> frames(2);
  frames[1].utime = 1'000'000;
  frames[1].odom_from_robot = {1.0, 0.0, 0.0};
  const std::vector<Pose2> poses = {{0.0, 0.0, 0.0}, {1.1, 0.2, 0.0}};
  const SurveyedPath path(odometry, frames, poses);
  ASSERT_EQ(path.stops().size(), 2u);
  EXPECT_NEAR(path.stops()[1].world_from_robot.x, 0.55, 1e-9);
  EXPECT_NEAR(path.stops()[1].world_from_robot.y, 0.1, 1e-9);
}

/// What the sonars that look sideways draw of 6 m along the x axis, `distance(x, is_left)` [m] beside it.
template <typename Distance>
PriorMap map_beside(const Distance& distance, const PriorMap* known = nullptr) {
  const SurveyModel model = synthetic_model();
  const SyntheticDrive synthetic = drive_along({{0.0, 0.0}, {6.0, 0.0}}, {}, model, {});
  const std::vector<KeyFrame> frames = choose_key_frames(synthetic.drive, model.robot.camera, 2.8);
  std::vector<Pose2> poses;
  for (const KeyFrame& frame : frames) {
    poses.push_back(frame.odom_from_robot);
  }
  std::vector<SonarEcho> echoes;
  for (const OdometryReading& reading : synthetic.drive.odometry) {
    for (int disc = 0; disc < 16; ++disc) {
      const Pose2& mounted = model.robot.sonar.robot_from_sonar[static_cast<std::size_t>(disc)];
      if (std::abs(std::sin(mounted.theta)) > 0.99) {
        const double x = reading.odom_from_robot.x + mounted.x;
        echoes.push_back({disc, distance(x, mounted.y > 0.0) - std::abs(mounted.y), true, reading.utime + 1000});
      }
    }
  }
  return draw_sonar_map(echoes, SurveyedPath(synthetic.drive.odometry, frames, poses), model.robot, {}, known);
}

int occupied_in(const PriorMap& map, double from_x, double to_x, double y) {
  int occupied = 0;
  for (double x = from_x; x < to_x; x += 0.1) {
    occupied += map.at({x, y}) == Prior::kOccupied ? 1 : 0;
  }
  return occupied;
}

TEST(SonarMap, IsLaidOverAnOlderMap) {
  PriorMap old;
  old.geometry = {0.05, {-3.02, -4.03}, 600, 160};
  old.cells.assign(old.geometry.size(), Prior::kFree);
  const auto wall = [&](double x0, double y0, double x1, double y1) {
    for (double x = x0; x < x1; x += 0.04) {
      for (double y = y0; y < y1; y += 0.04) {
        old.cells[old.geometry.index(old.geometry.cell_at({x, y}))] = Prior::kOccupied;
      }
    }
  };
  wall(3.0, -0.6, 3.1, 0.6);    // the robot drove through it
  wall(20.0, -2.0, 20.1, 2.0);  // where it never was
  wall(0.0, 1.0, 6.0, 1.1);     // the one to its left
  const PriorMap map = map_beside([](double, bool is_left) { return is_left ? 1.05 : 0.8; }, &old);
  EXPECT_EQ(map.at({3.05, 0.0}), Prior::kFree);
  EXPECT_EQ(map.at({20.05, 1.0}), Prior::kOccupied);
  EXPECT_EQ(map.at({15.0, 1.0}), Prior::kFree);
  EXPECT_GE(occupied_in(map, 1.0, 5.0, 1.05), 38);
  EXPECT_GE(std::max(occupied_in(map, 1.0, 5.0, -0.78), occupied_in(map, 1.0, 5.0, -0.88)), 20);  // new
  EXPECT_NEAR(std::remainder(map.geometry.origin.x() - old.geometry.origin.x(), 0.1), 0.0, 1e-9);
}

TEST(SonarMap, DrawsWallsBesideThePathAndTheFloorBetweenThem) {
  const PriorMap map = map_beside([](double, bool) { return 1.0; });
  int walls = 0;
  for (double x = 1.0; x < 5.0; x += 0.5) {
    EXPECT_EQ(map.at({x, 0.05}), Prior::kFree);
    for (const double y : {0.95, 1.05}) {
      walls += map.at({x, y}) == Prior::kOccupied ? 1 : 0;
    }
  }
  EXPECT_GE(walls, 6);
  EXPECT_EQ(map.at({3.0, 2.0}), Prior::kUnknown);
}

TEST(SonarMap, KeepsADoorOpenThatTheRobotDroveThrough) {
  const auto is_door = [](double x) { return x > 2.5 && x < 3.5; };
  const PriorMap door = map_beside([&](double x, bool) { return is_door(x) ? 0.33 : 1.0; });
  EXPECT_EQ(occupied_in(door, 2.0, 4.0, 0.35) + occupied_in(door, 2.0, 4.0, -0.35), 0);
  const PriorMap post = map_beside([&](double x, bool is_left) { return is_left && is_door(x) ? 0.33 : 1.0; });
  EXPECT_GE(occupied_in(post, 2.0, 4.0, 0.35), 5) << "something on one side is no passage";
}

TEST(SonarMap, RefusesADriveThatGoesNowhere) {
  const SurveyModel model = synthetic_model();
  EXPECT_THROW((void)draw_sonar_map({}, SurveyedPath({}, {}, {}), model.robot), std::runtime_error);
}

}  // namespace
}  // namespace luminav
