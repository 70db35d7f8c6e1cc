#include "services/common/process/clock.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

/// Clocks of one host, whose file lies in a folder of the test's.
class HostClockTest : public ::testing::Test {
 protected:
  HostClockTest() {
    setenv("XDG_RUNTIME_DIR", folder_.path().c_str(), 1);
    const HostClock first;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
      file_ = entry.path();
    }
  }
  ~HostClockTest() override { unsetenv("XDG_RUNTIME_DIR"); }
  void set_offset(const std::string& text) const { std::ofstream(file_) << text; }

  TemporaryFolder folder_;
  std::filesystem::path file_;
};

TEST_F(HostClockTest, GoesByTheOffsetOfTheFirstOne) {
  constexpr std::int64_t kYear = 31'536'000'000'000;  // [us]
  set_offset(std::to_string(kYear));
  const std::int64_t now = HostClock().utime();
  EXPECT_GT(now, kYear);
  EXPECT_LT(now, 11 * kYear);  // this host is up for less than ten years
}

TEST_F(HostClockTest, TakesNobodyElsesOffset) {
  std::filesystem::permissions(file_, std::filesystem::perms::others_write, std::filesystem::perm_options::add);
  EXPECT_THROW(HostClock(), std::runtime_error);

  const std::filesystem::path elsewhere = folder_.write("elsewhere", "1\n");
  std::filesystem::remove(file_);
  std::filesystem::create_symlink(elsewhere, file_);
  EXPECT_THROW(HostClock(), std::runtime_error);

  std::filesystem::remove(file_);
  ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
  EXPECT_THROW(HostClock(), std::runtime_error);
}

TEST_F(HostClockTest, TakesNoOffsetFromAFileOfAnotherUser) {
  if (chown(file_.c_str(), getuid() + 1, getgid()) != 0) {
    GTEST_SKIP() << "only root may give a file away";
  }
  EXPECT_THROW(HostClock(), std::runtime_error);
}

TEST_F(HostClockTest, LeavesNothingButItsFile) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    EXPECT_EQ(entry.path(), file_);
    ++files;
  }
  EXPECT_EQ(files, 1);
}

}  // namespace
}  // namespace luminav
