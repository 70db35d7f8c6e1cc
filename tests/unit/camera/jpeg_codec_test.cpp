#include "services/common/image/jpeg_codec.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

namespace luminav {
namespace {

GreyImage ramp_with_noise(int width, int height) {
  GreyImage image{width, height, {}};
  std::mt19937 generator(42);
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      image.pixels.push_back(static_cast<std::uint8_t>(column / 4 + static_cast<int>(generator() % 8)));
    }
  }
  return image;
}

std::vector<std::uint8_t> encoded(const GreyImage& image, int quality) {
  JpegEncoder encoder;
  const auto bytes = encoder.encode(image.view(), quality);
  return {bytes.begin(), bytes.end()};
}

TEST(JpegCodec, GivesBackThePictureWithinTheLossOfTheQuality) {
  const GreyImage image = ramp_with_noise(640, 480);
  const auto bytes = encoded(image, 90);
  JpegDecoder decoder;
  GreyImage back;
  ASSERT_TRUE(decoder.decode(bytes, back));
  ASSERT_EQ(back.width, 640);
  ASSERT_EQ(back.height, 480);
  double squares = 0.0;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    squares += std::pow(double{1} * image.pixels[i] - back.pixels[i], 2);
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(image.pixels.size())), 2.5);  // grey levels; noise here is 2.3
}

TEST(JpegCodec, LowerQualityIsSmaller) {
  const GreyImage image = ramp_with_noise(640, 480);
  EXPECT_LT(encoded(image, 50).size(), encoded(image, 85).size());
  EXPECT_LT(encoded(image, 85).size(), encoded(image, 95).size());
}

TEST(JpegCodec, OneEncoderServesPicturesOfDifferentSize) {
  JpegEncoder encoder;
  JpegDecoder decoder;
  GreyImage back;
  for (const int width : {64, 640, 17}) {
    const GreyImage image = ramp_with_noise(width, 33);
    ASSERT_TRUE(decoder.decode(encoder.encode(image.view(), 85), back));
    EXPECT_EQ(back.width, width);
    EXPECT_EQ(back.height, 33);
    EXPECT_EQ(back.pixels.size(), static_cast<std::size_t>(width) * 33);
  }
}

TEST(JpegCodec, RefusesOtherSidesThanTheCamerasWithoutMakingRoomForThem) {
  JpegDecoder decoder(320, 240);
  GreyImage back;
  EXPECT_FALSE(decoder.decode(encoded(ramp_with_noise(640, 240), 85), back));
  EXPECT_FALSE(decoder.decode(encoded(ramp_with_noise(320, 480), 85), back));
  EXPECT_TRUE(back.pixels.empty());
  EXPECT_TRUE(decoder.decode(encoded(ramp_with_noise(320, 240), 85), back));
}

TEST(JpegCodec, TruncatedAtAnyPlaceIsAFailureAndNotAHalfPicture) {
  const auto bytes = encoded(ramp_with_noise(320, 240), 85);
  JpegDecoder decoder;
  GreyImage back;
  for (std::size_t size = 0; size + 2 < bytes.size(); size += 97) {
    EXPECT_FALSE(decoder.decode(std::span(bytes).first(size), back)) << size << " of " << bytes.size() << " bytes";
  }
  EXPECT_TRUE(decoder.decode(bytes, back)) << "the decoder stays usable";
}

TEST(JpegCodec, GarbageIsAFailureAndNeverACrash) {
  const auto sound = encoded(ramp_with_noise(128, 96), 85);
  JpegDecoder decoder;
  GreyImage back;
  EXPECT_FALSE(decoder.decode({}, back));
  std::mt19937 generator(7);
  for (int trial = 0; trial < 300; ++trial) {
    auto bytes = sound;
    for (int i = 0; i < 5; ++i) {
      bytes[generator() % bytes.size()] = static_cast<std::uint8_t>(generator());
    }
    if (decoder.decode(bytes, back)) {  // a few flipped bits may still be a sound file of another picture
      EXPECT_EQ(back.pixels.size(), static_cast<std::size_t>(back.width) * static_cast<std::size_t>(back.height));
    }
  }
  std::vector<std::uint8_t> noise(5000);
  for (auto& byte : noise) {
    byte = static_cast<std::uint8_t>(generator());
  }
  EXPECT_FALSE(decoder.decode(noise, back));
}

TEST(JpegCodec, EncodesNothingFromAnImpossibleView) {
  JpegEncoder encoder;
  GreyImage image = ramp_with_noise(16, 16);
  image.width = 0;
  EXPECT_TRUE(encoder.encode(image.view(), 85).empty());
  image.width = 17;  // more than there is
  EXPECT_TRUE(encoder.encode(image.view(), 85).empty());
}

}  // namespace
}  // namespace luminav
