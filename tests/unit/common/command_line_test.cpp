#include "services/common/process/command_line.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

namespace luminav {
namespace {

/// What a program listens to when it is started with these arguments, in this environment; nullptr = not set.
std::string url_with(const char* launched, const char* of_lcm, std::vector<std::string> arguments = {}) {
  launched != nullptr ? setenv("LUMINAV_LCM_URL", launched, 1) : unsetenv("LUMINAV_LCM_URL");
  of_lcm != nullptr ? setenv("LCM_DEFAULT_URL", of_lcm, 1) : unsetenv("LCM_DEFAULT_URL");
  arguments.insert(arguments.begin(), "program");
  std::vector<char*> words;
  for (std::string& argument : arguments) {
    words.push_back(argument.data());
  }
  std::string url;
  CommandLine line("program", "does something");
  EXPECT_EQ(line.lcm_url(url).parse(static_cast<int>(words.size()), words.data()), std::nullopt);
  unsetenv("LUMINAV_LCM_URL");
  unsetenv("LCM_DEFAULT_URL");
  return url;
}

TEST(CommandLine, TalksOnTheNetworkOfTheLaunchedSystem) {
  const std::string standard = "udpm://239.255.76.67:7667?ttl=0";
  EXPECT_EQ(url_with(nullptr, nullptr), standard);
  EXPECT_EQ(url_with("", ""), standard);
  EXPECT_EQ(url_with(nullptr, "udpm://239.255.76.67:1?ttl=0"), "udpm://239.255.76.67:1?ttl=0");
  EXPECT_EQ(url_with("udpm://239.255.76.67:2?ttl=1", nullptr), "udpm://239.255.76.67:2?ttl=1");
  EXPECT_EQ(url_with("udpm://239.255.76.67:2?ttl=1", "udpm://239.255.76.67:1?ttl=0"), "udpm://239.255.76.67:2?ttl=1");
  EXPECT_EQ(url_with("udpm://239.255.76.67:2?ttl=1", nullptr, {"--lcm-url", "memq://"}), "memq://");
}

}  // namespace
}  // namespace luminav
