#include "services/mapper/standing_cells.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

constexpr std::int64_t kSecond = 1'000'000;

TEST(StandingCells, CallsStandingWhatGoesOnAnswering) {
  StandingCells cells(2.0, 1.5);
  EXPECT_FALSE(cells.hear(7, 10 * kSecond, true));
  EXPECT_FALSE(cells.hear(7, 11 * kSecond, false));
  EXPECT_TRUE(cells.hear(7, 12 * kSecond, false));
}

TEST(StandingCells, BeginsAnewAfterSilence) {
  StandingCells cells(2.0, 1.5);
  (void)cells.hear(7, 10 * kSecond, true);
  EXPECT_FALSE(cells.hear(7, 20 * kSecond, false));
  EXPECT_FALSE(cells.hear(7, 21 * kSecond, false));
}

TEST(StandingCells, BeginsAnewWhereThePlaceWasSeenFreeMeanwhile) {
  StandingCells cells(2.0, 1.5);
  (void)cells.hear(7, 10 * kSecond, true);
  (void)cells.hear(7, 11 * kSecond, false);
  EXPECT_FALSE(cells.hear(7, 12 * kSecond, true));
}

TEST(StandingCells, KeepsCellsApartAndForgetsOnRequest) {
  StandingCells cells(2.0, 1.5);
  (void)cells.hear(7, 10 * kSecond, true);
  (void)cells.hear(7, 11 * kSecond, false);
  EXPECT_FALSE(cells.hear(8, 12 * kSecond, false));
  cells.clear();
  EXPECT_FALSE(cells.hear(7, 12 * kSecond, false));
}

TEST(StandingCells, SurvivesAClockThatStartsAnew) {
  StandingCells cells(2.0, 1.5);
  (void)cells.hear(7, 100 * kSecond, true);
  EXPECT_FALSE(cells.hear(7, 1 * kSecond, false));
  EXPECT_FALSE(cells.hear(7, 2 * kSecond, false));
  EXPECT_TRUE(cells.hear(7, 3 * kSecond, false));
}

}  // namespace
}  // namespace luminav
