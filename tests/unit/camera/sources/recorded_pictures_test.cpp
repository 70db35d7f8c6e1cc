#include "drivers/camera/sources/recorded_pictures.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "drivers/camera/sources/pgm_file.hpp"
#include "drivers/camera/sources/pixel_formats.hpp"

namespace luminav {
namespace {

using Bytes = std::vector<std::uint8_t>;

GreyImage flat(int width, int height, std::uint8_t grey) {
  return {width, height, Bytes(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), grey)};
}

Bytes jpeg(std::uint8_t grey) {
  JpegEncoder encoder;
  const auto bytes = encoder.encode(flat(64, 48, grey).view(), 90);
  return {bytes.begin(), bytes.end()};
}

Bytes joined(const std::vector<Bytes>& parts) {
  Bytes all;
  for (const Bytes& part : parts) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

/// A folder of its own for each test, removed at the end.
class RecordedPicturesTest : public testing::Test {
 protected:
  RecordedPicturesTest() {
    std::string name = (std::filesystem::temp_directory_path() / "luminav-pictures-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~RecordedPicturesTest() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path write(const std::string& name, const Bytes& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return folder_ / name;
  }
  std::filesystem::path folder_;
};

TEST(FindJpegs, FindsEachWholePictureAndNothingBetween) {
  const Bytes a = jpeg(50);
  const Bytes b = jpeg(200);
  const Bytes junk{'R', 'I', 'F', 'F', 0xFF, 0xD8, 0x00, 0xFF};
  const auto found = find_jpegs(joined({junk, a, junk, b}));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].offset, junk.size());
  EXPECT_EQ(found[0].size, a.size());
  EXPECT_EQ(found[1].offset, 2 * junk.size() + a.size());
  EXPECT_EQ(found[1].size, b.size());
}

TEST(FindJpegs, AThumbnailInsideIsNoPictureOfItsOwn) {
  const Bytes small = jpeg(10);
  Bytes big = jpeg(90);
  Bytes segment{0xFF, 0xE1, static_cast<std::uint8_t>((small.size() + 2) >> 8U),
                static_cast<std::uint8_t>((small.size() + 2) & 0xFFU)};
  segment.insert(segment.end(), small.begin(), small.end());
  big.insert(big.begin() + 2, segment.begin(), segment.end());
  const auto found = find_jpegs(big);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].size, big.size());
}

TEST(FindJpegs, LeavesOutAPictureThatIsCut) {
  const Bytes a = jpeg(50);
  for (const std::size_t kept : {std::size_t{0}, std::size_t{3}, a.size() / 2, a.size() - 1}) {
    EXPECT_EQ(find_jpegs(joined({a, Bytes(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(kept))})).size(), 1U);
  }
  EXPECT_TRUE(find_jpegs({}).empty());
}

TEST_F(RecordedPicturesTest, AFolderIsShownByNameAtTheRateAndThenItEnds) {
  write("b.jpg", jpeg(100));
  write("a.jpg", jpeg(20));
  write("notes.txt", {'x'});
  write_pgm(folder_ / "c.pgm", flat(8, 6, 200).view());
  auto pictures = RecordedPictures::in_folder(folder_, 10.0);
  EXPECT_EQ(pictures.size(), 3U);
  Frame frame;
  std::vector<int> greys;
  std::vector<std::int64_t> stamps;
  for (std::int64_t now = 1'000'000; now < 2'000'000; now += 10'000) {
    if (pictures.take(now, frame)) {
      greys.push_back(frame.image.pixels[0]);
      stamps.push_back(frame.utime);
      EXPECT_EQ(frame.exposure_us, 0.0);
    }
  }
  EXPECT_EQ(greys, (std::vector<int>{20, 100, 200}));
  EXPECT_EQ(stamps, (std::vector<std::int64_t>{1'000'000, 1'100'000, 1'200'000}));
  EXPECT_NE(pictures.fault().find("all 3 pictures shown"), std::string::npos) << pictures.fault();
}

TEST_F(RecordedPicturesTest, DamagedPicturesAreLeftOutAndCounted) {
  write("a.jpg", jpeg(20));
  write("b.jpg", Bytes{0xFF, 0xD8, 0xFF, 1, 2, 3});
  write("c.jpg", {});
  write("d.jpg", jpeg(40));
  auto pictures = RecordedPictures::in_folder(folder_, 10.0);
  Frame frame;
  ASSERT_TRUE(pictures.take(0, frame));
  EXPECT_EQ(frame.image.pixels[0], 20);
  ASSERT_TRUE(pictures.take(100'000, frame));
  EXPECT_EQ(frame.image.pixels[0], 40);
  EXPECT_NE(pictures.shortcoming().find("2 pictures"), std::string::npos) << pictures.shortcoming();
}

TEST_F(RecordedPicturesTest, AFileOfManyJpegsIsAFilm) {
  const auto film = write("film.mjpeg", joined({jpeg(10), jpeg(60), jpeg(110)}));
  auto pictures = RecordedPictures::in_file(film, 10.0);
  ASSERT_EQ(pictures.size(), 3U);
  Frame frame;
  std::vector<int> greys;
  for (std::int64_t now = 0; pictures.take(now, frame); now += 100'000) {
    greys.push_back(frame.image.pixels[0]);
  }
  EXPECT_EQ(greys, (std::vector<int>{10, 60, 110}));
}

TEST_F(RecordedPicturesTest, NothingToShowIsAnErrorThatNamesThePlace) {
  EXPECT_THROW(RecordedPictures::in_folder(folder_, 10.0), std::runtime_error);
  EXPECT_THROW(RecordedPictures::in_folder(folder_ / "none", 10.0), std::runtime_error);
  EXPECT_THROW(RecordedPictures::in_file(folder_ / "none", 10.0), std::runtime_error);
  EXPECT_THROW(RecordedPictures::in_file(write("empty.mjpeg", {}), 10.0), std::runtime_error);
}

TEST(PgmFile, ReadsEightAndSixteenBitsAndComments) {
  GreyImage image;
  const std::string eight = "P5 # a comment\n2 1\n255\n";
  Bytes bytes(eight.begin(), eight.end());
  bytes.insert(bytes.end(), {7, 250});
  ASSERT_TRUE(read_pgm(bytes, image));
  EXPECT_EQ(image.pixels, (Bytes{7, 250}));
  const std::string sixteen = "P5\n2 1\n65535\n";
  bytes.assign(sixteen.begin(), sixteen.end());
  bytes.insert(bytes.end(), {0x80, 0x00, 0xFF, 0xFF});
  ASSERT_TRUE(read_pgm(bytes, image));
  EXPECT_EQ(image.pixels, (Bytes{128, 255}));
}

TEST(PgmFile, RefusesWhatIsCutOrImpossible) {
  GreyImage image;
  for (const std::string text :
       {"", "P5", "P6\n1 1\n255\nxxx", "P5\n2 2\n255\nabc", "P5\n0 2\n255\n", "P5\n2 2\n0\nabcd",
        "P5\n999999 999999\n255\n", "P5\n2 -2\n255\nabcd", "P5\n2 2\n255"}) {
    EXPECT_FALSE(read_pgm(Bytes(text.begin(), text.end()), image)) << text;
  }
}

TEST(PixelFormats, TakeTheLumaAndSkipThePadding) {
  GreyImage image{2, 2, {}};
  ASSERT_TRUE(luma_from_yuyv(Bytes{1, 128, 2, 128, 0, 0, 3, 128, 4, 128}, 6, image));
  EXPECT_EQ(image.pixels, (Bytes{1, 2, 3, 4}));
  ASSERT_TRUE(luma_from_grey(Bytes{5, 6, 0, 7, 8}, 3, image));
  EXPECT_EQ(image.pixels, (Bytes{5, 6, 7, 8}));
  EXPECT_FALSE(luma_from_yuyv(Bytes{1, 128, 2, 128, 0, 0, 3, 128, 4}, 6, image));
  EXPECT_FALSE(luma_from_grey(Bytes{5, 6, 7, 8}, 1, image));
}

}  // namespace
}  // namespace luminav
