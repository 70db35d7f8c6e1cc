#include "services/common/process/command_line.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "services/common/process/option_values.hpp"

namespace luminav {
namespace {

void parse(CommandLine& line, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "program");
  std::vector<char*> words;
  for (std::string& argument : arguments) {
    words.push_back(argument.data());
  }
  EXPECT_EQ(line.parse(static_cast<int>(words.size()), words.data()), std::nullopt);
}

/// What a program listens to when it is started with these arguments, in this environment; nullptr = not set.
std::string url_with(const char* launched, const char* of_lcm, const std::vector<std::string>& arguments = {}) {
  launched != nullptr ? setenv("LUMINAV_LCM_URL", launched, 1) : unsetenv("LUMINAV_LCM_URL");
  of_lcm != nullptr ? setenv("LCM_DEFAULT_URL", of_lcm, 1) : unsetenv("LCM_DEFAULT_URL");
  std::string url;
  CommandLine line("program", "does something");
  parse(line.lcm_url(url), arguments);
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

/// The state folder without and with an option, when scripts/launch has set this one; nullptr = not set.
std::string state_with(const char* launched, const std::vector<std::string>& arguments = {}) {
  launched != nullptr ? setenv("LUMINAV_STATE", launched, 1) : unsetenv("LUMINAV_STATE");
  std::string state;
  CommandLine line("program", "does something");
  parse(line.state_folder(state), arguments);
  unsetenv("LUMINAV_STATE");
  return state;
}

TEST(CommandLine, KeepsItsStateWhereTheLaunchedSystemDoes) {
  EXPECT_TRUE(state_with(nullptr).ends_with("/.local/state/luminav"));
  EXPECT_TRUE(state_with("").ends_with("/.local/state/luminav"));
  EXPECT_EQ(state_with("/somewhere"), "/somewhere");
  EXPECT_EQ(state_with("/somewhere", {"--state", "/elsewhere"}), "/elsewhere");
}

TEST(OptionValues, ANumberIsTheWholeWord) {
  EXPECT_EQ(read_number("-8.5"), -8.5);
  EXPECT_EQ(read_number("1e2"), 100.0);
  for (const char* word : {"", " ", "8,5", "8 5", "8m", "nan", "inf", "eight"}) {
    EXPECT_EQ(read_number(word), std::nullopt) << word;
  }
}

TEST(OptionValues, WhatIsNotAllowedIsNamed) {
  EXPECT_NO_THROW(check_option("--cell", 0.1, {0.1, 1.0}));
  EXPECT_THROW(check_option("--cell", 0.0, {0.1, 1.0}), ConfigurationError);
  EXPECT_THROW(check_option("--cell", std::nan(""), {0.1, 1.0}), ConfigurationError);
  EXPECT_NO_THROW(check_option("--mode", "paper", {"paper", "modern"}));
  EXPECT_THROW(check_option("--mode", "papper", {"paper", "modern"}), ConfigurationError);
}

}  // namespace
}  // namespace luminav
