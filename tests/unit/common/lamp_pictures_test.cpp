#include "services/common/image/lamp_pictures.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace luminav {
namespace {

constexpr std::int64_t kPeriod = 66'667;  // [us]

TEST(LampPictures, AreThoseFarDarkerThanTheOnesBefore) {
  LampPictures pictures;
  for (int i = 0; i < 40; ++i) {
    const bool for_lamps = i / 5 % 2 == 1;
    EXPECT_EQ(pictures.look(kPeriod * i, for_lamps ? 560.0 : 8000.0), for_lamps) << i;
  }
}

TEST(LampPictures, AreNoneWhileExposureControlGoesDownStepByStep) {
  LampPictures pictures;
  double exposure_us = 16000.0;
  for (int i = 0; i < 60; ++i, exposure_us /= i % 5 == 0 ? 1.5 : 1.0) {
    EXPECT_FALSE(pictures.look(kPeriod * i, exposure_us)) << i;
  }
}

TEST(LampPictures, AreNoneAnyMoreOnceItStaysDark) {
  LampPictures pictures;
  EXPECT_FALSE(pictures.look(0, 8000.0));
  EXPECT_TRUE(pictures.look(1'900'000, 500.0));
  EXPECT_FALSE(pictures.look(2'000'000, 500.0));
  EXPECT_FALSE(pictures.look(2'100'000, 500.0));
}

TEST(LampPictures, AreNoneWhereExposuresAreUnknownOrStampsGoBack) {
  LampPictures pictures;
  EXPECT_FALSE(pictures.look(0, 0.0));
  EXPECT_FALSE(pictures.look(kPeriod, 0.0));
  EXPECT_FALSE(pictures.look(2 * kPeriod, std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(pictures.look(3 * kPeriod, 8000.0));
  EXPECT_FALSE(pictures.look(0, 500.0));
}

}  // namespace
}  // namespace luminav
