#include "services/surveyor/live/survey_work.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/surveyor/survey/synthetic_drive.hpp"

namespace luminav {
namespace {

using testing::HasSubstr;

TEST(SurveyWork, IsIdleUntilItIsGivenSomething) {
  SurveyWork work;
  EXPECT_FALSE(work.under_way());
  EXPECT_FALSE(work.take_result());
  work.wait();
}

TEST(SurveyWork, EstimatesADrive) {
  const SurveyModel model = synthetic_model();
  SurveyLog log;
  log.drive = drive_along({{0.0, 0.0}, {6.0, 0.0}}, {fixture_at(1, 3.0, 0.0, 0.0)}, model, {}).drive;
  SurveyWork work;
  work.estimate(log, model);
  EXPECT_EQ(work.under_way(), SurveyWork::Kind::kEstimate);
  work.wait();
  const std::optional<SurveyWork::Result> result = work.take_result();
  ASSERT_TRUE(result && result->estimate) << (result ? result->failure : "");
  EXPECT_EQ(result->estimate->survey.fixtures.size(), 1u);
  EXPECT_NEAR(result->estimate->distance, 6.0, 0.01);
  EXPECT_FALSE(work.under_way());
}

TEST(SurveyWork, SaysInASentenceWhyThereIsNothing) {
  SurveyWork work;
  work.write({}, synthetic_model(), {testing::TempDir() + "/nothing", "", ""});
  work.wait();
  const std::optional<SurveyWork::Result> result = work.take_result();
  ASSERT_TRUE(result);
  EXPECT_EQ(result->kind, SurveyWork::Kind::kWrite);
  EXPECT_FALSE(result->estimate);
  EXPECT_THAT(result->failure, HasSubstr("no ODOMETRY"));
}

}  // namespace
}  // namespace luminav
