#include "services/mapper/mapper_node.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <luminav/grid_tile_t.hpp>
#include <map>
#include <random>

#include "services/common/building/map_file.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/tiles/tile_codec.hpp"
#include "services/mapper/mapper_config.hpp"

namespace luminav {
namespace {

using ::testing::HasSubstr;

constexpr std::int64_t kStart = 1'000'000'000;  // [us]
constexpr std::int64_t kTick = 100'000;         // [us] ODOMETRY and SONAR come at 10 Hz

const std::filesystem::path kFiles = std::filesystem::path(LUMINAV_BINARY_DIR) / "node_mapper_files";

MapperConfig config_for_a_hall() {
  MapperConfig config;
  config.robot.sonar.robot_from_sonar = {{0.2, 0.0, 0.0}, {0.0, 0.1, 0.5 * kPi}};
  config.prior.geometry = {0.1, {0.0, 0.0}, 150, 100};
  config.prior.cells.assign(config.prior.geometry.size(), Prior::kFree);
  return config;
}

MapperConfig config_with_maps() {
  MapperConfig config = config_for_a_hall();
  config.state_folder = kFiles / "maps";
  std::filesystem::remove_all(config.state_folder);
  std::filesystem::create_directories(kFiles);
  return config;
}

/// The mapper, a receiver for its tiles, and a robot that reports what it is told to.
class MapperWorld {
 public:
  explicit MapperWorld(const MapperConfig& config = config_for_a_hall()) : node(lcm, config), inbox_(lcm) {
    inbox_.on(channels::kGridTile, &MapperWorld::on_tile, this);
    pose.state = pose_t::STATE_TRACKING;
    pose.x = 5.0;
    pose.y = 5.0;
    pose.session = 9;
    for (const int i : {0, 4, 8}) {
      pose.covariance[i] = 1e-4;
    }
  }

  void send_pose() {
    ++pose.sequence;
    pose.utime = utime;
    lcm.publish(channels::kPose, &pose);
    deliver();
  }
  void send_sonar(double front, double left, bool fresh = true) {
    sonar_t sonar{};
    sonar.utime = utime;
    sonar.session = 9;
    sonar.sequence = ++sonar_sequence_;
    sonar.count = 2;
    sonar.range = {static_cast<float>(front), static_cast<float>(left)};
    sonar.has_echo = {static_cast<std::int8_t>(front < 5.0), static_cast<std::int8_t>(left < 5.0)};
    sonar.fresh = {fresh, fresh};
    sonar.range_utime = {utime - sonar_age, utime - sonar_age - 10'000};
    send(sonar);
  }
  void send(const sonar_t& sonar) {
    lcm.publish(channels::kSonar, &sonar);
    deliver();
  }
  /// One tick: SONAR, then POSE, as they come from the base.
  void step(double front = 2.0, double left = 2.0) {
    utime += kTick;
    send_sonar(front, left);
    send_pose();
  }
  void run(int ticks, double front = 2.0, double left = 2.0) {
    for (int i = 0; i < ticks; ++i) {
      step(front, left);
    }
  }
  void command(std::int64_t id, std::int8_t action, const std::string& path = "") {
    map_command_t message{};
    message.utime = utime;
    message.id = id;
    message.action = action;
    message.path = path;
    lcm.publish(channels::kMapCommand, &message);
    deliver();
  }
  void deliver() {
    while (lcm.handleTimeout(0) > 0) {
    }
  }
  bool has_evidence() const {
    return std::any_of(node.grid().evidence.begin(), node.grid().evidence.end(), [](std::int8_t e) { return e != 0; });
  }
  int count_of(int column, int row) { return by_place[{column, row}]; }
  std::int8_t evidence(double x, double y) const {
    return node.grid().evidence[node.grid().geometry.index(node.grid().geometry.cell_at({x, y}))];
  }

  lcm::LCM lcm{"memq://"};
  MapperNode node;
  std::int64_t utime = kStart;
  std::int64_t sonar_age = 40'000;  // [us] between a reading and its message
  pose_t pose{};
  grid_tile_t last{};
  int tiles = 0;
  std::map<std::pair<int, int>, int> by_place;
  std::size_t largest = 0;  // [bytes] of a message

 private:
  void on_tile(const grid_tile_t& tile) {
    last = tile;
    ++tiles;
    ++by_place[{tile.tile_column, tile.tile_row}];
    largest = std::max(largest, static_cast<std::size_t>(tile.getEncodedSize()));
  }
  std::int32_t sonar_sequence_ = 0;
  Subscriber inbox_;
};

TEST(MapperNode, DrawsWhatTheSonarsSee) {
  MapperWorld world;
  world.run(10);
  EXPECT_GT(world.evidence(7.23, 5.05), 16);
  EXPECT_LT(world.evidence(6.05, 5.05), 0);
  EXPECT_GT(world.evidence(5.05, 7.13), 16);
}

TEST(MapperNode, PutsAReadingWhereTheRobotWasWhenItWasTaken) {
  MapperWorld world;
  world.sonar_age = 80'000;
  world.pose.linear = 1.0;
  for (int i = 0; i < 10; ++i) {
    world.pose.x += 0.1;  // 1 m/s towards a wall at x = 9
    const double at_reading = world.pose.x - 0.08;
    world.step(9.0 - at_reading - 0.2, 5.0);
  }
  double heaviest = 0.0;
  int best = 0;
  for (int column = 80; column < 100; ++column) {
    const double evidence = world.node.grid().evidence[world.node.grid().geometry.index({column, 50})];
    if (evidence > heaviest) {
      heaviest = evidence;
      best = column;
    }
  }
  EXPECT_EQ(best, 90);
}

TEST(MapperNode, DrawsNothingUnlessItKnowsWhereItIs) {
  for (const std::int8_t state : {pose_t::STATE_LOST, pose_t::STATE_AMBIGUOUS}) {
    MapperWorld world;
    world.pose.state = state;
    world.run(10);
    EXPECT_FALSE(world.has_evidence());
  }
}

TEST(MapperNode, DrawsNothingWhenThePoseIsUncertain) {
  MapperWorld position;
  position.pose.covariance[4] = 0.2 * 0.2;
  position.run(10);
  EXPECT_FALSE(position.has_evidence());
  MapperWorld heading;
  heading.pose.covariance[8] = 0.1 * 0.1;
  heading.run(10);
  EXPECT_FALSE(heading.has_evidence());
}

TEST(MapperNode, DrawsNothingWhileTurningFast) {
  MapperWorld world;
  world.pose.angular = 0.9;
  world.run(10);
  EXPECT_FALSE(world.has_evidence());
}

TEST(MapperNode, TakesEachReadingOnce) {
  MapperWorld world;
  world.run(3);
  const std::int64_t integrated = world.node.integrated();
  EXPECT_EQ(integrated, 4) << "those of the last message but one wait for a pose on both sides";
  for (int i = 0; i < 5; ++i) {
    world.utime += kTick;
    world.sonar_age += kTick;  // the same readings again
    world.send_sonar(2.0, 2.0);
    world.send_pose();
  }
  EXPECT_LE(world.node.integrated(), integrated + 2);
  const std::int64_t before = world.node.integrated();
  world.sonar_age = 40'000;
  world.utime += kTick;
  world.send_sonar(2.0, 2.0, false);
  world.send_pose();
  EXPECT_EQ(world.node.integrated(), before) << "not fresh";
}

TEST(MapperNode, DropsReadingsThatMakeNoSense) {
  MapperWorld world;
  world.run(2);
  sonar_t sonar{};
  sonar.utime = world.utime + 1;
  sonar.session = 9;
  sonar.count = 3;
  sonar.range = {1.0F, 1.0F, 1.0F};
  sonar.has_echo = {1, 1, 1};
  sonar.fresh = {1, 1, 1};
  sonar.range_utime = {1, 1, 1};
  world.send(sonar);
  EXPECT_EQ(world.node.health().dropped_inputs, 1);
  world.utime += kTick;
  world.send_sonar(-2.0, -1.0);
  EXPECT_EQ(world.node.health().dropped_inputs, 3);
  world.pose.x = std::numeric_limits<double>::infinity();
  world.send_pose();
  EXPECT_EQ(world.node.health().dropped_inputs, 4);
}

TEST(MapperNode, DropsAnOldPose) {
  MapperWorld world;
  world.run(2);
  world.utime -= kTick;
  world.send_pose();
  EXPECT_EQ(world.node.health().dropped_inputs, 1);
}

TEST(MapperNode, ForgetsReadingsOverANewSessionOfTheBase) {
  MapperWorld world;
  world.run(5);
  const std::int64_t before = world.node.integrated();
  world.pose.session = 10;  // the sonar's messages are of session 9 still
  world.run(5);
  EXPECT_LE(world.node.integrated(), before + 2);
}

TEST(MapperNode, SendsEveryTileWithinTenSecondsAndChangedOnesAtOnce) {
  MapperWorld world;
  world.run(100);
  EXPECT_EQ(world.by_place.size(), 6U);
  for (const auto& [place, count] : world.by_place) {
    EXPECT_GE(count, 1);
  }
  const int before = world.count_of(1, 0);
  world.step(3.0, 2.0);
  world.run(9, 3.0, 2.0);
  EXPECT_GE(world.count_of(1, 0) - before, 4);
  EXPECT_LE(world.count_of(1, 0) - before, 7);
}

TEST(MapperNode, SendsTilesOnRequest) {
  MapperWorld world;
  world.pose.state = pose_t::STATE_LOST;
  world.run(20);
  world.tiles = 0;
  tile_request_t request{};
  request.utime = request.id = world.utime;
  request.count = 0;
  world.lcm.publish(channels::kTileRequest, &request);
  world.deliver();
  world.step();
  EXPECT_GE(world.tiles, 6);
}

TEST(MapperNode, SendsTilesThatAReceiverCanPutTogether) {
  MapperWorld world;
  world.run(30);
  OccupancyGrid copy(world.node.grid().geometry);
  tile_request_t request{};
  request.utime = world.utime;
  world.lcm.publish(channels::kTileRequest, &request);
  world.pose.state = pose_t::STATE_LOST;
  for (int row = 0; row < copy.tile_rows(); ++row) {
    for (int column = 0; column < copy.tile_columns(); ++column) {
      EXPECT_TRUE(apply_tile(encode_tile(world.node.grid(), column, row), copy));
    }
  }
  EXPECT_EQ(copy.evidence, world.node.grid().evidence);
  EXPECT_LT(world.largest, 1500U) << "a tile of a plain map fits an Ethernet frame";
}

TEST(MapperNode, NeverSendsATileLargerThanADatagram) {
  MapperConfig config = config_for_a_hall();
  std::mt19937 rng(1);
  for (Prior& cell : config.prior.cells) {
    cell = static_cast<Prior>(rng() % 4);
  }
  MapperWorld world(config);
  world.run(100);
  EXPECT_LT(world.largest, 65'000U);
}

TEST(MapperNode, SavesAndLoadsAMap) {
  MapperWorld world(config_with_maps());
  world.run(20);
  const std::string file = (kFiles / "maps/of-today.yaml").string();
  world.command(4, map_command_t::ACTION_SAVE, "of-today");
  EXPECT_EQ(world.last.map_command_id, 4);
  EXPECT_EQ(world.last.map_command_result, "");
  const PriorMap saved = read_map(file);
  EXPECT_EQ(saved.at({7.23, 5.05}), Prior::kOccupied);
  EXPECT_EQ(saved.at({6.05, 5.05}), Prior::kFree);

  const std::int64_t session = world.last.map_session;
  world.command(5, map_command_t::ACTION_LOAD, "of-today");
  EXPECT_EQ(world.last.map_command_id, 5);
  EXPECT_EQ(world.last.map_command_result, "");
  EXPECT_NE(world.last.map_session, session);
  EXPECT_EQ(world.node.grid().prior[world.node.grid().geometry.index({72, 50})], Prior::kOccupied);
  EXPECT_FALSE(world.has_evidence());
}

TEST(MapperNode, SaysWhyAMapCannotBeSavedOrLoaded) {
  MapperWorld world(config_with_maps());
  world.run(2);
  world.command(1, map_command_t::ACTION_LOAD, "none");
  EXPECT_THAT(world.last.map_command_result, HasSubstr("none.yaml"));
  world.command(4, 9);
  EXPECT_THAT(world.last.map_command_result, HasSubstr("unknown action"));
  EXPECT_EQ(world.last.map_command_id, 4);

  std::filesystem::create_directories(kFiles / "maps");
  std::ofstream(kFiles / "maps/cut.pgm") << "P5\n150 100\n255\nabc";
  std::ofstream(kFiles / "maps/cut.yaml") << "image: cut.pgm\nresolution: 0.1\norigin: [0, 0, 0]\n";
  world.command(5, map_command_t::ACTION_LOAD, "cut");
  EXPECT_THAT(world.last.map_command_result, HasSubstr("cut off"));
  EXPECT_EQ(world.node.grid().geometry.columns, 150) << "the old map stays";
}

TEST(MapperNode, SavesNothingWithoutAStateFolder) {
  MapperWorld world;
  world.run(2);
  world.command(3, map_command_t::ACTION_SAVE);
  EXPECT_THAT(world.last.map_command_result, HasSubstr("state folder"));
}

TEST(MapperNode, TakesNamesOfMapsAndNoPaths) {
  MapperWorld world(config_with_maps());
  world.run(2);
  const std::string outside = (kFiles / "outside").string();
  std::filesystem::remove(outside + ".yaml");
  std::int64_t id = 0;
  for (const std::string& path : {outside, outside + ".yaml", std::string("../outside"), std::string("a.yaml"),
                                  std::string("a/b"), std::string(65, 'a')}) {
    for (const std::int8_t action : {map_command_t::ACTION_SAVE, map_command_t::ACTION_LOAD}) {
      world.command(++id, action, path);
      EXPECT_THAT(world.last.map_command_result, HasSubstr("named by letters")) << path;
    }
  }
  EXPECT_FALSE(std::filesystem::exists(outside + ".yaml"));
  EXPECT_FALSE(std::filesystem::exists(kFiles / "maps"));
}

TEST(MapperNode, LoadsNoMapOfAnotherBuilding) {
  MapperWorld world(config_with_maps());
  std::filesystem::create_directories(kFiles / "maps");
  std::ofstream(kFiles / "maps/small.pgm") << "P5\n10 10\n255\n" + std::string(100, '\xfe');
  std::int64_t id = 0;
  for (const char* place : {"resolution: 1.0\norigin: [100, 100, 0]\n", "resolution: 0.1\norigin: [0, 0, 0]\n"}) {
    std::ofstream(kFiles / "maps/small.yaml") << "image: small.pgm\n" << place;
    world.command(++id, map_command_t::ACTION_LOAD, "small");
    EXPECT_THAT(world.last.map_command_result, HasSubstr("less than half of the building")) << place;
  }
  std::ofstream(kFiles / "maps/small.yaml") << "image: small.pgm\nresolution: 10\norigin: [-2000, 0, 0]\n";
  std::ofstream(kFiles / "maps/small.pgm") << "P5\n300 1\n255\n" + std::string(300, '\xfe');
  world.command(++id, map_command_t::ACTION_LOAD, "small");
  EXPECT_THAT(world.last.map_command_result, HasSubstr("at most 4096 cells"));
  EXPECT_EQ(world.node.grid().geometry.columns, 150);
}

TEST(MapperNode, IgnoresACommandFromBeforeTheLastOne) {
  MapperWorld world;
  world.run(10);
  world.command(7, map_command_t::ACTION_CLEAR_EVIDENCE);
  world.run(10);
  world.command(6, map_command_t::ACTION_CLEAR_EVIDENCE);
  EXPECT_TRUE(world.has_evidence());
  EXPECT_EQ(world.last.map_command_id, 7);
}

TEST(MapperNode, CarriesOutARepeatedCommandOnce) {
  MapperWorld world;
  world.run(10);
  world.command(7, map_command_t::ACTION_CLEAR_EVIDENCE);
  EXPECT_FALSE(world.has_evidence());
  world.run(10);
  world.command(7, map_command_t::ACTION_CLEAR_EVIDENCE);
  EXPECT_TRUE(world.has_evidence());
}

TEST(MapperNode, KeepsEvidenceOverARestart) {
  std::filesystem::remove_all(kFiles / "state");
  MapperConfig config = config_for_a_hall();
  config.state_folder = kFiles / "state";
  config.keep_period = 1.0;
  MapperWorld first(config);
  first.run(30);
  ASSERT_GT(first.evidence(7.23, 5.05), 16);
  MapperWorld second(config);
  EXPECT_GT(second.evidence(7.23, 5.05), 16);
}

TEST(MapperNode, DrawsTheSameFromTheSame) {
  MapperWorld first;
  MapperWorld second;
  for (MapperWorld* world : {&first, &second}) {
    for (int i = 0; i < 50; ++i) {
      world->pose.x = 5.0 + 0.02 * i;
      world->step(2.0 + 0.3 * std::sin(i), 1.5);
    }
  }
  EXPECT_EQ(first.node.grid().evidence, second.node.grid().evidence);
  EXPECT_EQ(first.tiles, second.tiles);
}

TEST(MapperConfig, ReadsTheShippedRobotAndBuildings) {
  const std::filesystem::path launch = std::filesystem::path(LUMINAV_SOURCE_DIR) / "launch";
  for (const char* building : {"laboratory", "office"}) {
    const MapperConfig config =
        read_mapper_config(launch / "robots/p3dx.toml", launch / "buildings" / building / "building.toml");
    EXPECT_EQ(config.robot.sonar.robot_from_sonar.size(), 16U);
    EXPECT_NEAR(config.prior.geometry.resolution, 0.1, 1e-12);
    EXPECT_GT(std::count(config.prior.cells.begin(), config.prior.cells.end(), Prior::kFree), 20000);
  }
}

TEST(MapperConfig, MakesRoomForABuildingWithoutAMap) {
  const PriorMap map =
      unknown_map(std::filesystem::path(LUMINAV_SOURCE_DIR) / "launch/buildings/laboratory/building.toml", 0.1, 10.0);
  EXPECT_EQ(map.at({-5.0, -5.0}), Prior::kUnknown);
  EXPECT_TRUE(map.geometry.contains(map.geometry.cell_at({-5.0, -5.0})));
  EXPECT_TRUE(map.geometry.contains(map.geometry.cell_at({25.0, 18.0})));
}

}  // namespace
}  // namespace luminav
