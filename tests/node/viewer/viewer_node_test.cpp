#include "services/viewer/viewer_node.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include <luminav/tile_request_t.hpp>
#include <nlohmann/json.hpp>

#include "services/common/process/channels.hpp"
#include "services/common/tiles/tile_codec.hpp"

namespace luminav {
namespace {

using Json = nlohmann::json;

class ViewerNodeTest : public ::testing::Test {
 protected:
  ViewerNodeTest() : requests_(lcm_) { requests_.on(channels::kTileRequest, &ViewerNodeTest::on_tile_request, this); }
  void on_tile_request(const tile_request_t&) { ++tile_requests_; }

  template <typename Message>
  void send(const char* channel, Message message) {
    message.utime = std::max<std::int64_t>(message.utime, 1);  // without a stamp nothing is taken
    lcm_.publish(channel, &message);
    while (lcm_.handleTimeout(0) > 0) {
    }
  }

  // What the reader is told now: (event, data), oldest first.
  std::vector<std::pair<std::string, Json>> news() {
    std::vector<std::pair<std::string, Json>> events;
    board_.tick();
    for (const SnapshotBoard::Text& text : board_.read(cursor_, 1'000'000)) {
      const std::size_t line = text->find('\n');
      EXPECT_EQ(text->substr(0, 7), "event: ");
      EXPECT_EQ(text->substr(text->size() - 2), "\n\n");
      events.emplace_back(text->substr(7, line - 7), Json::parse(text->substr(line + 7)));
    }
    return events;
  }
  Json newest(const std::string& name) {
    Json data;
    for (const auto& [event, json] : news()) {
      if (event == name) {
        data = json;
      }
    }
    return data;
  }

  static grid_tile_t tile(int column, int revision, std::int64_t session = 1) {
    static OccupancyGrid grid({0.1, {0.0, 0.0}, 128, 64});
    grid_tile_t message = encode_tile(grid, column, 0);
    message.map_session = session;
    message.revision = revision;
    return message;
  }

  lcm::LCM lcm_{"memq://"};
  VirtualClock clock_;
  SnapshotBoard board_;
  PictureStore pictures_;
  RequestDesk desk_{lcm_, "viewer@desk"};
  Helm helm_{lcm_, {}};
  ViewerNode node_{lcm_, {}, clock_, board_, pictures_, desk_, helm_};
  Subscriber requests_;
  SnapshotBoard::Cursor cursor_;
  int tile_requests_ = 0;
};

TEST_F(ViewerNodeTest, ShowsTheNewestOfEachChannelAndItsAge) {
  pose_t pose{};
  pose.state = pose_t::STATE_AMBIGUOUS;
  pose.x = 3.0;
  send(channels::kPose, pose);
  clock_.advance(250'000);
  robot_status_t robot{};
  robot.battery_voltage = 12.5;
  send(channels::kRobotStatus, robot);
  node_.show();
  const Json state = newest("state");
  EXPECT_EQ(state["pose"]["state"], 1);
  EXPECT_DOUBLE_EQ(state["ages"]["POSE"], 0.25);
  EXPECT_DOUBLE_EQ(state["ages"]["ROBOT_STATUS"], 0.0);
  EXPECT_FALSE(state["ages"].contains("SONAR"));
  EXPECT_FALSE(state.contains("sonar"));
}

TEST_F(ViewerNodeTest, EveryChannelHasItsKey) {
  send(channels::kOdometry, odometry_t{});
  send(channels::kSonar, sonar_t{});
  send(channels::kControlStatus, control_status_t{});
  send(channels::kNavigationStatus, navigation_status_t{});
  send(channels::kSimTruth, sim_truth_t{});
  send(channels::kFixtureDetections, fixture_detections_t{});
  send(channels::kHypotheses, hypotheses_t{});
  send(channels::kPath, path_t{});
  node_.show();
  std::map<std::string, Json> events;
  for (const auto& [name, data] : news()) {
    events[name] = data;
  }
  for (const char* key : {"odometry", "sonar", "control", "navigation", "truth", "detections"}) {
    EXPECT_TRUE(events["state"].contains(key)) << key;
  }
  EXPECT_TRUE(events.contains("hypotheses"));
  EXPECT_TRUE(events.contains("path"));
}

TEST_F(ViewerNodeTest, DropsAPoseThatIsNotANumberAndBytesThatAreNone) {
  pose_t pose{};
  pose.x = std::nan("");
  send(channels::kPose, pose);
  const char bytes[] = "no message at all";
  lcm_.publish(channels::kSonar, bytes, sizeof(bytes));
  lcm_.handleTimeout(0);
  node_.show();
  EXPECT_FALSE(newest("state").contains("pose"));
  EXPECT_EQ(node_.health().dropped_inputs, 2);
}

TEST_F(ViewerNodeTest, PlacesDetectionsByThePoseAtTheTimeOfThePicture) {
  for (int i = 0; i <= 10; ++i) {
    pose_t pose{};
    pose.utime = 1'000'000 + i * 100'000;
    pose.x = 0.1 * i;
    send(channels::kPose, pose);
  }
  fixture_detections_t seen{};
  seen.utime = 1'250'000;
  seen.count = 1;
  seen.detections.resize(1);
  seen.detections[0].y = 2.0;
  send(channels::kFixtureDetections, seen);
  node_.show();
  const Json world = newest("state")["detections"]["detections"][0]["world"];
  EXPECT_NEAR(world[0].get<double>(), 0.25, 1e-4);
  EXPECT_NEAR(world[1].get<double>(), 2.0, 1e-4);
}

TEST_F(ViewerNodeTest, ShowsAPictureTogetherWithItsDetectionsTwiceASecond) {
  camera_image_t image{};
  image.width = image.height = 8;
  image.format = camera_image_t::FORMAT_MONO8;
  image.data.assign(64, 100);
  image.size = 64;
  image.health = "too \"dark\"";
  fixture_detections_t seen{};
  int pictures = 0;
  for (int i = 0; i < 30; ++i) {  // two seconds
    image.utime = seen.utime = 10'000'000 + i * 1'000'000LL / 15;
    image.sequence = i;
    send(channels::kCameraImage, image);
    send(channels::kFixtureDetections, seen);
    for (const auto& [event, data] : news()) {
      EXPECT_EQ(event, "picture");
      EXPECT_EQ(data["utime"], image.utime);
      EXPECT_EQ(data["seen"]["utime"], image.utime);
      EXPECT_EQ(data["health"], image.health);
      ++pictures;
    }
  }
  EXPECT_EQ(pictures, 4);
  ASSERT_TRUE(pictures_.newest());
  EXPECT_EQ(pictures_.newest()->substr(0, 2), "\xff\xd8");
  EXPECT_EQ(pictures_.find(24), pictures_.newest());
}

TEST_F(ViewerNodeTest, ShowsNoPictureForTheLampsOfACameraThatTakesThemInTurn) {
  camera_image_t image{};
  image.width = image.height = 8;
  image.format = camera_image_t::FORMAT_MONO8;
  image.data.assign(64, 100);
  image.size = 64;
  fixture_detections_t seen{};
  int pictures = 0;
  for (int i = 0; i < 60; ++i) {  // four seconds
    image.utime = seen.utime = 10'000'000 + i * 1'000'000LL / 15;
    image.exposure_us = i / 6 % 2 == 0 ? 8000.0 : 560.0;
    send(channels::kCameraImage, image);
    send(channels::kFixtureDetections, seen);
    for (const auto& [event, data] : news()) {
      EXPECT_EQ(data["exposure_us"], 8000.0);
      ++pictures;
    }
  }
  EXPECT_GE(pictures, 4);
}

TEST_F(ViewerNodeTest, ShowsPicturesWithoutADetectorToo) {
  camera_image_t image{};
  image.width = image.height = 8;
  image.data.assign(64, 100);
  image.size = 64;
  for (int i = 0; i < 30; ++i) {
    image.utime = 10'000'000 + i * 1'000'000LL / 15;
    send(channels::kCameraImage, image);
  }
  EXPECT_TRUE(newest("picture")["seen"].is_null());
  EXPECT_TRUE(pictures_.newest());
}

TEST_F(ViewerNodeTest, RefusesAPictureThatIsShorterThanItSays) {
  camera_image_t image{};
  image.width = image.height = 1000;
  image.data.assign(64, 100);
  image.size = 64;
  image.utime = 10'000'000;
  fixture_detections_t seen{};
  seen.utime = image.utime;
  send(channels::kCameraImage, image);
  send(channels::kFixtureDetections, seen);
  EXPECT_FALSE(pictures_.newest());
  EXPECT_EQ(node_.health().dropped_inputs, 1);
}

TEST_F(ViewerNodeTest, PassesATileOnOnlyWhenItChanged) {
  send(channels::kGridTile, tile(0, 1));
  EXPECT_EQ(newest("tile")["columns"], 128);
  send(channels::kGridTile, tile(0, 1));
  EXPECT_TRUE(news().empty());
  send(channels::kGridTile, tile(0, 2));
  EXPECT_EQ(newest("tile")["revision"], 2);
}

TEST_F(ViewerNodeTest, ANewMapForgetsTheOldTiles) {
  send(channels::kGridTile, tile(0, 1));
  send(channels::kGridTile, tile(1, 1));
  send(channels::kGridTile, tile(1, 1, 2));
  const auto events = news();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].second["session"], 2);
}

TEST_F(ViewerNodeTest, RefusesImpossibleTiles) {
  grid_tile_t outside = tile(0, 1);
  outside.tile_column = 2;
  send(channels::kGridTile, outside);
  grid_tile_t negative = tile(0, 1);
  negative.tile_row = -1;
  send(channels::kGridTile, negative);
  grid_tile_t huge = tile(0, 1);
  huge.columns = 1'000'000;
  send(channels::kGridTile, huge);
  EXPECT_TRUE(news().empty());
  EXPECT_EQ(node_.health().dropped_inputs, 3);
}

TEST_F(ViewerNodeTest, AsksForMissingTilesButNotForEver) {
  node_.show_processes();
  while (lcm_.handleTimeout(0) > 0) {
  }
  EXPECT_EQ(tile_requests_, 0);  // nobody has a map
  send(channels::kGridTile, tile(0, 1));
  for (int i = 0; i < 20; ++i) {
    node_.show_processes();
  }
  while (lcm_.handleTimeout(0) > 0) {
  }
  EXPECT_EQ(tile_requests_, 5);
  send(channels::kGridTile, tile(0, 1, 2));
  send(channels::kGridTile, tile(1, 1, 2));
  node_.show_processes();
  while (lcm_.handleTimeout(0) > 0) {
  }
  EXPECT_EQ(tile_requests_, 5);  // complete
}

TEST_F(ViewerNodeTest, ListsProcessesUntilTheyAreLongGone) {
  node_status_t status{};
  status.process = "mapper";
  status.host = "robot";
  send(channels::kNodeStatus, status);
  clock_.advance(5'000'000);
  node_.show_processes();
  Json nodes = newest("nodes");
  ASSERT_EQ(nodes["nodes"].size(), 1U);
  EXPECT_DOUBLE_EQ(nodes["nodes"][0]["age"], 5.0);
  EXPECT_EQ(nodes["nodes"][0]["status"]["process"], "mapper");
  EXPECT_DOUBLE_EQ(nodes["rates"]["NODE_STATUS"], 1.0);
  clock_.advance(60'000'000);
  node_.show_processes();
  EXPECT_TRUE(newest("nodes")["nodes"].empty());
}

TEST_F(ViewerNodeTest, SaysWhatBecameOfARequest) {
  const std::int64_t id = desk_.send(goal_t{}, clock_.utime());
  node_.show();
  Json request = newest("state")["requests"][0];
  EXPECT_EQ(request["kind"], "goal");
  EXPECT_EQ(request["fate"], "waiting");
  navigation_status_t echo{};
  echo.goal_id = id;
  send(channels::kNavigationStatus, echo);
  node_.show();
  EXPECT_EQ(newest("state")["requests"][0]["fate"], "answered");
}

}  // namespace
}  // namespace luminav
