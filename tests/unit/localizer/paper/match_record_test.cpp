#include "services/localizer/paper/match_record.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

LocalizerEstimate written(const MatchRecord& record) {
  LocalizerEstimate estimate;
  record.write_to(estimate);
  return estimate;
}

TEST(MatchRecord, MeasuresTheWaySinceTheLastImageThatWasUsed) {
  MatchRecord record(0.1);
  record.travel(2.0);
  EXPECT_DOUBLE_EQ(written(record).distance_since_fixture, 2.0) << "none was used: since the beginning";
  record.note_image(7);
  record.travel(0.5);
  record.travel(0.25);
  EXPECT_DOUBLE_EQ(record.distance_since(), 0.75);
  EXPECT_EQ(written(record).fixture_utime, 7);
}

TEST(MatchRecord, KeepsARunningMeanPerDegreeOfFreedom) {
  MatchRecord record(0.1);
  EXPECT_FALSE(written(record).has_nis);
  record.add_nis(6.0);
  EXPECT_DOUBLE_EQ(written(record).nis, 2.0);
  record.add_nis(3.0);
  EXPECT_DOUBLE_EQ(written(record).nis, 1.9);
  record.restart_nis();
  EXPECT_FALSE(written(record).has_nis);
  record.add_nis(3.0);
  EXPECT_DOUBLE_EQ(written(record).nis, 1.0) << "what was before does not count";
}

}  // namespace
}  // namespace luminav
