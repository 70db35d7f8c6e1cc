#include "tests/replay/replay_run.hpp"

#include <gmock/gmock.h>

namespace luminav {
namespace {

using testing::HasSubstr;

const std::string kFolder = LUMINAV_SOURCE_DIR "/tests/replay/logs/";

ReplayOptions options_for(const std::string& log) {
  ReplayOptions options;
  options.log_file = kFolder + log;
  options.robot_file = LUMINAV_SOURCE_DIR "/launch/robots/p3dx.toml";
  options.building_file = LUMINAV_SOURCE_DIR "/launch/buildings/laboratory/building.toml";
  options.nodes = {"localizer", "mapper", "planner"};
  return options;
}

TEST(Replay, FindsItselfInTheRecordedDrive) {
  const ReplayReport report = replay_log(options_for("global.lcm"));
  EXPECT_THAT(report.failures, testing::IsEmpty());
  EXPECT_TRUE(report.has_truth);
  EXPECT_GT(report.replayed.compared, 100);
  EXPECT_LT(report.replayed.position_rms, 0.06);
}

TEST(Replay, NoticesThatItWasCarried) {
  ReplayOptions options = options_for("kidnapped.lcm");
  const ReplayReport report = replay_log(options);
  EXPECT_THAT(report.failures, testing::IsEmpty());
  EXPECT_GE(report.replayed.localized_s, 0.0);
  EXPECT_GE(report.replayed.state_changes, 2);
  EXPECT_EQ(report.replayed.wrong_s, 0.0);
}

TEST(Replay, KeepsItsPoseWhenLightsGoOut) {
  const ReplayReport report = replay_log(options_for("lights-out.lcm"));
  EXPECT_THAT(report.failures, testing::IsEmpty());
  EXPECT_GT(report.replayed.compared, 100);
}

TEST(Replay, GivesTheSameBytesTwice) {
  const ReplayReport first = replay_log(options_for("global.lcm"));
  const ReplayReport second = replay_log(options_for("global.lcm"));
  EXPECT_EQ(first.sha256, second.sha256);
  EXPECT_GT(first.written, 1000);
}

TEST(Replay, NeverFeedsWhatTheReplayedNodesHadSent) {
  ReplayOptions options = options_for("global.lcm");
  options.nodes = {"localizer"};
  const ReplayReport alone = replay_log(options);
  EXPECT_EQ(alone.divergence.channels().at("POSE").replayed, alone.steps.at("POSE").count);
  EXPECT_EQ(alone.steps.count("NAVIGATION_STATUS"), 0U);
}

TEST(Replay, FailsWithAWorseDetectorAndNamesTheFirstDivergence) {
  ReplayOptions options = options_for("global.lcm");
  options.camera_shift = 0.4;
  const ReplayReport report = replay_log(options);
  EXPECT_FALSE(report.passed());
  EXPECT_THAT(report.divergence.first_channel(), testing::AnyOf("POSE", "NAVIGATION_STATUS"));
  EXPECT_THAT(to_text(report), HasSubstr("first divergence: "));
}

TEST(Replay, SaysThatALogWithoutPicturesHasNothingForTheDetector) {
  ReplayOptions options = options_for("global.lcm");
  options.nodes = {"detector"};
  EXPECT_THROW(replay_log(options), std::runtime_error);
}

}  // namespace
}  // namespace luminav
