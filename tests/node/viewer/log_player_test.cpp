#include "services/viewer/playback/log_player.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <luminav/goal_t.hpp>
#include <luminav/grid_tile_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <nlohmann/json.hpp>

#include "services/common/log/log_message.hpp"
#include "services/common/process/channels.hpp"
#include "services/viewer/playback/log_index.hpp"
#include "services/viewer/playback/log_view.hpp"

namespace luminav {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Json = nlohmann::json;

constexpr std::int64_t kBegin = 1'700'000'000'000'000;  // [us]
constexpr std::int64_t kSecond = 1'000'000;             // [us]

pose_t pose(std::int64_t at, std::int8_t state, const char* reason = "") {
  pose_t message{};
  message.utime = kBegin + at;
  message.state = state;
  message.reason = reason;
  message.x = static_cast<double>(at) * 1e-6;
  return message;
}

/// Ten seconds: a pose each half second, lost from 4 s to 6 s; two tiles at the beginning, one of them anew at 5 s; a
/// goal at 1 s, repeated; a stop at 8 s.
class LogPlayerTest : public ::testing::Test {
 protected:
  LogPlayerTest() {
    file_ = std::filesystem::path(testing::TempDir()) / "log_player_test.lcm";
    LogWriter writer(file_.string());
    const auto write = [&](std::int64_t at, const char* channel, const auto& message) {
      const std::vector<std::uint8_t> data = encoded(message);
      writer.write(kBegin + at, channel, data.data(), data.size());
    };
    write(0, channels::kGridTile, tile(0, 1));
    write(0, channels::kGridTile, tile(1, 1));
    goal_t goal{};
    goal.utime = kBegin;
    goal.id = kBegin;
    goal.count = 1;
    goal.poses.resize(1);
    goal.poses[0].place = "lift";
    for (std::int64_t at = 0; at <= 10 * kSecond; at += kSecond / 2) {
      const bool is_lost = at >= 4 * kSecond && at < 6 * kSecond;
      write(at, channels::kPose,
            pose(at, is_lost ? pose_t::STATE_LOST : pose_t::STATE_TRACKING, is_lost ? "lifted" : ""));
      robot_status_t status{};
      status.utime = kBegin + at;
      status.stop_engaged = at >= 8 * kSecond;
      status.reason = at >= 8 * kSecond ? "viewer@desk" : "";
      write(at, channels::kRobotStatus, status);
      if (at == kSecond || at == 3 * kSecond / 2) {
        write(at, channels::kGoal, goal);
      }
      if (at == 5 * kSecond) {
        write(at, channels::kGridTile, tile(1, 2));
      }
    }
    writer.finish();
  }
  ~LogPlayerTest() override { std::filesystem::remove(file_); }

  static grid_tile_t tile(int column, int revision) {
    grid_tile_t message{};
    message.utime = kBegin;
    message.map_session = 1;
    message.tile_column = column;
    message.revision = revision;
    message.resolution = 0.1;
    message.columns = 128;
    message.rows = 64;
    message.size = 1;
    message.data = {0};
    return message;
  }

  /// What is handed out while `elapsed` [us] pass: channels and seconds, as "POSE 1.5".
  std::vector<std::string> heard(LogPlayer& player, std::int64_t elapsed) {
    std::vector<std::string> heard;
    player.advance(elapsed, {.start_anew =
                                 [&] {
                                   ++anew_;
                                   heard.clear();
                                 },
                             .feed =
                                 [&](const LogEvent& event, std::int64_t at) {
                                   heard.push_back(event.channel + " " + std::to_string(at / 100'000));
                                   data_ = event.data;
                                 }});
    return heard;
  }

  std::filesystem::path file_;
  int anew_ = 0;
  std::vector<std::uint8_t> data_;  // of the last message
};

TEST_F(LogPlayerTest, StandsStillUntilToldAndThenKeepsThePace) {
  LogPlayer player(file_.string());
  EXPECT_THAT(heard(player, 5 * kSecond), ElementsAre("GRID_TILE 0", "GRID_TILE 0", "POSE 0", "ROBOT_STATUS 0"));
  player.order({.playing = true});
  EXPECT_THAT(heard(player, kSecond / 2), ElementsAre("POSE 5", "ROBOT_STATUS 5"));
  player.order({.speed = 2.0});
  EXPECT_THAT(heard(player, kSecond / 4), ElementsAre("POSE 10", "ROBOT_STATUS 10", "GOAL 10"));
  player.order({.playing = false});
  EXPECT_THAT(heard(player, 5 * kSecond), ElementsAre());
  EXPECT_EQ(anew_, 0);
}

TEST_F(LogPlayerTest, HandsOutTheBytesOfTheLog) {
  LogPlayer player(file_.string());
  player.order({.playing = true, .speed = 16.0});
  heard(player, kSecond);
  robot_status_t last{};
  ASSERT_GT(last.decode(data_.data(), 0, static_cast<int>(data_.size())), 0);
  EXPECT_EQ(last.utime, kBegin + 10 * kSecond);
}

TEST_F(LogPlayerTest, AJumpStartsAnewWithTheNewestOfEachSubjectAndTheLastSecond) {
  LogPlayer player(file_.string());
  player.order({.position = 7.2});
  const std::vector<std::string> expected = {"GRID_TILE 0",     "GOAL 15", "GRID_TILE 50",   "POSE 65",
                                             "ROBOT_STATUS 65", "POSE 70", "ROBOT_STATUS 70"};
  EXPECT_EQ(heard(player, kSecond), expected);
  player.order({.position = 9.0});
  heard(player, kSecond);
  player.order({.position = 7.2});
  EXPECT_EQ(heard(player, kSecond), expected) << "back";
  EXPECT_EQ(anew_, 3);
  player.order({.playing = true});
  EXPECT_THAT(heard(player, kSecond / 2), ElementsAre("POSE 75", "ROBOT_STATUS 75")) << "and on from there";
}

TEST_F(LogPlayerTest, StopsAtTheEndAndPlaysOnceMoreFromTheBeginning) {
  LogPlayer player(file_.string());
  player.order({.playing = true, .position = 9.9});
  heard(player, kSecond);
  Json state = Json::parse(player.state_json());
  EXPECT_EQ(state["playing"], false);
  EXPECT_EQ(state["position"], 10.0);
  player.order({.playing = true});
  heard(player, kSecond);
  state = Json::parse(player.state_json());
  EXPECT_EQ(state["playing"], true);
  EXPECT_EQ(state["position"], 1.0);
  EXPECT_EQ(state["jumps"], 2);
  player.order({.position = 1e9});
  heard(player, 0);
  EXPECT_EQ(player.position(), 10 * kSecond);
}

TEST_F(LogPlayerTest, MarksGoalsStopsAndLossesOnce) {
  const LogPlayer player(file_.string());
  const Json marks = Json::parse(player.json())["marks"];
  EXPECT_EQ(marks, Json::parse(R"([{"at":1.0,"kind":"goal","text":"lift"},{"at":4.0,"kind":"lost","text":"lifted"},
                                   {"at":8.0,"kind":"stop","text":"viewer@desk"}])"));
}

TEST_F(LogPlayerTest, AClockThatWentBackStandsStill) {
  LogWriter writer(file_.string());
  const std::vector<std::uint8_t> data = encoded(pose(0, pose_t::STATE_LOST));
  for (const std::int64_t at : {0, 1, -3600, -3598}) {
    writer.write(kBegin + at * kSecond, channels::kPose, data.data(), data.size());
  }
  writer.finish();
  LogReader reader(file_.string());
  const LogIndex index(reader);
  EXPECT_EQ(index.duration(), 3 * kSecond);
  EXPECT_EQ(index.count_until(kSecond), 3U);
}

TEST_F(LogPlayerTest, RefusesWhatIsNoLog) {
  std::filesystem::resize_file(file_, 0);
  EXPECT_THROW(LogPlayer(file_.string()), std::runtime_error);
}

/// What the page is shown.
TEST_F(LogPlayerTest, TheViewShowsTheLogsTimeAndForgetsWhatAJumpBackUndoes) {
  SnapshotBoard board;
  PictureStore pictures;
  LogView view(file_.string(), {}, board, pictures);
  const auto state = [&] { return Json::parse(json_of(*board.newest(SnapshotBoard::Lane::kLive, "state"))); };
  view.player().order({.position = 9.7});
  view.advance(0);
  EXPECT_EQ(state()["utime"], kBegin + 97 * kSecond / 10);
  EXPECT_DOUBLE_EQ(state()["pose"]["x"], 9.5);
  EXPECT_DOUBLE_EQ(state()["ages"]["POSE"], 0.2);
  EXPECT_EQ(board.all(SnapshotBoard::Lane::kBulk).size(), 2U);
  view.advance(5 * kSecond);
  EXPECT_DOUBLE_EQ(state()["ages"]["POSE"], 0.2) << "no time passes in a log that stands still";
  EXPECT_THAT(*board.newest(SnapshotBoard::Lane::kBulk, "tile 1 0"), HasSubstr(R"("revision":2)"));
  view.player().order({.position = 0.0});
  view.advance(0);
  EXPECT_DOUBLE_EQ(state()["pose"]["x"], 0.0);
  EXPECT_THAT(*board.newest(SnapshotBoard::Lane::kBulk, "tile 1 0"), HasSubstr(R"("revision":1)"));
  SnapshotBoard::Cursor cursor;
  EXPECT_THAT(*board.read(cursor, 1'000'000).front(), HasSubstr("event: playback")) << "the jump comes first";
  view.show_processes();
  EXPECT_NE(board.newest(SnapshotBoard::Lane::kAsked, "metrics"), nullptr);
}

}  // namespace
}  // namespace luminav
