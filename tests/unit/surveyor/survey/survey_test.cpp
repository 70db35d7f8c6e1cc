#include "services/surveyor/survey/survey.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/surveyor/survey/synthetic_drive.hpp"

namespace luminav {
namespace {

/// Corridors round a block of 20 m x 10 m, a lamp every 2.5 m and all alike.
std::vector<Fixture> ring() {
  std::vector<Fixture> fixtures;
  int id = 0;
  for (int i = 0; i < 8; ++i) {
    fixtures.push_back(fixture_at(++id, 1.25 + 2.5 * i, 0.0, 0.0));
    fixtures.push_back(fixture_at(++id, 1.25 + 2.5 * i, 10.0, 0.0));
  }
  for (int i = 0; i < 4; ++i) {
    fixtures.push_back(fixture_at(++id, 0.0, 1.25 + 2.5 * i, 0.5 * kPi));
    fixtures.push_back(fixture_at(++id, 20.0, 1.25 + 2.5 * i, 0.5 * kPi));
  }
  return fixtures;
}

const std::vector<Eigen::Vector2d> kOnceRound = {{2.0, 0.0},  {20.0, 0.0}, {20.0, 10.0},
                                                 {0.0, 10.0}, {0.0, 0.0},  {14.0, 0.0}};

/// An uncalibrated robot.
SyntheticErrors uncalibrated(std::uint32_t seed) {
  SyntheticErrors errors;
  errors.wheels = {0.008, -0.006, 0.01};
  errors.odometry_position = 0.01;
  errors.odometry_heading = radians(0.5);
  errors.sighting_position = 0.004;
  errors.sighting_heading = radians(0.2);
  errors.camera_scale = -0.005;
  errors.false_share = 0.05;
  errors.seed = seed;
  return errors;
}

TEST(Survey, DrawsARingOfFixturesThatAllLookAlike) {
  const SurveyModel model = synthetic_model();
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    const SyntheticDrive synthetic = drive_along(kOnceRound, ring(), model, uncalibrated(seed));
    const Survey survey = survey_drive(synthetic.drive, model);
    EXPECT_EQ(survey.fixtures.size(), 24u) << "seed " << seed;
    EXPECT_LT(rms_after_alignment(ring(), survey.estimate, synthetic.truth.front()), 0.06) << "seed " << seed;
    EXPECT_TRUE(survey.doubts.empty()) << "seed " << seed;
    EXPECT_GT(survey.regularity, 0.9);
  }
}

TEST(Survey, GivesTheSameForTheSameDrive) {
  const SurveyModel model = synthetic_model();
  const SyntheticDrive synthetic = drive_along(kOnceRound, ring(), model, uncalibrated(4));
  const Survey first = survey_drive(synthetic.drive, model);
  const Survey second = survey_drive(synthetic.drive, model);
  ASSERT_EQ(first.fixtures.size(), second.fixtures.size());
  for (std::size_t f = 0; f < first.fixtures.size(); ++f) {
    EXPECT_EQ(first.estimate.fixtures[f].world_from_fixture.x, second.estimate.fixtures[f].world_from_fixture.x);
  }
}

TEST(Survey, SaysHowUnsureADriveWithoutALoopIs) {
  const SurveyModel model = synthetic_model();
  const SyntheticDrive synthetic =
      drive_along({{2.0, 0.0}, {20.0, 0.0}, {20.0, 10.0}, {4.0, 10.0}}, ring(), model, uncalibrated(5));
  const Survey survey = survey_drive(synthetic.drive, model);
  for (const SurveyedFixture& fixture : survey.estimate.fixtures) {
    EXPECT_EQ(fixture.passes.size(), 1u);
  }
  EXPECT_GT(survey.fixtures.front().sigma_along, 0.02);
}

TEST(Survey, TakesTheLongestPartOfADriveThatWasInterrupted) {
  const SurveyModel model = synthetic_model();
  SyntheticDrive synthetic = drive_along(kOnceRound, ring(), model, uncalibrated(6));
  for (std::size_t i = 0; i < synthetic.drive.odometry.size() / 10; ++i) {
    synthetic.drive.odometry[i].session = 7;
  }
  const Survey survey = survey_drive(synthetic.drive, model);
  EXPECT_GT(survey.left_out, 3.0);
  EXPECT_GT(survey.distance, 50.0);
}

/// A drive and what the robot did after its wheels began to count anew.
SyntheticDrive continued(SyntheticDrive first, const SyntheticDrive& second) {
  const std::int64_t later = first.drive.odometry.back().utime + 5'000'000 - second.drive.odometry.front().utime;
  for (OdometryReading reading : second.drive.odometry) {
    reading.utime += later;
    reading.session = 2;
    first.drive.odometry.push_back(reading);
  }
  for (SightingFrame frame : second.drive.frames) {
    frame.utime += later;
    first.drive.frames.push_back(frame);
  }
  return first;
}

/// The ring with lamps at no regular pitch.
std::vector<Fixture> irregular_ring() {
  std::vector<Fixture> fixtures = ring();
  for (std::size_t i = 0; i < fixtures.size(); ++i) {
    Pose2& pose = fixtures[i].world_from_fixture;
    pose = pose * Pose2{0.6 * std::sin(5.0 * static_cast<double>(i)), 0.0, 0.0};
  }
  return fixtures;
}

TEST(Survey, GoesOnWhereARobotStoodWhoseWheelsBeganToCountAnew) {
  const SurveyModel model = synthetic_model();
  const SyntheticDrive before = drive_along({{2.0, 0.0}, {11.3, 0.0}}, ring(), model, uncalibrated(7));
  const SyntheticDrive after = drive_along(
      {{11.3, 0.0}, {20.0, 0.0}, {20.0, 10.0}, {0.0, 10.0}, {0.0, 0.0}, {16.0, 0.0}}, ring(), model, uncalibrated(8));
  const Survey survey = survey_drive(continued(before, after).drive, model);
  EXPECT_EQ(survey.joined_parts, 1);
  EXPECT_EQ(survey.left_out, 0.0);
  EXPECT_EQ(survey.fixtures.size(), 24u);
}

TEST(Survey, LaysPartsOnOneAnotherByTheFixturesThatBothSaw) {
  const SurveyModel model = synthetic_model();
  const std::vector<Fixture> fixtures = irregular_ring();
  const SyntheticDrive first = drive_along({{2.0, 0.0}, {20.0, 0.0}, {20.0, 10.0}}, fixtures, model, uncalibrated(9));
  const SyntheticDrive second = drive_along(
      {{16.0, 0.0}, {20.0, 0.0}, {20.0, 10.0}, {0.0, 10.0}, {0.0, 0.0}, {8.0, 0.0}}, fixtures, model, uncalibrated(10));
  const Survey survey = survey_drive(continued(first, second).drive, model);
  EXPECT_EQ(survey.joined_parts, 1);
  EXPECT_EQ(survey.left_out, 0.0);
  ASSERT_EQ(survey.fixtures.size(), 24u);
  EXPECT_LT(rms_after_alignment(fixtures, survey.estimate, first.truth.front()), 0.12);
}

// Its last image shows one, and there is no pass of it.
TEST(Survey, LeavesOutAPartInWhichNoFixtureWasPassed) {
  const SurveyModel model = synthetic_model();
  const SyntheticDrive standing = drive_along({{11.20, 0.0}, {11.25, 0.0}}, ring(), model, {});
  const SyntheticDrive round = drive_along(
      {{11.25, 0.0}, {20.0, 0.0}, {20.0, 10.0}, {0.0, 10.0}, {0.0, 0.0}, {16.0, 0.0}}, ring(), model, uncalibrated(8));
  for (const SyntheticDrive& drive : {continued(standing, round), continued(round, standing)}) {
    const Survey survey = survey_drive(drive.drive, model);
    EXPECT_EQ(survey.joined_parts, 0);
    EXPECT_EQ(survey.fixtures.size(), 24u);
  }
}

TEST(Survey, TakesAPartWithFixturesBeforeALongerOneWithout) {
  const SurveyModel model = synthetic_model();
  const SyntheticDrive blind = drive_along({{0.0, 50.0}, {90.0, 50.0}}, ring(), model, {});
  const SyntheticDrive round = drive_along(kOnceRound, ring(), model, uncalibrated(6));
  const Survey survey = survey_drive(continued(blind, round).drive, model);
  EXPECT_EQ(survey.fixtures.size(), 24u);
  EXPECT_NEAR(survey.left_out, 90.0, 1.0);
}

TEST(Survey, LeavesOutAPartThatLiesAlikeAtSeveralPlaces) {
  const SurveyModel model = synthetic_model();
  const SyntheticDrive round = drive_along(kOnceRound, ring(), model, uncalibrated(11));
  const SyntheticDrive along = drive_along({{3.0, 0.0}, {16.0, 0.0}}, ring(), model, uncalibrated(12));
  const Survey survey = survey_drive(continued(round, along).drive, model);
  EXPECT_EQ(survey.joined_parts, 0);
  EXPECT_NEAR(survey.left_out, 13.0, 0.5);
  EXPECT_EQ(survey.fixtures.size(), 24u);
}

std::string complaint(const SurveyDrive& drive, const SurveyModel& model) {
  try {
    (void)survey_drive(drive, model);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(Survey, SaysWhatADriveLacks) {
  SurveyModel model = synthetic_model();
  const SyntheticDrive synthetic = drive_along({{0.0, 0.0}, {5.0, 0.0}}, ring(), model, {});
  SurveyDrive drive = synthetic.drive;
  EXPECT_THAT(complaint({}, model), testing::HasSubstr("no ODOMETRY"));
  drive.frames.clear();
  EXPECT_THAT(complaint(drive, model), testing::HasSubstr("FIXTURE_DETECTIONS"));
  drive = synthetic.drive;
  for (SightingFrame& frame : drive.frames) {
    frame.utime += 1'000'000'000;
  }
  EXPECT_THAT(complaint(drive, model), testing::HasSubstr("clocks"));
  model.kinds.kinds[0].shape = FixtureShape::kSquare;
  EXPECT_THAT(complaint(synthetic.drive, model), testing::HasSubstr("no fixture of the 1 kinds"));
}

}  // namespace
}  // namespace luminav
