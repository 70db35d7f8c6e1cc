#include "services/viewer/http/token_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "services/common/configuration/toml_table.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

class TokenFileTest : public ::testing::Test {
 protected:
  void write(const std::string& text, mode_t mode = 0600) {
    std::filesystem::create_directories(file_.parent_path());
    std::ofstream(file_) << text;
    chmod(file_.c_str(), mode);
  }
  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "p3dx" / "viewer_token";
};

TEST_F(TokenFileTest, OutlivesTheViewer) {
  const std::string token = read_or_make_token(file_);
  EXPECT_EQ(token.size(), 24U);
  EXPECT_EQ(read_or_make_token(file_), token);
}

TEST_F(TokenFileTest, IsReadableByNobodyElse) {
  read_or_make_token(file_);
  struct stat status {};
  ASSERT_EQ(stat(file_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600U);
  chmod(file_.c_str(), 0640);
  EXPECT_THROW(read_or_make_token(file_), ConfigurationError);
}

TEST_F(TokenFileTest, TakesATokenThatSomebodyChose) {
  write("a-token-of_my-own\n");
  EXPECT_EQ(read_or_make_token(file_), "a-token-of_my-own");
}

TEST_F(TokenFileTest, RefusesWhatIsNoToken) {
  for (const char* text : {"short", "with blanks in it it is cut to with", "sixteen letters?"}) {
    write(text);
    EXPECT_THROW(read_or_make_token(file_), ConfigurationError) << text;
  }
}

TEST_F(TokenFileTest, MakesANewOneWhereAPowerCutLeftNone) {
  write("");
  EXPECT_EQ(read_or_make_token(file_).size(), 24U);
}

TEST_F(TokenFileTest, FollowsNoLink) {
  write("a-token-of_my-own\n");
  const std::filesystem::path link = folder_.path() / "link";
  std::filesystem::create_symlink(file_, link);
  EXPECT_THROW(read_or_make_token(link), ConfigurationError);
}

}  // namespace
}  // namespace luminav
