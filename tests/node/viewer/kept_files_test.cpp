#include "services/viewer/http/kept_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

namespace luminav {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Kind = FileOrder::Kind;

/// A state folder with two recordings and a map, and other things that are nobody's business.
class KeptFilesTest : public ::testing::Test {
 protected:
  KeptFilesTest() : folder_(fs::path(testing::TempDir()) / ("kept_files_" + std::to_string(getpid()))) {
    fs::create_directories(folder_ / "p3dx");
    write("drive-2026-01-31.lcm.00", 200'000, std::chrono::hours(2));
    write("drive-2026-02-01.lcm", 5, std::chrono::hours(1));
    write("network.key", 32, std::chrono::hours(1));
    write("p3dx/map.yaml", 10, std::chrono::hours(1));
    write("p3dx/map.pgm", 90, std::chrono::hours(1));
    write("p3dx/viewer_token", 24, std::chrono::hours(1));
    write("p3dx/other.yaml", 24, std::chrono::hours(1));  // no picture: no map
    fs::create_symlink(folder_ / "network.key", folder_ / "drive-link.lcm");
  }
  ~KeptFilesTest() override { fs::remove_all(folder_); }

  void write(const std::string& name, std::size_t size, std::chrono::seconds age) {
    std::ofstream(folder_ / name) << std::string(size, name[0]);
    fs::last_write_time(folder_ / name, fs::file_time_type::clock::now() - age);
  }
  static std::string all_of(HttpResponse response) {
    std::string content;
    while (content.size() < response.size) {
      content += response.more();
    }
    return content;
  }
  [[nodiscard]] Json list() const { return Json::parse(files_.json()); }

  fs::path folder_;
  KeptFiles files_{folder_, folder_ / "p3dx", folder_ / "p3dx/photos"};
};

TEST_F(KeptFilesTest, ShowsPhotosThatAreWhole) {
  fs::create_directories(folder_ / "p3dx/photos");
  write("p3dx/photos/1769860800000000-17-2.jpg", 9, std::chrono::hours(1));
  write("p3dx/photos/1769860800000000-17-2.json", 5, std::chrono::hours(1));
  write("p3dx/photos/1769860900000000-17-3.jpg", 9, std::chrono::hours(1));  // is being written
  const Json photos = list()["photos"];
  ASSERT_EQ(photos.size(), 1U);
  EXPECT_EQ(photos[0]["name"], "1769860800000000-17-2");
  const std::optional<HttpResponse> picture = files_.fetch("kind=photo&name=1769860800000000-17-2.jpg");
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->type, "image/jpeg");
  EXPECT_EQ(all_of(*picture), std::string(9, 'p'));
  for (const char* wrong : {"kind=photo&name=../viewer_token", "kind=photo&name=map.yaml", "kind=map&name=a.jpg"}) {
    EXPECT_FALSE(files_.fetch(wrong)) << wrong;
  }
  files_.remove({Kind::kPhoto, "1769860800000000-17-2"});
  EXPECT_TRUE(list()["photos"].empty());
}

TEST_F(KeptFilesTest, ListsRecordingsAndMapsTheNewestFirst) {
  const Json recordings = list()["recordings"];
  ASSERT_EQ(recordings.size(), 2U);
  EXPECT_EQ(recordings[0]["name"], "drive-2026-02-01.lcm");
  EXPECT_EQ(recordings[1]["bytes"], 200'000);
  EXPECT_GT(recordings[0]["modified"], recordings[1]["modified"]);
  const Json maps = list()["maps"];
  ASSERT_EQ(maps.size(), 1U);
  EXPECT_EQ(maps[0]["name"], "map");
  EXPECT_EQ(maps[0]["bytes"], 100);
  EXPECT_EQ(maps[0]["files"], Json::parse(R"(["map.yaml","map.pgm"])"));
}

TEST_F(KeptFilesTest, GivesAFilePieceByPiece) {
  const auto recording = files_.fetch("kind=recording&name=drive-2026-01-31.lcm.00");
  ASSERT_TRUE(recording);
  EXPECT_EQ(recording->size, 200'000U);
  EXPECT_EQ(all_of(*recording), std::string(200'000, 'd'));
  EXPECT_EQ(all_of(files_.fetch("name=map.pgm&kind=map").value()), std::string(90, 'p'));
}

TEST_F(KeptFilesTest, GivesNothingElseOfTheFolders) {
  for (const char* query :
       {"", "kind=recording", "kind=recording&name=", "kind=recording&name=network.key",
        "kind=recording&name=drive-link.lcm", "kind=recording&name=../secret.lcm", "kind=recording&name=p3dx/x.lcm",
        "kind=recording&name=.lcm", "kind=recording&name=..lcm", "kind=recording&name=drive-2026-02-01.lcm.",
        "kind=recording&name=drive-2026-02-01.lcm.x", "kind=map&name=viewer_token", "kind=map&name=../p3dx/map.pgm",
        "kind=map&name=map", "kind=map&name=.yaml", "kind=map&name=drive-2026-02-01.lcm", "kind=other&name=map.pgm",
        "kind=recording&name=%2e%2e/x.lcm"}) {
    EXPECT_FALSE(files_.fetch(query)) << query;
  }
}

TEST_F(KeptFilesTest, DeletesWhatIsListedAndNothingElse) {
  files_.remove({Kind::kRecording, "drive-2026-02-01.lcm"});
  files_.remove({Kind::kMap, "map"});
  EXPECT_EQ(list()["recordings"].size(), 1U);
  EXPECT_TRUE(list()["maps"].empty());
  EXPECT_FALSE(fs::exists(folder_ / "p3dx/map.pgm"));
  for (const char* name : {"network.key", "drive-link.lcm", "../x.lcm", "drive-2026-02-01.lcm", ""}) {
    EXPECT_THROW(files_.remove({Kind::kRecording, name}), RequestError) << name;
  }
  EXPECT_THROW(files_.remove({Kind::kMap, "other"}), RequestError);
  EXPECT_TRUE(fs::exists(folder_ / "network.key"));
}

TEST_F(KeptFilesTest, KeepsARecordingThatIsBeingWritten) {
  write("drive-now.lcm", 5, std::chrono::seconds(0));
  fs::last_write_time(folder_ / "drive-now.lcm", fs::file_time_type::clock::now() + std::chrono::seconds(2));
  EXPECT_EQ(list()["recordings"][0]["growing"], true);
  EXPECT_THROW(files_.remove({Kind::kRecording, "drive-now.lcm"}), RequestError);
  EXPECT_TRUE(fs::exists(folder_ / "drive-now.lcm"));
}

TEST(KeptFiles, OfFoldersThatAreNotThereAreNone) {
  EXPECT_EQ(KeptFiles("/no/such/folder", "/no/such/folder/p3dx", "/no/such/photos").json(),
            R"({"recordings":[],"maps":[],"photos":[]})");
}

}  // namespace
}  // namespace luminav
