#include "services/common/configuration/toml_edit.hpp"

#include <gtest/gtest.h>

#include "services/common/configuration/toml_lines.hpp"
#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

TEST(TomlEdit, SetsKeysInTheirPlaceAndLeavesTheRest) {
  EXPECT_EQ(with_keys_set("[camera]\nz = 1.0\nfx = 600\n\n[p3dx]\nz = 2\n", "camera",
                          {{"z", "1.5  # measured"}, {"yaw", "0.1"}}),
            "[camera]\nz = 1.5  # measured\nfx = 600\nyaw = 0.1\n\n[p3dx]\nz = 2\n");
}

TEST(TomlEdit, MakesATableThatIsMissing) {
  EXPECT_EQ(with_keys_set("name = \"p3dx\"\n", "localizer.errors", {{"yaw", "0.1"}}),
            "name = \"p3dx\"\n\n[localizer.errors]\nyaw = 0.1\n");
}

TEST(TomlEdit, KnowsAHeaderWithBlanksAndAComment) {
  EXPECT_EQ(with_keys_set("[ camera ]  # on the pole\nz = 1.0\n", "camera", {{"z", "1.5"}}),
            "[ camera ]  # on the pole\nz = 1.5\n");
  EXPECT_EQ(with_keys_set("[localizer . errors]\nyaw = 1\n", "localizer.errors", {{"yaw", "0.1"}}),
            "[localizer . errors]\nyaw = 0.1\n");
}

TEST(TomlEdit, KeepsTheCommentOfALineAndThoseBeforeTheNextTable) {
  EXPECT_EQ(
      with_keys_set("[camera]\nz = 1.0  # by tape\n\n# the base\n[p3dx]\n", "camera", {{"z", "1.5"}, {"yaw", "0"}}),
      "[camera]\nz = 1.5  # by tape\nyaw = 0\n\n# the base\n[p3dx]\n");
}

TEST(TomlEdit, TakesARowOfAnArrayForNoHeader) {
  EXPECT_EQ(with_keys_set("[camera]\nk = [\n[1, 2],\n[3, 4]]\nz = 1\n", "camera", {{"k", "[]"}, {"z", "2"}}),
            "[camera]\nk = []\nz = 2\n");
}

TEST(TomlLines, TakesWhatAStringHoldsForNoCommentAndNoList) {
  TomlLines lines("[zone]\nname = \"room #3 [\"  # old\nspeed = 0.2\n");
  lines.set_key(lines.find_table("zone"), "name", "\"room #4\"");
  lines.erase_key(lines.find_table("zone"), "speed");
  lines.erase_key(lines.find_table("zone"), "direction");
  EXPECT_EQ(lines.text(), "[zone]\nname = \"room #4\"  # old\n");
}

TEST(TomlLines, ErasesATableAndNotTheCommentOfTheNext) {
  TomlLines lines("[[fixture]]\nid = 1\n\n# by the door\n[[fixture]]\nid = 2\n");
  lines.erase(lines.table_at(0));
  EXPECT_EQ(lines.text(), "\n# by the door\n[[fixture]]\nid = 2\n");
  EXPECT_EQ(lines.find_table("fixture").begin, lines.size()) << "one of many has no name of its own";
}

TEST(TomlEdit, RefusesWhatWouldNotBeTomlAnyMore) {
  for (const char* text : {"camera.z = 1.0\n", "camera = {z = 1.0}\n"}) {
    try {
      with_keys_set(text, "camera", {{"z", "1.5"}});
      FAIL() << text;
    } catch (const ConfigurationError& error) {
      EXPECT_NE(std::string(error.what()).find("table [camera] cannot be edited"), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(with_keys_set("[localizer]\nerrors = {yaw = 1}\n", "localizer.errors", {{"yaw", "2"}}),
               ConfigurationError);
}

}  // namespace
}  // namespace luminav
