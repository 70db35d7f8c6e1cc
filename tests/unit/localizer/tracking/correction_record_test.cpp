#include "services/localizer/tracking/correction_record.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

TEST(CorrectionRecord, HasNoMeanBeforeTheFirstMatch) {
  CorrectionRecord record;
  record.add(1'000'000, 3.0, {});
  EXPECT_EQ(record.utime(), 0);
  EXPECT_EQ(record.distance_since(5.0), 5.0);
  EXPECT_FALSE(record.mean_nis());
}

TEST(CorrectionRecord, TellsWhenAndWhereTheLastMatchWas) {
  CorrectionRecord record;
  record.add(1'000'000, 3.0, {6.0});
  record.add(2'000'000, 4.0, {});
  EXPECT_EQ(record.utime(), 1'000'000);
  EXPECT_EQ(record.distance_since(5.0), 2.0);
}

TEST(CorrectionRecord, BeginsTheMeanWithTheFirstMatchAndFollowsTheOthersSlowly) {
  CorrectionRecord record;
  record.add(1'000'000, 0.0, {6.0});
  EXPECT_DOUBLE_EQ(record.mean_nis().value(), 2.0);
  record.add(1'066'667, 0.0, {3.0});
  EXPECT_DOUBLE_EQ(record.mean_nis().value(), 1.98);
  for (int i = 0; i < 1000; ++i) {
    record.add(2'000'000, 0.0, {3.0, 3.0});
  }
  EXPECT_NEAR(record.mean_nis().value(), 1.0, 1e-6);
}

}  // namespace
}  // namespace luminav
