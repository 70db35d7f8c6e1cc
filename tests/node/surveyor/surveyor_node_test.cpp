#include "services/surveyor/live/surveyor_node.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "services/common/building/building_check.hpp"
#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/common/process/channels.hpp"
#include "services/localizer/pose_memory.hpp"
#include "services/surveyor/drive/survey_writing.hpp"
#include "services/surveyor/live/surveyor_config.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/detector/ceiling_picture.hpp"

namespace luminav {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const char* const kRobot = LUMINAV_SOURCE_DIR "/launch/robots/p3dx.toml";
const char* const kKinds = "ceiling_height = 2.80\n[[kind]]\nlength = 1.20\nwidth = 0.30\nlamps = 2\n";
constexpr std::int64_t kStart = 1'000'000'000;  // [us]
constexpr double kWall = 1.0;                   // [m] to both sides
constexpr double kStep = 0.06;                  // [m] between two odometry readings
constexpr int kSteps = 280;                     // of the drive:
constexpr int kBackOff = 20;                    // backwards first, so that there is room around where it began,
constexpr int kTurnBack = 220;                  // forwards, and backwards again from here

/// A robot that drives along a corridor with a lamp every 2 m and walls 1 m to both sides, and back again.
class DrivenRobot {
 public:
  explicit DrivenRobot(lcm::LCM& lcm) : lcm_(lcm) {
    CameraIntrinsics& lens = camera_.intrinsics;  // small pictures are drawn sooner
    lens.width /= 2;
    lens.height /= 2;
    lens.fx *= 0.5;
    lens.fy *= 0.5;
    lens.cx *= 0.5;
    lens.cy *= 0.5;
  }

  void drive(int from, int to) {
    for (int i = from; i < to; ++i) {
      step(i);
      while (lcm_.handleTimeout(0) > 0) {
      }
    }
  }

 private:
  static double x_at(double step) {
    const double forwards = step <= kTurnBack ? step : 2.0 * kTurnBack - step;
    return kStep * (step <= kBackOff ? -step : forwards - 2.0 * kBackOff);
  }

  void step(int i) {
    const std::int64_t utime = kStart + 100'000 * i;
    if (i > 0 && i % 2 == 0) {
      camera_image_t image = picture(x_at(i - 0.5));
      image.utime = utime - 50'000 - static_cast<std::int64_t>(std::lround(1e6 * camera_.time_offset));
      lcm_.publish(channels::kCameraImage, &image);
    }
    odometry_t odometry{};
    odometry.utime = utime;
    odometry.session = 1;
    odometry.x = x_at(i);
    odometry.linear = 10.0 * (x_at(i) - x_at(i - 1));
    lcm_.publish(channels::kOdometry, &odometry);
    sonar_t sonar{};
    sonar.utime = utime;
    for (const Pose2& mounted : description_.sonar.robot_from_sonar) {
      const double range = (kWall - std::abs(mounted.y)) / std::abs(std::sin(mounted.theta));
      sonar.range.push_back(static_cast<float>(std::min(range, 5.0)));
      sonar.has_echo.push_back(range < 5.0 ? 1 : 0);
      sonar.fresh.push_back(1);
      sonar.range_utime.push_back(utime);
      ++sonar.count;
    }
    lcm_.publish(channels::kSonar, &sonar);
  }

  /// Drawn once for all tests.
  [[nodiscard]] camera_image_t picture(double x) const {
    static std::map<double, camera_image_t> drawn;
    const auto [entry, is_new] = drawn.try_emplace(x);
    if (is_new) {
      entry->second = draw(x);
    }
    return entry->second;
  }

  [[nodiscard]] camera_image_t draw(double x) const {
    test::DrawnCeiling ceiling;
    ceiling.noise = 0.0;
    for (int lamp = 0; lamp < 7; ++lamp) {
      const Pose2 seen{1.0 + 2.0 * lamp - x, 0.1, 0.0};
      if (std::abs(seen.x) < 2.5) {
        ceiling.shapes.push_back({.pose = seen});
      }
    }
    const GreyImage drawn = test::draw_ceiling(ceiling, camera_, 2.8);
    camera_image_t image{};
    image.width = drawn.width;
    image.height = drawn.height;
    image.format = camera_image_t::FORMAT_MONO8;
    image.data.assign(drawn.pixels.begin(), drawn.pixels.end());
    image.size = static_cast<std::int32_t>(image.data.size());
    return image;
  }

  lcm::LCM& lcm_;
  RobotDescription description_ = read_robot(kRobot);
  CameraDescription camera_ = description_.camera;
};

class SurveyorNodeTest : public testing::Test {
 protected:
  SurveyorNodeTest() { subscriber_.on(channels::kSurveyStatus, &SurveyorNodeTest::on_status, this); }

  void on_status(const survey_status_t& message) { status_ = message; }

  [[nodiscard]] SurveyorConfig config(const std::string& folder = "school") const {
    return read_surveyor_config(kRobot, folder_.write("kinds.toml", kKinds), folder_.path() / folder);
  }

  void command(std::int8_t action, const std::string& name = "") {
    survey_command_t message{};
    message.utime = message.id = ++command_id_;
    message.action = action;
    message.name = name;
    send(message);
  }

  void send(const survey_command_t& message) {
    lcm_.publish(channels::kSurveyCommand, &message);
    drain();
  }

  void finish(SurveyorNode& node) {
    command(survey_command_t::ACTION_FINISH);
    node.settle();
    drain();
  }

  void drain() {
    while (lcm_.handleTimeout(0) > 0) {
    }
  }

  [[nodiscard]] std::string text(const std::string& file) const { return read_whole_file(folder_.path() / file); }

  TemporaryFolder folder_;
  lcm::LCM lcm_{"memq://"};
  Subscriber subscriber_{lcm_};
  survey_status_t status_{};
  DrivenRobot robot_{lcm_};
  std::int64_t command_id_ = kStart;
};

TEST_F(SurveyorNodeTest, ShowsTheMapWhileTheRobotIsDriven) {
  SurveyorNode node(lcm_, config());
  robot_.drive(0, 60);
  EXPECT_EQ(status_.state, survey_status_t::STATE_DRIVING);
  EXPECT_EQ(status_.estimated_distance, 0.0);
  EXPECT_THAT(status_.fixtures, SizeIs(testing::Ge(1U)));
  robot_.drive(60, kSteps);
  node.settle();
  robot_.drive(kSteps, kSteps + 11);
  EXPECT_GT(status_.estimated_distance, 9.0);
  EXPECT_NEAR(status_.distance, kStep * (kSteps + 10), 1.0);
  EXPECT_TRUE(status_.has_pose);
  EXPECT_GT(status_.path_count, 50);
  ASSERT_THAT(status_.fixtures, SizeIs(testing::Ge(6U)));
  EXPECT_FALSE(status_.fixtures[0].is_provisional);
  EXPECT_NEAR(status_.fixtures[1].x - status_.fixtures[0].x, 2.0, 0.05);
}

TEST_F(SurveyorNodeTest, FinishWritesWhatTheSurveyMakesOfItsLog) {
  SurveyorNode node(lcm_, config());
  robot_.drive(0, kSteps);
  finish(node);
  EXPECT_EQ(status_.state, survey_status_t::STATE_FINISHED) << status_.reason;
  EXPECT_EQ(status_.folder, (folder_.path() / "school").string());

  const SurveyorConfig same = config();
  const SurveyLog log =
      read_survey_log(same.log_file().string(), kRobot, same.model.kinds, SightingSource::kImagesElseDetections);
  const std::filesystem::path offline = folder_.path() / "offline" / "school";
  write_survey(log, same.model, {offline, offline / "survey.json", ""});
  for (const std::string file : {"building.toml", "map.yaml", "map.pgm", "survey.json"}) {
    EXPECT_EQ(text("school/" + file), text("offline/school/" + file)) << file;
  }
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "school" / "plan.png"));

  const BuildingSource source = read_building_source(folder_.path() / "school" / "building.toml");
  EXPECT_THAT(source.building.fixtures, SizeIs(testing::Ge(6U)));
  const PriorMap map = read_map(folder_.path() / "school" / "map.yaml");
  for (const BuildingFinding& finding : check_building(source, &map)) {
    EXPECT_NE(finding.kind, FindingKind::kError) << finding.text;
  }
}

TEST_F(SurveyorNodeTest, FinishTellsTheLocalizerWhereTheRobotIs) {
  SurveyorConfig told = config();
  told.state = folder_.path() / "state";
  SurveyorNode node(lcm_, told);
  robot_.drive(0, kSteps);
  finish(node);
  const Building building = read_building(folder_.path() / "school" / "building.toml");
  EXPECT_FALSE(building.is_complete);
  const std::optional<RememberedPose> end = PoseMemory(told.state, building).load();
  ASSERT_TRUE(end);
  EXPECT_EQ(end->building, building.name);
  EXPECT_EQ(end->fixtures, static_cast<int>(building.fixtures.size()));
  EXPECT_EQ(end->session, 1);
  const double way = distance(end->belief.pose, building.places.front().pose);
  EXPECT_NEAR(way, end->odom_from_robot.x, 0.15);  // along the corridor; the first image was taken at -0.09 m
}

// A corridor of equal lamps looks the same from both of its ends.
TEST_F(SurveyorNodeTest, WritesNothingOfADriveThatHasNoClearPlaceInTheKnownBuilding) {
  {
    SurveyorNode node(lcm_, config());
    robot_.drive(0, kSteps);
    finish(node);
  }
  status_ = {};
  SurveyorNode node(lcm_, read_surveyor_config(kRobot, "", folder_.path() / "again", folder_.path() / "school"));
  robot_.drive(0, kSteps);
  EXPECT_THAT(status_.fixtures, SizeIs(testing::Ge(6U))) << "the map grows all the same";
  finish(node);
  EXPECT_EQ(status_.state, survey_status_t::STATE_FAILED);
  EXPECT_THAT(status_.reason, HasSubstr("school/building.toml: nobody can tell where in it the drive lies"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "again" / "building.toml"));
  robot_.drive(kSteps, kSteps + 20);
  EXPECT_GT(status_.distance, kStep * kSteps) << "it goes on";
}

TEST_F(SurveyorNodeTest, KilledItGoesOnAsIfNothingHadHappened) {
  const pid_t child = fork();
  if (child == 0) {
    lcm::LCM lcm("memq://");
    const SurveyorNode node(lcm, config("killed"));
    DrivenRobot(lcm).drive(0, kSteps / 2);
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  {
    SurveyorNode node(lcm_, config("killed"));
    robot_.drive(kSteps / 2, kSteps);
    finish(node);
  }
  EXPECT_EQ(status_.state, survey_status_t::STATE_FINISHED) << status_.reason;
  {
    SurveyorNode node(lcm_, config("whole"));
    robot_.drive(0, kSteps);
    finish(node);
  }
  EXPECT_EQ(text("killed/survey.lcm"), text("whole/survey.lcm"));
  EXPECT_EQ(text("killed/survey.json"), text("whole/survey.json"));
}

TEST_F(SurveyorNodeTest, StartedAgainItGoesOnExploringIfItDid) {
  {
    SurveyorNode node(lcm_, config());
    node.explore_at_once();
    robot_.drive(0, 30);
    EXPECT_TRUE(status_.is_exploring);
  }
  {
    SurveyorNode node(lcm_, config());  // nobody says anything
    robot_.drive(30, 60);
    EXPECT_TRUE(status_.is_exploring);
    command(survey_command_t::ACTION_STAY);
    robot_.drive(60, 90);
    EXPECT_FALSE(status_.is_exploring);
  }
  SurveyorNode node(lcm_, config());
  node.explore_at_once();  // as it was started, but a person has stopped it since
  robot_.drive(90, 120);
  EXPECT_FALSE(status_.is_exploring);
}

TEST_F(SurveyorNodeTest, GoesOnBehindALogThatWasCut) {
  {
    SurveyorNode node(lcm_, config());
    robot_.drive(0, kSteps / 2);
  }
  const std::filesystem::path log = config().log_file();
  std::filesystem::resize_file(log, std::filesystem::file_size(log) - 20);
  SurveyorNode node(lcm_, config());
  robot_.drive(kSteps / 2, kSteps);
  finish(node);
  EXPECT_EQ(status_.state, survey_status_t::STATE_FINISHED) << status_.reason;
  EXPECT_NEAR(status_.distance, kStep * (kSteps - 1), 0.01);
  EXPECT_THAT(status_.remarks, testing::Not(Contains(HasSubstr("cut off"))));
}

TEST_F(SurveyorNodeTest, NamesAPlaceWhereTheRobotIs) {
  SurveyorNode node(lcm_, config());
  robot_.drive(0, 100);
  command(survey_command_t::ACTION_PLACE, "lift");
  const std::uintmax_t size = std::filesystem::file_size(config().log_file());
  survey_command_t again{};
  again.utime = again.id = command_id_;
  again.action = survey_command_t::ACTION_PLACE;
  again.name = "lift";
  send(again);
  EXPECT_EQ(std::filesystem::file_size(config().log_file()), size);
  EXPECT_EQ(status_.echo_id, command_id_);
  EXPECT_EQ(status_.objection, "");
  EXPECT_THAT(status_.place_names, testing::ElementsAre("lift"));
  command(survey_command_t::ACTION_PLACE, "");
  EXPECT_THAT(status_.objection, HasSubstr("name"));
  robot_.drive(100, kSteps);
  finish(node);
  const Building building = read_building_source(folder_.path() / "school" / "building.toml").building;
  ASSERT_THAT(building.places, SizeIs(2));
  EXPECT_EQ(building.places[1].name, "lift");
  EXPECT_NEAR((building.places[1].pose.position() - building.places[0].pose.position()).norm(), 59 * kStep, 0.15);
}

TEST_F(SurveyorNodeTest, SaysWhatIsWrongAndDrivesOn) {
  SurveyorNode node(lcm_, config());
  command(survey_command_t::ACTION_FINISH);
  EXPECT_THAT(status_.objection, HasSubstr("nothing was heard of the robot"));
  robot_.drive(0, 2);
  finish(node);
  EXPECT_EQ(status_.state, survey_status_t::STATE_FAILED);
  EXPECT_THAT(status_.reason, HasSubstr("CAMERA_IMAGE"));
  EXPECT_TRUE(node.health().degraded);
  robot_.drive(2, kSteps - 20);
  node.settle();
  robot_.drive(kSteps - 20, kSteps);
  EXPECT_NE(status_.state, survey_status_t::STATE_FAILED);
  finish(node);
  EXPECT_EQ(status_.state, survey_status_t::STATE_FINISHED) << status_.reason;
  EXPECT_FALSE(node.health().degraded);
}

TEST_F(SurveyorNodeTest, RecordsNothingOnceItIsFinished) {
  {
    SurveyorNode node(lcm_, config());
    robot_.drive(0, kSteps);
    finish(node);
  }
  const std::string log = text("school/survey.lcm");
  SurveyorNode node(lcm_, config());
  node.settle();
  robot_.drive(kSteps, kSteps + 20);
  EXPECT_EQ(status_.state, survey_status_t::STATE_FINISHED);
  EXPECT_FALSE(status_.fixtures.at(0).is_provisional);
  command(survey_command_t::ACTION_PLACE, "lift");
  EXPECT_THAT(status_.objection, HasSubstr("finished"));
  EXPECT_EQ(text("school/survey.lcm"), log);
}

TEST_F(SurveyorNodeTest, ObeysOnlyWhoHasTheKey) {
  CommandKey key;
  key.bytes.fill(7);
  SurveyorNode node(lcm_, config(), key);
  robot_.drive(0, 20);
  command(survey_command_t::ACTION_PLACE, "lift");
  EXPECT_EQ(node.health().dropped_inputs, 1);
  EXPECT_THAT(status_.place_names, IsEmpty());
}

}  // namespace
}  // namespace luminav
