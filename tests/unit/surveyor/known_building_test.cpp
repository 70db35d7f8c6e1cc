#include "services/surveyor/known_building.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/configuration/configuration_error.hpp"
#include "services/surveyor/survey/survey.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/surveyor/survey/synthetic_drive.hpp"

namespace luminav {
namespace {

using testing::ElementsAre;

const char* const kBuilding =
    "name = \"school\"\nceiling_height = 2.8\n"
    "[[fixture]]\nid = 7\nx = 1.0\ny = 2.0\nlength = 1.21\nwidth = 0.3\n"
    "[[fixture]]\nid = 8\nshape = \"round\"\nx = 4.0\ny = 2.0\ndiameter = 0.4\n";

TEST(KnownBuilding, HasTheKindsThatItsFixturesResemble) {
  const TemporaryFolder folder;
  const std::string file = folder.write("building.toml", kBuilding);
  CeilingKinds kinds = synthetic_model().kinds;
  const KnownBuilding known = read_known_building(file, kinds);
  EXPECT_THAT(known.kinds, ElementsAre(0, 1));
  ASSERT_EQ(kinds.kinds.size(), 2u);
  EXPECT_EQ(kinds.kinds[0].length, 1.2);  // as it was measured for the survey
  EXPECT_EQ(kinds.kinds[1].shape, FixtureShape::kRound);
  EXPECT_FALSE(known.map);
}

TEST(KnownBuilding, SaysWhatHangsThereWhereNoKindsAreTold) {
  const TemporaryFolder folder;
  folder.write("building.toml", kBuilding);
  CeilingKinds kinds;
  kinds.ceiling_height = 0.0;
  const KnownBuilding known = read_known_building(folder.path(), kinds);
  EXPECT_THAT(known.kinds, ElementsAre(0, 1));
  EXPECT_EQ(kinds.ceiling_height, 2.8);
}

TEST(KnownBuilding, RefusesAnotherCeilingAndAFileWithoutFixtures) {
  const TemporaryFolder folder;
  const std::string file = folder.write("building.toml", kBuilding);
  CeilingKinds kinds = synthetic_model().kinds;
  kinds.ceiling_height = 3.1;
  EXPECT_THROW((void)read_known_building(file, kinds), ConfigurationError);
  const std::string bare = folder.write("bare.toml", "name = \"bare\"\nceiling_height = 3.1\n");
  EXPECT_THROW((void)read_known_building(bare, kinds), ConfigurationError);
}

TEST(KnownBuilding, IsAsGoodAsItsSurveySaidAndNotBetterForHavingManyFixtures) {
  Building building;
  EXPECT_EQ(accuracy_of(building, 1).position, accuracy_of(building, 100).position);
  building.survey = SurveyAccuracy{0.03, 0.004};
  EXPECT_NEAR(accuracy_of(building, 1).position, 0.03, 1e-12);
  EXPECT_NEAR(accuracy_of(building, 100).position, 0.30, 1e-12);
  EXPECT_NEAR(accuracy_of(building, 100).heading, 0.04, 1e-12);
}

/// Two rows of lamps at no regular pitch, in a frame whose origin and axes are nobody's.
std::vector<Fixture> hall() {
  const Pose2 frame{40.0, -7.0, 0.3};
  std::vector<Fixture> fixtures;
  for (int i = 0; i < 8; ++i) {
    const double x = 2.4 * i + 0.6 * std::sin(5.0 * i);
    for (const double y : {0.0, 3.0}) {
      fixtures.push_back(fixture_at(100 + static_cast<int>(fixtures.size()), 0.0, 0.0, 0.0));
      fixtures.back().world_from_fixture = frame * Pose2{x, y, 0.0};
    }
  }
  return fixtures;
}

/// Drives below both rows; the robot's own frame is another one.
SyntheticDrive drive_in_hall(std::uint32_t seed) {
  std::vector<Fixture> own = hall();
  for (Fixture& fixture : own) {
    fixture.world_from_fixture = Pose2{40.0, -7.0, 0.3}.inverse() * fixture.world_from_fixture;
  }
  SyntheticErrors errors;
  errors.wheels = {0.006, 0.002, 0.004};
  errors.odometry_position = 0.005;
  errors.odometry_heading = radians(0.2);
  errors.sighting_position = 0.003;
  errors.sighting_heading = radians(0.2);
  errors.seed = seed;
  return drive_along({{-1.0, 0.0}, {17.5, 0.0}, {17.5, 3.0}, {-1.0, 3.0}, {-1.0, 0.0}, {6.0, 0.0}}, own,
                     synthetic_model(), errors);
}

/// A model that goes on with a file of these fixtures.
SurveyModel model_with(const std::vector<Fixture>& fixtures) {
  SurveyModel model = synthetic_model();
  KnownBuilding known;
  known.building.fixtures = fixtures;
  known.kinds.assign(fixtures.size(), 0);
  model.known = known;
  return model;
}

/// RMS distance [m] between the fixtures and the nearest ones of the survey, in the frame of the file.
double rms_in_frame(const std::vector<Fixture>& truth, const Survey& survey) {
  double squared = 0.0;
  for (const Fixture& fixture : truth) {
    double nearest = 1e9;
    for (const SurveyedFixture& surveyed : survey.estimate.fixtures) {
      nearest = std::min(nearest, distance(surveyed.world_from_fixture, fixture.world_from_fixture));
    }
    squared += nearest * nearest;
  }
  return std::sqrt(squared / static_cast<double>(truth.size()));
}

TEST(SurveyOfAKnownBuilding, AddsWhatIsMissingInTheFrameOfTheFile) {
  std::vector<Fixture> half;
  for (std::size_t i = 0; i < hall().size(); i += i % 4 == 1 ? 3 : 1) {
    half.push_back(hall()[i]);
  }
  const Survey survey = survey_drive(drive_in_hall(1).drive, model_with(half));
  ASSERT_TRUE(survey.is_placed);
  EXPECT_EQ(survey.fixtures.size(), 16u);
  EXPECT_EQ(survey.joined_parts, 0);
  EXPECT_LT(rms_in_frame(hall(), survey), 0.03);
  for (std::size_t f = 0; f < survey.fixtures.size(); ++f) {
    EXPECT_EQ(survey.estimate.fixtures[f].known, f < 8 ? static_cast<int>(f) : -1);
  }
}

TEST(SurveyOfAKnownBuilding, RefinesWhatAnEarlierSurveyHasWrong) {
  std::vector<Fixture> bent = hall();
  for (std::size_t i = 0; i < bent.size(); ++i) {
    Pose2& pose = bent[i].world_from_fixture;
    pose =
        pose * Pose2{0.05 * std::sin(0.4 * static_cast<double>(i)), 0.05 * std::cos(0.5 * static_cast<double>(i)), 0.0};
  }
  SurveyModel model = model_with(bent);
  model.known->building.survey = SurveyAccuracy{0.05, 0.005};
  const Survey survey = survey_drive(drive_in_hall(2).drive, model);
  ASSERT_TRUE(survey.is_placed);
  EXPECT_EQ(survey.fixtures.size(), 16u);
  std::vector<Fixture> refined = bent;
  for (std::size_t f = 0; f < refined.size(); ++f) {
    refined[f].world_from_fixture = survey.estimate.fixtures[f].world_from_fixture;
  }
  SurveyEstimate before = survey.estimate;
  for (std::size_t f = 0; f < bent.size(); ++f) {
    before.fixtures[f].world_from_fixture = bent[f].world_from_fixture;
  }
  const Pose2 start = survey.estimate.poses.front();
  EXPECT_LT(rms_after_alignment(hall(), survey.estimate, start), 0.6 * rms_after_alignment(hall(), before, start));
}

TEST(SurveyOfAKnownBuilding, KeepsALampThatIsNotSeenAndSaysThatOneHangsElsewhere) {
  std::vector<Fixture> told = hall();
  told.push_back(fixture_at(999, 0.0, 0.0, 0.0));
  told.back().world_from_fixture = Pose2{40.0, -7.0, 0.3} * Pose2{9.0, 0.0, 0.5 * kPi};  // dark today
  told[5].world_from_fixture = told[5].world_from_fixture * Pose2{0.28, 0.0, 0.0};
  const Survey survey = survey_drive(drive_in_hall(3).drive, model_with(told));
  ASSERT_TRUE(survey.is_placed);
  EXPECT_EQ(survey.fixtures.size(), 17u);
  EXPECT_EQ(survey.fixtures[16].seen, 0);
  EXPECT_GT(survey.fixtures[16].expected, 5);
  EXPECT_LT(distance(survey.estimate.fixtures[16].world_from_fixture, told.back().world_from_fixture), 0.01);
  EXPECT_GT(survey.fixtures[5].moved, 0.2);
  EXPECT_LT(survey.fixtures[4].moved, 0.1);
}

TEST(SurveyOfAKnownBuilding, IsNotPlacedInAnotherOneNorInOneThatIsTooLarge) {
  std::vector<Fixture> other = hall();
  std::vector<Fixture> larger = hall();
  for (std::size_t i = 0; i < other.size(); ++i) {
    other[i].world_from_fixture = {3.1 * static_cast<double>(i % 4) + 0.3 * std::sin(7.0 * static_cast<double>(i)),
                                   2.2 * static_cast<double>(i / 4), i % 3 == 0 ? 0.0 : 0.5 * kPi};
    larger[i].world_from_fixture.x *= 1.1;
    larger[i].world_from_fixture.y *= 1.1;
  }
  for (const std::vector<Fixture>& file : {other, larger}) {
    const Survey survey = survey_drive(drive_in_hall(4).drive, model_with(file));
    EXPECT_FALSE(survey.is_placed);
    EXPECT_EQ(survey.fixtures.size(), 16u);  // what was seen has a map of its own
    EXPECT_EQ(survey.estimate.fixtures.front().known, -1);
  }
}

/// Lamps at one pitch: where along them the robot drove, they do not tell.
std::vector<Fixture> even_row() {
  std::vector<Fixture> fixtures;
  for (int i = 0; i < 30; ++i) {
    fixtures.push_back(fixture_at(i, 2.5 * i, 0.0, 0.0));
  }
  return fixtures;
}

TEST(SurveyOfAKnownBuilding, IsPlacedByItsWallsOrALocalizerWhereLampsAreAlike) {
  const SurveyModel lamps_alone = model_with(even_row());
  SyntheticDrive synthetic = drive_along({{26.0, 0.0}, {48.0, 0.0}}, even_row(), lamps_alone, {});
  EXPECT_FALSE(survey_drive(synthetic.drive, lamps_alone).is_placed);

  SurveyModel with_walls = lamps_alone;
  PriorMap map;
  map.geometry = {0.1, {-1.0, -1.0}, 760, 20};
  map.cells.assign(map.geometry.size(), Prior::kOccupied);
  for (int row = 0; row < 20; ++row) {
    std::fill_n(map.cells.begin() + map.geometry.index({265, row}), 227, Prior::kFree);
  }
  with_walls.known->map = map;
  const Survey by_walls = survey_drive(synthetic.drive, with_walls);
  ASSERT_TRUE(by_walls.is_placed);
  EXPECT_NEAR(by_walls.estimate.poses.front().x, synthetic.truth.front().x, 0.1);

  for (std::size_t i = 0; i < synthetic.drive.odometry.size(); i += 10) {
    const OdometryReading& reading = synthetic.drive.odometry[i];
    synthetic.drive.told.push_back({reading.utime, Pose2{26.1, 0.1, 0.0} * reading.odom_from_robot});
  }
  const Survey told = survey_drive(synthetic.drive, lamps_alone);
  ASSERT_TRUE(told.is_placed);
  EXPECT_NEAR(told.estimate.poses.front().x, synthetic.truth.front().x, 0.1);
}

}  // namespace
}  // namespace luminav
