#include "services/launcher/deputy/rotating_log.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

namespace luminav::launcher {
namespace {

class RotatingLogTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("luminav-log-test-" + std::to_string(getpid()));
    std::filesystem::remove_all(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string content(const std::string& name) const {
    std::ifstream file(folder_ / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  std::filesystem::path folder_;
};

TEST_F(RotatingLogTest, AppendsToWhatIsThere) {
  RotatingLog(folder_ / "deep" / "a.log", {}).write("one\n");
  RotatingLog(folder_ / "deep" / "a.log", {}).write("two\n");
  EXPECT_EQ(content("deep/a.log"), "one\ntwo\n");
}

TEST_F(RotatingLogTest, KeepsTheNewestFiles) {
  RotatingLog log(folder_ / "a.log", {.file_size = 10, .kept = 2});
  for (const char* text : {"11111111", "22222222", "33333333", "44444444"}) {
    EXPECT_TRUE(log.write(text));
  }
  EXPECT_EQ(content("a.log"), "44444444");
  EXPECT_EQ(content("a.log.1"), "33333333");
  EXPECT_EQ(content("a.log.2"), "22222222");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.log.3"));
}

TEST_F(RotatingLogTest, SaysThatItCannotWriteAndGoesOnWhenItCan) {
  std::filesystem::create_directories(folder_);
  std::ofstream(folder_ / "file") << "in the way";
  RotatingLog log(folder_ / "file" / "a.log", {});
  EXPECT_FALSE(log.write("lost"));
  std::filesystem::remove(folder_ / "file");
  EXPECT_TRUE(log.write("kept"));
  EXPECT_EQ(content("file/a.log"), "kept");
}

TEST_F(RotatingLogTest, SurvivesAFullDisk) {
  RotatingLog log("/dev/full", {});
  EXPECT_FALSE(log.write("text"));
}

TEST(LogFileName, LeavesNoWayOutOfTheFolder) {
  EXPECT_EQ(log_file_name("camera-1.x"), "camera-1.x.log");
  EXPECT_EQ(log_file_name("../../etc/passwd"), "_._.._etc_passwd.log");
  EXPECT_EQ(log_file_name(std::string("a\0b c", 5)), "a_b_c.log");
  EXPECT_EQ(log_file_name(std::string(1000, 'x')).string().size(), 104U);
}

}  // namespace
}  // namespace luminav::launcher
