#include "services/surveyor/survey/fixture_passes.hpp"

#include <gtest/gtest.h>

#include "tests/unit/surveyor/survey/synthetic_drive.hpp"

namespace luminav {
namespace {

const std::vector<Fixture> kRow = {fixture_at(1, 2.0, 0.0, 0.0), fixture_at(2, 5.0, 0.0, 0.0),
                                   fixture_at(3, 8.0, 0.0, 0.0)};

std::vector<FixturePass> passes_of(const SyntheticDrive& synthetic, const SurveyModel& model) {
  return find_passes(choose_key_frames(synthetic.drive, model.robot.camera, 2.8), model.kinds);
}

TEST(FixturePasses, AreOneForEachTimeAFixturePassesBy) {
  const SurveyModel model = synthetic_model();
  EXPECT_EQ(passes_of(drive_along({{0.0, 0.0}, {10.0, 0.0}}, kRow, model, {}), model).size(), 3u);
  EXPECT_EQ(passes_of(drive_along({{0.0, 0.0}, {10.0, 0.0}, {0.0, 0.1}}, kRow, model, {}), model).size(), 6u);
}

TEST(FixturePasses, LeaveOutWhatIsSeenOnceOnly) {
  const SurveyModel model = synthetic_model();
  SyntheticErrors errors;
  errors.false_share = 0.05;
  EXPECT_EQ(passes_of(drive_along({{0.0, 0.0}, {10.0, 0.0}}, kRow, model, errors), model).size(), 3u);
}

TEST(FixturePasses, TakeTheKindThatFitsBest) {
  SurveyModel model = synthetic_model();
  Fixture narrow = kRow[0];
  narrow.width = 0.15;
  model.kinds.kinds.push_back(narrow);
  const SyntheticDrive synthetic = drive_along({{0.0, 0.0}, {7.0, 0.0}}, {narrow, kRow[1]}, model, {});
  const std::vector<FixturePass> passes = passes_of(synthetic, model);
  ASSERT_EQ(passes.size(), 2u);
  EXPECT_EQ(passes[0].kind, 1);
  EXPECT_EQ(passes[1].kind, 0);
}

TEST(FixturePasses, TellThatTheFileOfKindsIsWrong) {
  SurveyModel model = synthetic_model();
  const SyntheticDrive synthetic = drive_along({{0.0, 0.0}, {10.0, 0.0}}, kRow, model, {});
  model.kinds.kinds[0].length = 1.2 / 1.1;
  const std::vector<FixturePass> passes = passes_of(synthetic, model);
  ASSERT_EQ(passes.size(), 3u);
  EXPECT_NEAR(excess_length(passes, model.kinds, 0), 0.1, 1e-9);
}

TEST(FixturePasses, AreNoneWhereNoKindFits) {
  SurveyModel model = synthetic_model();
  const SyntheticDrive synthetic = drive_along({{0.0, 0.0}, {10.0, 0.0}}, kRow, model, {});
  model.kinds.kinds[0].shape = FixtureShape::kRound;
  EXPECT_TRUE(passes_of(synthetic, model).empty());
  EXPECT_EQ(excess_length({}, model.kinds, 0), 0.0);
}

}  // namespace
}  // namespace luminav
