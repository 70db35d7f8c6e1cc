#include "services/surveyor/drive/survey_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/unit/surveyor/survey/synthetic_drive.hpp"

namespace luminav {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A survey of two fixtures, of which the second is not sure.
Survey small_survey() {
  Survey survey;
  survey.distance = 50.0;
  survey.estimate.has_converged = true;
  survey.frames.resize(1);
  survey.frames[0].utime = 1'000'000;
  survey.estimate.poses = {{1.0, 2.0, 0.5}};
  survey.estimate.fixtures = {{0, {0, 2}, {1.0, 2.0, 2.0}}, {0, {1}, {4.0, 2.0, 0.0}}};
  survey.fixtures.resize(2);
  survey.excess_length = {0.0};
  return survey;
}

SurveyLog good_log() {
  SurveyLog log;
  log.drive.echoes.emplace_back();
  log.looked_at = 100;
  return log;
}

TEST(SurveyReport, MakesABuildingOfWhatIsBelieved) {
  const Building building = building_of(small_survey(), good_log(), synthetic_model(), "school");
  EXPECT_EQ(building.name, "school");
  ASSERT_EQ(building.fixtures.size(), 2u);
  EXPECT_EQ(building.fixtures[1].id, 2);
  EXPECT_NEAR(building.fixtures[0].world_from_fixture.theta, 2.0 - kPi, 1e-12);
  EXPECT_EQ(building.fixtures[0].lamps, 2);
  ASSERT_EQ(building.places.size(), 1u);
  EXPECT_EQ(building.places[0].name, "start");
}

/// A survey that went on with a file: fixture 7 was passed, 9 ought to have been seen, and one is new.
Survey survey_of_known(SurveyModel& model) {
  model.known.emplace();
  model.known->file = "old/building.toml";
  Building& building = model.known->building;
  building.name = "school";
  building.fixtures = {fixture_at(7, 1.3, 2.0, 0.1), fixture_at(9, 8.0, 2.0, 0.0)};
  building.fixtures[0].lamps = 1;
  building.places = {{"lift", {3.0, 3.0, 0.0}, false}};
  building.elements.emplace_back();
  Survey survey = small_survey();
  survey.is_placed = true;
  survey.estimate.fixtures = {
      {0, {0, 2}, {1.0, 2.0, 0.1}, 0}, {0, {}, {8.0, 2.0, 0.0}, 1}, {0, {1}, {4.0, 2.0, 0.0}, -1}};
  survey.fixtures.resize(3);
  survey.fixtures[0].moved = 0.3;
  survey.fixtures[1].expected = 20;
  survey.fixtures[2].sigma_along = 0.3;
  return survey;
}

TEST(SurveyReport, KeepsWhatAKnownBuildingHas) {
  SurveyModel model = synthetic_model();
  const Survey survey = survey_of_known(model);
  const Building building = building_of(survey, good_log(), model, "other");
  EXPECT_EQ(building.name, "school");
  ASSERT_EQ(building.fixtures.size(), 3u);
  EXPECT_EQ(building.fixtures[0].id, 7);
  EXPECT_EQ(building.fixtures[0].lamps, 1);
  EXPECT_EQ(building.fixtures[0].world_from_fixture.x, 1.0);
  EXPECT_EQ(building.fixtures[1].world_from_fixture.x, 8.0);
  EXPECT_EQ(building.fixtures[2].id, 10);
  ASSERT_EQ(building.places.size(), 1u);
  EXPECT_EQ(building.places[0].name, "lift");
  EXPECT_EQ(building.elements.size(), 1u);
  EXPECT_NEAR(building.survey->position, 0.3 / std::sqrt(3.0), 1e-9);
  EXPECT_THAT(unsure_fixtures(survey, model), testing::ElementsAre(10));
  const auto json = nlohmann::json::parse(survey_json(survey, model, {}));
  EXPECT_EQ(json["fixtures"][2]["id"], 10);
  EXPECT_EQ(json["fixtures"][1]["is_known"], true);
}

TEST(SurveyReport, SaysWhatIsNotAsTheKnownBuildingHasIt) {
  SurveyModel model = synthetic_model();
  Survey survey = survey_of_known(model);
  const std::vector<std::string> remarks = remarks_on(survey, good_log(), model);
  EXPECT_THAT(remarks, Contains(HasSubstr("fixture 7 hangs 0.30 m from where")));
  EXPECT_THAT(remarks, Contains(HasSubstr("not seen though the robot passed below: fixtures 9 of the file")));
  survey.is_placed = false;
  survey.estimate.fixtures = {{0, {0, 2}, {1.0, 2.0, 2.0}}};
  survey.fixtures.resize(1);
  survey.excess_length = {0.1};
  EXPECT_THAT(remarks_on(survey, good_log(), model), Contains(HasSubstr("old/building.toml: nobody can tell where")));
  EXPECT_THAT(why_not_placed(survey, model), HasSubstr("look 10 % longer"));
}

TEST(SurveyReport, SaysFromWhereTheCeilingWasSeen) {
  const SurveyModel model = synthetic_model();
  Survey survey = small_survey();
  survey.estimate.poses = {{0.0, 0.0, 0.0}, {0.1, 0.0, 0.0}, {0.6, 0.0, 0.0}, {0.6, 0.9, 0.0}, {0.2, 0.0, 0.0}};
  const std::vector<Eigen::Vector2d> places = {{0.0, 0.0}, {0.6, 0.0}, {0.6, 0.9}};
  EXPECT_EQ(building_of(survey, good_log(), model, "school").seen_from, places);
  SurveyModel going_on = synthetic_model();
  Survey second = survey_of_known(going_on);
  going_on.known->building.seen_from = {{9.0, 9.0}};
  EXPECT_EQ(building_of(second, good_log(), going_on, "").seen_from.front(), Eigen::Vector2d(9.0, 9.0));
}

TEST(SurveyReport, CallsABuildingCompleteThatWasExploredOrIsAndLacksNothing) {
  const SurveyModel model = synthetic_model();
  SurveyLog log = good_log();
  EXPECT_FALSE(building_of(small_survey(), log, model, "school").is_complete);
  log.is_explored = true;
  EXPECT_TRUE(building_of(small_survey(), log, model, "school").is_complete);
  Survey partly = small_survey();
  partly.left_out = 20.0;
  EXPECT_FALSE(building_of(partly, log, model, "school").is_complete);

  SurveyModel going_on = synthetic_model();
  Survey survey = survey_of_known(going_on);
  EXPECT_FALSE(building_of(survey, good_log(), going_on, "").is_complete) << "one was missing";
  survey.estimate.fixtures.pop_back();
  survey.fixtures.pop_back();
  EXPECT_TRUE(building_of(survey, good_log(), going_on, "").is_complete);
  going_on.known->building.is_complete = false;
  EXPECT_FALSE(building_of(survey, good_log(), going_on, "").is_complete);
}

TEST(SurveyReport, NamesPlacesWhereTheRobotWas) {
  Survey survey = small_survey();
  survey.frames.resize(1);
  survey.frames[0].utime = 1'000'000;
  SurveyLog log = good_log();
  log.drive.odometry = {{1'000'000, 1, {}, 0.0, 0.0},
                        {2'000'000, 1, {0.5, 0.0, 0.0}, 0.0, 0.0},
                        {9'000'000, 2, {0.5, 0.0, 0.0}, 0.0, 0.0}};
  log.places = {{"lift", 2'000'000, 1}, {"nowhere", 9'500'000, 2}};
  const Building building = building_of(survey, log, synthetic_model(), "school");
  ASSERT_EQ(building.places.size(), 2u);
  EXPECT_EQ(building.places[1].name, "lift");
  EXPECT_NEAR(building.places[1].pose.x, 1.0 + 0.5 * std::cos(0.5), 1e-9);
  EXPECT_NEAR(building.places[1].pose.theta, 0.5, 1e-9);
  EXPECT_THAT(remarks_on(survey, log, synthetic_model()), Contains(HasSubstr("the place nowhere was named")));
  log.places = {{"start", 2'000'000, 1}};
  EXPECT_EQ(building_of(survey, log, synthetic_model(), "school").places.size(), 1u);
}

TEST(SurveyReport, SaysNothingOfAGoodDrive) {
  EXPECT_THAT(remarks_on(small_survey(), good_log(), synthetic_model()), IsEmpty());
  EXPECT_THAT(unsure_fixtures(small_survey(), synthetic_model()), IsEmpty());
}

TEST(SurveyReport, SaysWhatIsWrongWithTheLog) {
  SurveyLog log;
  log.is_cut = true;
  log.longest_gap = 4.0;
  log.blind_way = 20.0;
  Survey survey = small_survey();
  survey.left_out = 30.0;
  const std::vector<std::string> remarks = remarks_on(survey, log, synthetic_model());
  EXPECT_THAT(remarks, Contains(HasSubstr("cut off")));
  EXPECT_THAT(remarks, Contains(HasSubstr("4.0 s without ODOMETRY")));
  EXPECT_THAT(remarks, Contains(HasSubstr("20 m without an image")));
  EXPECT_THAT(remarks, Contains(HasSubstr("no SONAR")));
  EXPECT_THAT(remarks, Contains(HasSubstr("images were not looked at")));
  EXPECT_THAT(remarks, Contains(HasSubstr("of 30 m nobody can tell where they lie")));
}

TEST(SurveyReport, SaysThatAKindWasMeasuredWrong) {
  Survey survey = small_survey();
  survey.excess_length = {0.1};
  EXPECT_THAT(remarks_on(survey, good_log(), synthetic_model()), Contains(HasSubstr("look 10 % longer")));
}

TEST(SurveyReport, AsksWhetherWhatNeverBurnedIsALamp) {
  Survey survey = small_survey();
  survey.estimate.fixtures.push_back({0, {3}, {7.0, 2.0, 0.0}});
  survey.fixtures.resize(3);
  survey.fixtures[0].has_burned = survey.fixtures[2].has_burned = true;
  EXPECT_THAT(remarks_on(survey, good_log(), synthetic_model()), Contains(HasSubstr("fixtures 2 never burned")));
  survey.fixtures[2].has_burned = false;  // by day, with the lamps off, nothing follows
  EXPECT_THAT(remarks_on(survey, good_log(), synthetic_model()), Not(Contains(HasSubstr("never burned"))));
}

TEST(SurveyReport, SaysWhereToDriveOnceMore) {
  Survey survey = small_survey();
  survey.doubts = {{1, {0}, 0.7}};
  survey.fixtures[1].sigma_along = 0.4;
  const std::vector<std::string> remarks = remarks_on(survey, good_log(), synthetic_model());
  EXPECT_THAT(remarks, Contains(HasSubstr("not closed between (4.0, 2.0) and (1.0, 2.0)")));
  EXPECT_THAT(remarks, Contains(HasSubstr("1 of 2 fixtures")));
  EXPECT_THAT(unsure_fixtures(survey, synthetic_model()), Contains(2));
}

TEST(SurveyReport, SaysThatNothingChecksADriveWithoutALoop) {
  Survey survey = small_survey();
  survey.estimate.fixtures[0].passes = {0};
  EXPECT_THAT(remarks_on(survey, good_log(), synthetic_model()), Contains(HasSubstr("passed no fixture twice")));
}

TEST(SurveyReport, WritesFiguresThatOthersRead) {
  Survey survey = small_survey();
  survey.estimate.dropped.push_back({0, {3}, {9.0, 9.0, 0.0}});
  survey.dropped.push_back({});
  survey.dropped[0].judgement = Judgement::kSeldomSeen;
  const auto json = nlohmann::json::parse(survey_json(survey, synthetic_model(), {"a remark"}));
  EXPECT_EQ(json["fixtures"].size(), 2u);
  EXPECT_EQ(json["fixtures"][0]["passes"], 2);
  EXPECT_EQ(json["fixtures"][0]["covariance"].size(), 9u);
  EXPECT_EQ(json["dropped"][0]["why"], "seen too seldom");
  EXPECT_EQ(json["remarks"][0], "a remark");
  EXPECT_EQ(json["begin_utime"], 1'000'000);
}

}  // namespace
}  // namespace luminav
