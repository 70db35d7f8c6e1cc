#include "tests/replay/replay_run.hpp"

#include <gmock/gmock.h>

#include "tests/replay/replay_nodes.hpp"
#include "tests/replay/replay_verdict.hpp"

namespace luminav {
namespace {

using testing::HasSubstr;

const std::string kFolder = LUMINAV_SOURCE_DIR "/tests/replay/logs/";

// What the recorded drives may be worse by. Poses while TRACKING are good to 2 cm and 0.7 degrees RMS on all of them;
// the bounds leave room for another filter, not for another fixture's pose (1.2 m away) or a map drawn beside the
// walls.
constexpr ReplayTolerances kTolerances{.position = 0.06, .heading = radians(1.5), .localized = 6.0, .map = 0.15};

ReplayOptions options_for(const std::string& log, std::set<std::string> nodes = {"localizer", "mapper", "planner"}) {
  ReplayOptions options;
  options.log_file = kFolder + log;
  options.robot_file = LUMINAV_SOURCE_DIR "/launch/robots/p3dx.toml";
  options.building_file = LUMINAV_SOURCE_DIR "/launch/buildings/laboratory/building.toml";
  options.nodes = std::move(nodes);
  options.tolerances = kTolerances;
  return options;
}

/// The verdict, and that there was something to judge.
ReplayReport expect_passes(const ReplayOptions& options) {
  ReplayReport report = replay_log(options);
  EXPECT_THAT(report.failures, testing::IsEmpty());
  EXPECT_TRUE(report.has_truth);
  EXPECT_GT(report.replayed.compared, 30);
  EXPECT_GE(report.recorded.localized_s, 0.0);
  EXPECT_GT(report.map.recorded_cells, 0);
  EXPECT_GT(report.divergence.channels().at("NAVIGATION_STATUS").recorded, 0);
  return report;
}

TEST(Replay, ClosesTheLoop) {
  const ReplayReport report = expect_passes(options_for("loop.lcm"));
  ASSERT_FALSE(report.trail.empty());
  EXPECT_LT(distance(report.trail.back().believed, report.trail.back().truth), kTolerances.position);
}

TEST(Replay, FindsItselfInTheRecordedDrive) {
  expect_passes(options_for("global.lcm"));
}

TEST(Replay, KeepsItsPoseAmongPeople) {
  expect_passes(options_for("people.lcm"));
}

TEST(Replay, KeepsItsPoseWhenLightsGoOut) {
  expect_passes(options_for("lights-out.lcm"));
}

TEST(Replay, NoticesThatItWasCarried) {
  const ReplayReport report = expect_passes(options_for("kidnapped.lcm"));
  EXPECT_GE(report.replayed.state_changes, 3);  // found itself, and lost itself again
  EXPECT_LT(report.replayed.tracking_ratio, 0.95);
}

TEST(Replay, SeesTheFixturesInTheRecordedPictures) {
  const ReplayReport report =
      expect_passes(options_for("clip.lcm", {"detector", "localizer", "mapper", "planner", "controller"}));
  EXPECT_EQ(report.divergence.channels().at("FIXTURE_DETECTIONS").replayed, report.steps.at("CAMERA_IMAGE").count);
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
  ReplayOptions options = options_for("clip.lcm", {"detector", "localizer"});
  options.camera_shift = 0.4;
  const ReplayReport report = replay_log(options);
  EXPECT_FALSE(report.passed());
  EXPECT_EQ(report.divergence.first_channel(), "FIXTURE_DETECTIONS");
  const std::string text = to_text(report);
  EXPECT_THAT(text, HasSubstr("first divergence: "));
  EXPECT_THAT(text, HasSubstr("FAILED: "));
}

TEST(Replay, FailsWithWorseDetectionsAndNamesTheFirstDivergence) {
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

TEST(Replay, PassesNothingThatItCouldNotCompare) {
  ReplayReport report;
  report.has_poses = report.has_truth = true;
  report.replayed.poses = 100;
  report.replayed.localized_s = 3.0;
  append_verdict({}, report);
  EXPECT_THAT(report.failures, testing::Contains(HasSubstr("nothing to compare with")));
  EXPECT_THAT(to_text(report), testing::ContainsRegex("position RMS +- +-"));
}

TEST(Replay, GivesEveryNodeWhatItListensTo) {
  // what the controller makes of a drive hangs on the localizer's alternatives
  EXPECT_TRUE(inputs_of("controller").contains("HYPOTHESES"));
}

}  // namespace
}  // namespace luminav
