#include "services/jobs/storage/photo_store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "services/common/configuration/whole_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

using ::testing::ElementsAre;
using Json = nlohmann::json;

camera_image_t picture(std::int64_t utime) {
  camera_image_t image{};
  image.utime = utime;
  image.format = camera_image_t::FORMAT_JPEG;
  image.data = {0xff, 0xd8, 1, 2, 3};
  image.size = 5;
  return image;
}

class PhotoStoreTest : public testing::Test {
 protected:
  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(photos_)) {
      names.push_back(entry.path().filename());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  TemporaryFolder folder_;
  std::filesystem::path photos_ = folder_.path() / "photos";
  PhotoStore store_{photos_};
};

TEST_F(PhotoStoreTest, KeepsAPictureAsItCameWithPlaceAndPose) {
  store_.keep(picture(1'769'860'800'000'000), {17, 2, "lift"}, Pose2{1.0, 2.0, 0.5});
  EXPECT_THAT(files(), ElementsAre("1769860800000000-17-2.jpg", "1769860800000000-17-2.json"));
  EXPECT_EQ(read_whole_file(photos_ / files()[0]), "\xff\xd8\x01\x02\x03");
  const Json about = Json::parse(read_whole_file(photos_ / files()[1]));
  EXPECT_EQ(about["place"], "lift");
  EXPECT_EQ(about["pose"], (Json{1.0, 2.0, 0.5}));
}

TEST_F(PhotoStoreTest, KeepsAPictureThatIsNoJpegAsAFileThatProgramsRead) {
  camera_image_t grey = picture(1'769'860'800'000'000);
  grey.format = camera_image_t::FORMAT_MONO8;
  grey.width = 2;
  grey.height = 1;
  grey.data = {7, 8};
  store_.keep(grey, {17, 2, "lift"}, std::nullopt);
  EXPECT_EQ(read_whole_file(photos_ / "1769860800000000-17-2.pgm"), "P5\n2 1\n255\n\x07\x08");
}

TEST_F(PhotoStoreTest, ForgetsTheOldestOfMoreThanAHundred) {
  for (int i = 0; i < 103; ++i) {
    store_.keep(picture(1'000 + i), {17, 0, "lift"}, std::nullopt);
  }
  EXPECT_EQ(files().size(), 200U);
  EXPECT_EQ(files().front(), "0000000000001003-17-0.jpg");
}

TEST_F(PhotoStoreTest, KeepsNothingWhereThereIsNoStateFolder) {
  PhotoStore("").keep(picture(1'000), {17, 0, "lift"}, std::nullopt);
  EXPECT_FALSE(std::filesystem::exists(photos_));
}

}  // namespace
}  // namespace luminav
