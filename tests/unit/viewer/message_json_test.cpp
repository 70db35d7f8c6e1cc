#include "services/viewer/message_json.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace luminav {
namespace {

using Json = nlohmann::json;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(SurveyJson, HasTheMapInWordsAndNumbers) {
  survey_status_t message{};
  message.state = survey_status_t::STATE_FINISHED;
  message.folder = "/surveys/school";
  surveyed_fixture_t fixture{};
  fixture.x = 1.5;
  fixture.is_open = 1;
  message.fixtures.push_back(fixture);
  message.path_count = 2;
  message.path_x = {0.0F, 1.0F};
  message.path_y = {0.0F, 2.0F};
  message.place_count = 2;  // more than there are
  message.place_names = {"lift"};
  message.place_x = {3.0F};
  message.place_y = {4.0F};
  const auto json = nlohmann::json::parse(to_json(message));
  EXPECT_EQ(json["state"], "finished");
  EXPECT_TRUE(json["pose"].is_null());
  EXPECT_EQ(json["fixtures"][0]["pose"][0], 1.5);
  EXPECT_EQ(json["fixtures"][0]["shape"], "rectangle");
  EXPECT_EQ(json["fixtures"][0]["open"], true);
  EXPECT_EQ(json["path"][1][1], 2.0);
  EXPECT_EQ(json["places"].size(), 1U);
  message.has_pose = 1;
  message.state = 17;
  EXPECT_EQ(nlohmann::json::parse(to_json(message))["pose"].size(), 3U);
  EXPECT_EQ(nlohmann::json::parse(to_json(message))["state"], "");
}

TEST(Base64, FollowsRfc4648) {
  const auto encode = [](const std::string& text) {
    return to_base64(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  };
  EXPECT_EQ(encode(""), "");
  EXPECT_EQ(encode("f"), "Zg==");
  EXPECT_EQ(encode("fo"), "Zm8=");
  EXPECT_EQ(encode("foo"), "Zm9v");
  EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encode("\xff\xfe\xfd"), "//79");
}

TEST(PoseJson, RoundsAndKeepsTheReason) {
  pose_t pose{};
  pose.state = pose_t::STATE_TRACKING;
  pose.x = 1.23456789;
  pose.reason = "sees \"three\" fixtures";
  pose.covariance[0] = 0.0025;
  const Json json = Json::parse(to_json(pose));
  EXPECT_EQ(json["state"], 2);
  EXPECT_DOUBLE_EQ(json["x"], 1.2346);
  EXPECT_EQ(json["reason"], pose.reason);
  EXPECT_EQ(json["covariance"].size(), 9U);
  EXPECT_DOUBLE_EQ(json["covariance"][0], 0.0025);
  EXPECT_TRUE(json["nis"].is_null());
}

TEST(MessageJson, AlwaysParsesWhateverIsInTheMessage) {
  pose_t pose{};
  pose.x = kNan;
  pose.y = std::numeric_limits<double>::infinity();
  pose.reason = "\xff\xfe\n\x01";
  const Json json = Json::parse(to_json(pose));
  EXPECT_TRUE(json["x"].is_null());
  EXPECT_TRUE(json["y"].is_null());
  EXPECT_EQ(to_json(pose).find('\n'), std::string::npos);  // a line's end would end the event
}

TEST(SonarJson, HasNullWhereNothingEchoedAndAges) {
  sonar_t sonar{};
  sonar.utime = 2'000'000;
  sonar.count = 3;
  sonar.range = {1.5F, 5.0F, 2.0F};
  sonar.has_echo = {1, 0, 1};
  sonar.fresh = {1, 1, 0};
  sonar.range_utime = {1'900'000, 2'000'000, 0};
  const Json json = Json::parse(to_json(sonar));
  EXPECT_DOUBLE_EQ(json["ranges"][0], 1.5);
  EXPECT_TRUE(json["ranges"][1].is_null());
  EXPECT_TRUE(json["ranges"][2].is_null());  // never fired
  EXPECT_DOUBLE_EQ(json["ages"][0], 0.1);
}

TEST(SonarJson, TrustsTheShortestListNotTheCount) {
  sonar_t sonar{};
  sonar.count = 1000;
  sonar.range = {1.0F};
  EXPECT_TRUE(Json::parse(to_json(sonar))["ranges"].empty());
  sonar.count = -5;
  EXPECT_TRUE(Json::parse(to_json(sonar))["ranges"].empty());
}

TEST(DetectionsJson, PlacesWhatIsSeenInTheWorld) {
  fixture_detections_t message{};
  message.count = 1;
  fixture_detection_t seen{};
  seen.x = 1.0;
  seen.y = 0.5;
  seen.theta = 0.25;
  seen.state = fixture_detection_t::STATE_LIT;
  message.detections.push_back(seen);
  EXPECT_FALSE(Json::parse(to_json(message, std::nullopt))["detections"][0].contains("world"));
  // the robot looks along y: one ahead and half to the left is at x - 0.5, y + 1
  const Json json = Json::parse(to_json(message, Pose2{10.0, 20.0, 0.5 * kPi}));
  const Json world = json["detections"][0]["world"];
  EXPECT_NEAR(world[0].get<double>(), 9.5, 1e-4);
  EXPECT_NEAR(world[1].get<double>(), 21.0, 1e-4);
  EXPECT_NEAR(world[2].get<double>(), 0.5 * kPi + 0.25, 1e-4);
}

TEST(HypothesesJson, PacksParticlesInSixBytes) {
  hypotheses_t message{};
  message.count = 1;
  message.x = {4.0F};
  message.y = {5.0F};
  message.theta = {0.5F};
  message.weight = {1.0F};
  message.sigma = {0.25F};
  message.particle_count = 2;
  message.particle_x = {10.25F, 7.0F};
  message.particle_y = {-3.0F, -3.0F};
  message.particle_theta = {static_cast<float>(0.5 * kPi), static_cast<float>(-0.5 * kPi)};
  message.particle_weight = {0.2F, 0.1F};
  const Json json = Json::parse(to_json(message));
  EXPECT_EQ(json["hypotheses"].size(), 1U);
  EXPECT_EQ(json["particle_count"], 2);
  EXPECT_EQ(json["origin"], Json({10.0, -3.0}));
  // (25 cm, 0, 64, 255), (-300 cm, 0, -64, 128)
  const std::uint8_t expected[] = {25, 0, 0, 0, 64, 255, 0xd4, 0xfe, 0, 0, 192, 128};
  EXPECT_EQ(json["particles"], to_base64(expected, sizeof(expected)));
}

TEST(HypothesesJson, LeavesOutParticlesThatAreNotNumbers) {
  hypotheses_t message{};
  message.particle_count = 2;
  message.particle_x = {1.0F, static_cast<float>(kNan)};
  message.particle_y = {1.0F, 1.0F};
  message.particle_theta = {0.0F, 0.0F};
  message.particle_weight = {0.0F, 0.0F};
  EXPECT_EQ(Json::parse(to_json(message))["particle_count"], 1);
}

TEST(PathJson, HasAHeadingOnlyWhenOneIsAskedFor) {
  path_t path{};
  path.count = 2;
  path.x = {1.0F, 2.0F};
  path.y = {0.0F, 0.5F};
  Json json = Json::parse(to_json(path));
  EXPECT_EQ(json["points"].size(), 2U);
  EXPECT_FALSE(json.contains("theta"));
  path.has_theta = 1;
  EXPECT_TRUE(Json::parse(to_json(path)).contains("theta"));
}

TEST(StatusJson, SaysWhatTheMessagesSay) {
  robot_status_t robot{};
  robot.connected = 1;
  robot.stall_right = 1;
  robot.battery_voltage = 12.3;
  EXPECT_EQ(Json::parse(to_json(robot))["stall"], true);
  control_status_t control{};
  control.state = control_status_t::STATE_YIELDING;
  EXPECT_EQ(Json::parse(to_json(control))["state"], 5);
  EXPECT_FALSE(Json::parse(to_json(control)).contains("look_ahead"));
  navigation_status_t navigation{};
  navigation.has_target = 1;
  navigation.x = 3.0;
  EXPECT_EQ(Json::parse(to_json(navigation))["target"].size(), 2U);
  navigation.has_theta = 1;
  EXPECT_EQ(Json::parse(to_json(navigation))["target"].size(), 3U);
  node_status_t node{};
  node.process = "mapper";
  node.cpu_fraction = 0.125;
  EXPECT_DOUBLE_EQ(Json::parse(to_json(node))["cpu_fraction"], 0.125);
  odometry_t odometry{};
  odometry.session = 5;
  EXPECT_EQ(Json::parse(to_json(odometry))["session"], 5);
  sim_truth_t truth{};
  truth.people = 1;
  truth.person_x = {1.0F};
  truth.person_y = {2.0F};
  truth.lamp_state = {1, 0};
  EXPECT_EQ(Json::parse(to_json(truth))["people"].size(), 1U);
  EXPECT_EQ(Json::parse(to_json(truth))["lamps"], Json({1, 0}));
}

TEST(TileJson, PassesTheCellsThrough) {
  grid_tile_t tile{};
  tile.size = 3;
  tile.data = {'f', 'o', 'o'};
  EXPECT_EQ(Json::parse(to_json(tile))["data"], "Zm9v");
}

TEST(BuildingJson, HoldsBuildingAndRobot) {
  Building building;
  building.name = "hut";
  building.fixtures.push_back({});
  building.places.push_back({"door", {1.0, 2.0, 0.0}, false});
  building.places.push_back({"desk", {1.0, 2.0, 1.0}, true});
  building.zones.push_back({"stairs", ZoneKind::kKeepOut, {{1.0, 2.0}, {3.0, 2.0}, {3.0, 4.0}}, 0.2});
  RobotDescription robot;
  robot.footprint = {{0.2, 0.2}, {-0.2, 0.2}, {-0.2, -0.2}};
  robot.sonar.robot_from_sonar = {Pose2{0.1, 0.0, 0.5}};
  const Json json = Json::parse(to_json(building, robot));
  EXPECT_EQ(json["fixtures"][0]["shape"], "rectangle");
  EXPECT_FALSE(json["places"][0].contains("theta"));
  EXPECT_TRUE(json["places"][1].contains("theta"));
  EXPECT_EQ(json["zones"][0]["kind"], "keep-out");
  EXPECT_EQ(json["zones"][0]["polygon"], nlohmann::json::parse("[[1.0, 2.0], [3.0, 2.0], [3.0, 4.0]]"));
  EXPECT_FALSE(json["zones"][0].contains("hours"));
  EXPECT_EQ(json["robot"]["footprint"].size(), 3U);
  EXPECT_DOUBLE_EQ(json["robot"]["sonars"][0][2], 0.5);
}

TEST(BuildingJson, SaysTheHoursOfZonesAndWhichAreInForce) {
  Building building;
  building.zones = {{.name = "yard", .hours = {8 * 3600, 12 * 3600, *read_days("Mo-Fr")}}, {.name = "stairs"}};
  const Json in_the_morning = Json::parse(zones_json(building, {0, 0, 9 * 3600}));
  EXPECT_EQ(in_the_morning[0]["hours"], "08:00-12:00");
  EXPECT_EQ(in_the_morning[0]["days"], "Mo-Fr");
  EXPECT_EQ(in_the_morning[0]["in_force"], true);
  const Json at_noon = Json::parse(zones_json(building, {0, 0, 12 * 3600}));
  EXPECT_EQ(at_noon[0]["in_force"], false);
  EXPECT_EQ(at_noon[1]["in_force"], true);
}

}  // namespace
}  // namespace luminav
