#include "services/surveyor/live/survey_messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace luminav {
namespace {

using testing::SizeIs;

constexpr int kDatagram = 65'000;  // [bytes]

CeilingKinds one_kind() {
  CeilingKinds kinds;
  kinds.kinds.emplace_back();
  return kinds;
}

TEST(SurveyMessages, SayWhereFixturesAreAndHowSureThatIs) {
  LiveMap map;
  LiveFixture fixture{0, {1.0, 2.0, 0.5}};
  fixture.covariance << 0.04, 0.01, 0.01, 0.09;
  fixture.is_open = true;
  map.fixtures.push_back(fixture);
  const survey_status_t message = to_message(map, one_kind());
  ASSERT_THAT(message.fixtures, SizeIs(1));
  EXPECT_EQ(message.fixtures[0].y, 2.0);
  EXPECT_EQ(message.fixtures[0].covariance[1], 0.01F);
  EXPECT_EQ(message.fixtures[0].covariance[2], 0.09F);
  EXPECT_TRUE(message.fixtures[0].is_open);
  EXPECT_FALSE(message.has_pose);
}

TEST(SurveyMessages, FitADatagramHoweverLargeTheBuildingIs) {
  LiveMap map;
  map.fixtures.resize(5000);
  map.path.resize(100'000);
  map.places.resize(1000, {std::string(60, 'x'), {1.0, 2.0}});
  map.remarks.resize(1000, std::string(2000, 'x'));
  const survey_status_t message = to_message(map, one_kind());
  EXPECT_LT(message.getEncodedSize(), kDatagram);
  EXPECT_GT(message.path_count, survey_status_t::MAX_PATH / 2);
  EXPECT_LE(message.path_count, survey_status_t::MAX_PATH);
  EXPECT_EQ(message.fixture_count, survey_status_t::MAX_FIXTURES);
}

}  // namespace
}  // namespace luminav
