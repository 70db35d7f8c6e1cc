#include "tests/unit/mapper/mapping_drive.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

const std::filesystem::path kLaunch = std::filesystem::path(LUMINAV_SOURCE_DIR) / "launch";

MappingDrive round_through_the_laboratory() {
  MappingDrive drive;
  drive.building_file = kLaunch / "buildings/laboratory/building.toml";
  drive.robot_file = kLaunch / "robots/p3dx.toml";
  drive.waypoints = {{8.5, 2.0},  {2.0, 7.5},  {3.0, 7.0},   {1.4, 16.4}, {11.0, 16.6}, {23.6, 16.6},
                     {23.6, 9.0}, {14.0, 9.0}, {14.0, 12.4}, {14.0, 9.0}, {4.4, 9.0},   {4.4, 12.0},
                     {4.4, 9.0},  {18.0, 9.0}, {15.6, 4.0},  {18.0, 1.2}, {21.0, 4.0}};
  return drive;
}

// What the method asks of a map drawn by sonar: half a cell on walls, nine of ten faces, hardly anything wrongly free.
TEST(MappingDrive, DrawsAMapWorthHavingWithoutKnowingTheBuilding) {
  MappingDrive drive = round_through_the_laboratory();
  drive.waypoints.insert(drive.waypoints.begin() + 1,
                         {2.0, 2.0});  // the south-west corner: the shortest way leaves it out
  const MapQuality quality = drive_and_map(drive);
  RecordProperty("wall_median_m", std::to_string(quality.wall_median));
  RecordProperty("recall", std::to_string(quality.recall));
  RecordProperty("free_precision", std::to_string(quality.free_precision));
  EXPECT_LE(quality.wall_median, 0.0501);
  EXPECT_GE(quality.recall, 0.90);
  EXPECT_GE(quality.free_precision, 0.99);
}

TEST(MappingDrive, DrawsNoPhantomsIntoAKnownBuildingAndSeesWhatIsNew) {
  MappingDrive drive = round_through_the_laboratory();
  drive.use_prior = true;
  drive.position_noise = 0.05;
  drive.heading_noise = radians(1.5);
  Obstacle box;
  box.length = 0.5;
  box.width = 0.4;
  box.world_from_obstacle = Pose2{12.5, 16.1, 0.3};
  drive.obstacles.push_back(box);
  box.world_from_obstacle = Pose2{9.5, 9.3, 1.0};
  drive.obstacles.push_back(box);
  int obstacle_cells = 0;
  constexpr int kDrives = 3;  // of one alone, where the robot passes decides: 8 to 16 cells of the boxes' faces
  for (int seed = 1; seed <= kDrives; ++seed) {
    drive.seed = static_cast<std::uint64_t>(seed);
    const MapQuality quality = drive_and_map(drive);
    EXPECT_LE(quality.phantom_cells, 5) << "seed " << seed;
    obstacle_cells += quality.obstacle_cells;
  }
  EXPECT_GE(obstacle_cells, 10 * kDrives);
}

}  // namespace
}  // namespace luminav
