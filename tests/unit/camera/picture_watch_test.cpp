#include "drivers/camera/picture_watch.hpp"

#include <gtest/gtest.h>

#include <random>

namespace luminav {
namespace {

/// Pictures at 15 Hz.
class PictureWatchTest : public ::testing::Test {
 protected:
  void show(const GreyImage& image, int pictures) {
    for (int i = 0; i < pictures; ++i) {
      watch_.look_at(image, utime_ += 66'667);
    }
  }
  /// Noise around a grey level.
  GreyImage noise(int grey) {
    GreyImage image{64, 48, std::vector<std::uint8_t>(64 * 48)};
    std::normal_distribution<double> draw(grey, 4.0);
    for (std::uint8_t& pixel : image.pixels) {
      pixel = static_cast<std::uint8_t>(std::clamp(draw(random_), 0.0, 255.0));
    }
    return image;
  }
  static GreyImage even(std::uint8_t grey) { return {64, 48, std::vector<std::uint8_t>(64 * 48, grey)}; }

  PictureWatch watch_;
  std::mt19937 random_{7};
  std::int64_t utime_ = 1'000'000;
};

TEST_F(PictureWatchTest, SaysNothingOfACeilingThatIsLookedAtForLong) {
  for (int i = 0; i < 100; ++i) {
    show(noise(100), 1);
  }
  EXPECT_EQ(watch_.complaint(), "");
}

TEST_F(PictureWatchTest, CallsTheSamePictureFiveTimesRunningFrozen) {
  const GreyImage picture = noise(100);
  show(picture, 4);
  EXPECT_FALSE(watch_.is_frozen());
  show(picture, 1);
  EXPECT_TRUE(watch_.is_frozen());
  EXPECT_NE(watch_.complaint().find("frozen"), std::string::npos);
  show(noise(100), 1);
  EXPECT_EQ(watch_.complaint(), "");
}

TEST_F(PictureWatchTest, TakesBlackAndWhitePicturesThatAreEqualForNoSignOfFreezing) {
  show(even(0), 20);
  EXPECT_FALSE(watch_.is_frozen());
  show(even(255), 20);
  EXPECT_FALSE(watch_.is_frozen());
}

TEST_F(PictureWatchTest, CallsACoveredCameraDarkWithinTwoSecondsAndNoSwitchedLight) {
  for (int i = 0; i < 18; ++i) {
    show(noise(2), 1);  // 1.2 s
  }
  EXPECT_EQ(watch_.complaint(), "");
  for (int i = 0; i < 11; ++i) {
    show(noise(2), 1);  // 1.9 s
  }
  EXPECT_TRUE(watch_.is_dark());
  EXPECT_NE(watch_.complaint().find("covered"), std::string::npos);
  show(noise(60), 1);
  EXPECT_EQ(watch_.complaint(), "");
}

TEST_F(PictureWatchTest, SeesALampInTheDark) {
  GreyImage night = even(1);
  std::fill_n(night.pixels.begin(), 40, std::uint8_t{200});
  for (int i = 0; i < 60; ++i) {
    night.pixels[0] = static_cast<std::uint8_t>(100 + i);
    show(night, 1);
  }
  EXPECT_EQ(watch_.complaint(), "");
}

}  // namespace
}  // namespace luminav
