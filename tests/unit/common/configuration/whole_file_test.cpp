#include "services/common/configuration/whole_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <array>
#include <functional>
#include <iterator>
#include <stdexcept>

namespace luminav {
namespace {

namespace fs = std::filesystem;

class WholeFileTest : public testing::Test {
 protected:
  WholeFileTest() : folder_(fs::path(testing::TempDir()) / "whole_file_test") {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~WholeFileTest() override { fs::remove_all(folder_); }

  [[nodiscard]] std::ptrdiff_t entries() const { return std::distance(fs::directory_iterator(folder_), {}); }

  fs::path folder_;
};

TEST_F(WholeFileTest, ReadsWhatItWrote) {
  const std::string bytes{"a\0b\r\n\xff", 6};
  write_whole_file(folder_ / "file", "what was there before");
  write_whole_file(folder_ / "file", bytes);
  EXPECT_EQ(read_whole_file(folder_ / "file"), bytes);
  EXPECT_EQ(entries(), 1) << "nothing temporary is left";
}

TEST_F(WholeFileTest, SaysWhichFileItCannotReadOrWrite) {
  const fs::path missing = folder_ / "no such folder" / "file";
  for (const auto& act : {std::function<void()>([&] { read_whole_file(missing); }),
                          std::function<void()>([&] { write_whole_file(missing, "bytes"); })}) {
    try {
      act();
      FAIL() << "accepted";
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(missing.string()), std::string::npos);
    }
  }
}

TEST_F(WholeFileTest, LeavesTheOldFileWhereTheNewOneIsNotFinished) {
  write_whole_file(folder_ / "file", "old");
  {
    WholeFile half(folder_ / "file");
    half.write("half of the ne");
  }
  EXPECT_EQ(read_whole_file(folder_ / "file"), "old");
  EXPECT_EQ(entries(), 1);
}

TEST_F(WholeFileTest, WritesTheFileThatALinkLeadsTo) {
  fs::create_directories(folder_ / "there");
  write_whole_file(folder_ / "there" / "file", "old");
  fs::create_symlink("there/file", folder_ / "link");
  fs::create_symlink(folder_ / "link", folder_ / "link of a link");
  fs::create_symlink("there/new", folder_ / "link to nothing yet");
  write_whole_file(folder_ / "link of a link", "new");
  write_whole_file(folder_ / "link to nothing yet", "newer");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_TRUE(fs::is_symlink(folder_ / "link of a link"));
  EXPECT_TRUE(fs::is_symlink(folder_ / "link to nothing yet"));
  EXPECT_EQ(read_whole_file(folder_ / "there" / "file"), "new");
  EXPECT_EQ(read_whole_file(folder_ / "there" / "new"), "newer");
}

TEST_F(WholeFileTest, RefusesLinksThatLeadInACircle) {
  fs::create_symlink("b", folder_ / "a");
  fs::create_symlink("a", folder_ / "b");
  EXPECT_THROW(write_whole_file(folder_ / "a", "bytes"), std::runtime_error);
  EXPECT_EQ(entries(), 2);
}

TEST_F(WholeFileTest, KeepsModeAndOwner) {
  const fs::path file = folder_ / "file";
  write_whole_file(file, "old");
  ASSERT_EQ(chmod(file.c_str(), 0640), 0);
  const bool is_root = geteuid() == 0;
  ASSERT_TRUE(!is_root || chown(file.c_str(), 1234, 4321) == 0);
  write_whole_file(file, "new");
  struct stat status = {};
  ASSERT_EQ(stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777, 0640U);
  EXPECT_EQ(status.st_uid, is_root ? 1234 : geteuid());
  EXPECT_EQ(status.st_gid, is_root ? 4321 : getegid());
  EXPECT_EQ(read_whole_file(file), "new");
}

TEST_F(WholeFileTest, WritesIntoAPipeThatStaysOne) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  write_whole_file(pipe, "bytes");
  std::array<char, 16> read_bytes{};
  EXPECT_EQ(read(reader, read_bytes.data(), read_bytes.size()), 5);
  EXPECT_STREQ(read_bytes.data(), "bytes");
  close(reader);
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_EQ(entries(), 1);
}

TEST_F(WholeFileTest, LeavesADeviceADevice) {
  const fs::path device = folder_ / "null";
  if (mknod(device.c_str(), S_IFCHR | 0666, makedev(1, 3)) != 0 || access(device.c_str(), W_OK) != 0) {
    GTEST_SKIP() << "only root makes devices";
  }
  fs::create_symlink("null", folder_ / "link");
  write_whole_file(device, "bytes");
  write_whole_file(folder_ / "link", "bytes");
  EXPECT_TRUE(fs::is_character_file(fs::symlink_status(device)));
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_TRUE(is_written_in_place(device));
  EXPECT_FALSE(is_written_in_place(folder_));
  EXPECT_EQ(entries(), 2);
}

}  // namespace
}  // namespace luminav
