#include "services/common/network/network_access.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "services/common/configuration/robot_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

using ::testing::HasSubstr;

constexpr const char* kOutside = "udpm://239.255.76.67:7667?ttl=1";
constexpr const char* kInside = "udpm://239.255.76.67:7667?ttl=0";

class NetworkAccessTest : public ::testing::Test {
 protected:
  NetworkAccessTest() {
    unsetenv("LUMINAV_KEY");
    setenv("LUMINAV_STATE", folder_.path().c_str(), 1);
    std::filesystem::permissions(folder_.write("robot.key", std::string(64, '7')), std::filesystem::perms::owner_read);
  }
  ~NetworkAccessTest() override {
    unsetenv("LUMINAV_KEY");
    unsetenv("LUMINAV_STATE");
  }
  std::string complaint(const std::string& text) const {
    try {
      read_network_access(folder_.write("robot.toml", text));
    } catch (const ConfigurationError& error) {
      return error.what();
    }
    return "";
  }
  TemporaryFolder folder_;
};

TEST_F(NetworkAccessTest, IsOpenUnlessTheFileSaysOtherwise) {
  const NetworkAccess access = read_network_access(folder_.write("robot.toml", "name = \"x\"\n"));
  EXPECT_FALSE(access.key.has_value());
  EXPECT_TRUE(access.peers.empty());
  EXPECT_THAT(describe(access, kOutside), HasSubstr("open network"));
  EXPECT_THAT(describe(access, kInside), HasSubstr("this machine only"));
}

TEST_F(NetworkAccessTest, ReadsPeersAndAKeyBesideTheFile) {
  const NetworkAccess access = read_network_access(
      folder_.write("robot.toml", "[network]\npeers = [\"10.77.0.1\", \"10.77.0.2\"]\nkey = \"robot.key\"\n"));
  EXPECT_EQ(access.peers, (std::vector<std::uint32_t>{0x0A4D0001, 0x0A4D0002}));
  ASSERT_TRUE(access.key.has_value());
  EXPECT_EQ(access.key->bytes[0], 0x77);
  EXPECT_EQ(access.on(kOutside).peers, access.peers);
  EXPECT_THAT(describe(access, kOutside), HasSubstr("this machine and 2 peers; commands carry the seal"));
}

TEST_F(NetworkAccessTest, TakesTheLaunchedKeyWhereTheFileNamesNone) {
  setenv("LUMINAV_KEY", (folder_.path() / "robot.key").c_str(), 1);
  EXPECT_TRUE(read_network_access("").key.has_value());
  EXPECT_TRUE(read_network_access(folder_.write("robot.toml", "")).key.has_value());
  unsetenv("LUMINAV_KEY");
  EXPECT_FALSE(read_network_access("").key.has_value());
  std::filesystem::copy(folder_.path() / "robot.key", folder_.path() / "network.key");
  EXPECT_TRUE(read_network_access("").key.has_value()) << "that of the state folder";
  setenv("LUMINAV_KEY", "/nowhere", 1);
  EXPECT_THROW(read_network_access(""), ConfigurationError);
}

TEST_F(NetworkAccessTest, SaysWhatIsWrong) {
  EXPECT_THAT(complaint("[network]\npeers = [\"robot\"]\n"),
              HasSubstr("robot.toml:2: network.peers must be a list of IPv4"));
  EXPECT_THAT(complaint("[network]\npeer = []\n"), HasSubstr("peer"));
  EXPECT_THAT(complaint("[network]\nkey = \"none.key\"\n"), HasSubstr("none.key: cannot be read"));
}

}  // namespace
}  // namespace luminav
