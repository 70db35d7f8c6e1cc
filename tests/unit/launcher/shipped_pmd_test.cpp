#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "services/launcher/command_words.hpp"
#include "services/launcher/pmd_file.hpp"

namespace luminav::launcher {
namespace {

std::vector<std::filesystem::path> shipped() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(LUMINAV_SOURCE_DIR "/launch")) {
    if (entry.path().extension() == ".pmd") {
      files.push_back(entry.path());
    }
  }
  return files;
}

TEST(ShippedConfigurations, ReadAndHaveAScriptThatStartsThem) {
  ASSERT_GE(shipped().size(), 4U);
  for (const auto& path : shipped()) {
    const PmdFile file = read_pmd(path);
    EXPECT_NE(file.find_script("go"), nullptr) << path;
    EXPECT_FALSE(file.commands.empty()) << path;
  }
}

TEST(ShippedConfigurations, CarryNoPathOfAMachineAndOnlyVariablesThatLaunchSets) {
  const std::set<std::string> known = {
      "LUMINAV_BIN",    "LUMINAV_ROBOT",          "LUMINAV_SCENARIO",     "LUMINAV_BUILDING",
      "LUMINAV_SEED",   "LUMINAV_SIMULATOR_PORT", "LUMINAV_DEVICE",       "LUMINAV_CAMERA",
      "LUMINAV_STATE",  "LUMINAV_IMAGE_URL",      "LUMINAV_MAX_SPEED",    "LUMINAV_LCM_URL",
      "LUMINAV_LOG",    "LUMINAV_SPEED",          "LUMINAV_KINDS",        "LUMINAV_SURVEY",
      "LUMINAV_LISTEN", "LUMINAV_SURVEY_BEGIN",   "LUMINAV_SURVEY_DRIVER"};
  for (const auto& path : shipped()) {
    for (const Command& command : read_pmd(path).commands) {
      const CommandWords words = split_command(command.exec, [](const std::string&) { return std::nullopt; });
      for (const std::string& variable : words.unset) {
        EXPECT_TRUE(known.contains(variable)) << path << ": " << variable;
      }
      for (const std::string& word : words.words) {
        EXPECT_FALSE(word.starts_with("/")) << path << ": " << word;
      }
    }
  }
}

TEST(ShippedConfigurations, DemoHoldsTheWholeSystemOnOneDeputy) {
  const PmdFile file = read_pmd(LUMINAV_SOURCE_DIR "/launch/demo.pmd");
  std::set<std::string> names;
  for (const Command& command : file.commands) {
    names.insert(command.name);
    EXPECT_EQ(command.deputy, "localhost");
    EXPECT_TRUE(announces_itself(command.exec) || command.group == "recording") << command.name;
  }
  EXPECT_THAT(names, ::testing::IsSupersetOf(
                         {"simulator", "p3dx", "camera", "detector", "localizer", "mapper", "planner", "controller"}));
}

}  // namespace
}  // namespace luminav::launcher
