#include "services/launcher/command_words.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <stdexcept>

namespace luminav::launcher {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

CommandWords split(const std::string& line) {
  return split_command(line, [](const std::string& name) -> std::optional<std::string> {
    const std::map<std::string, std::string> environment = {{"HOME", "/home/x"}, {"TWO", "a b"}, {"EMPTY", ""}};
    const auto found = environment.find(name);
    return found == environment.end() ? std::nullopt : std::optional(found->second);
  });
}

TEST(CommandWords, SplitsAtBlanks) {
  EXPECT_THAT(split("  ls \t -l  x ").words, ElementsAre("ls", "-l", "x"));
}

TEST(CommandWords, TakesWhatFollowsABackslashAsItIsInQuotesToo) {
  EXPECT_THAT(split(R"(a 'b c' "d e" f\ g)").words, ElementsAre("a", "b c", "d e", "f g"));
  EXPECT_THAT(split(R"(a "x\"y\\z\n" 'x\y' b"c"'d')").words, ElementsAre("a", R"(x"y\zn)", "xy", "bcd"));
  EXPECT_THAT(split(R"(a 'it\'s' 'x\\y')").words, ElementsAre("a", "it's", R"(x\y)"));
  EXPECT_THAT(split(R"(a '' "")").words, ElementsAre("a", "", ""));
}

TEST(CommandWords, TakesLeadingAssignmentsAsEnvironmentWithoutExpandingThem) {
  const CommandWords command = split("A=1 B_2=$HOME EMPTY= prog C=3");
  EXPECT_THAT(command.environment, ElementsAre(Pair("A", "1"), Pair("B_2", "$HOME"), Pair("EMPTY", "")));
  EXPECT_THAT(command.words, ElementsAre("prog", "C=3"));
  EXPECT_THAT(split("2A=1 x").words, ElementsAre("2A=1", "x")) << "no name begins with a digit";
}

TEST(CommandWords, ExpandsVariablesInSingleQuotesTooAndNeverSplitsThem) {
  EXPECT_THAT(split("$HOME/bin/x ${HOME}y '$TWO' $EMPTY").words, ElementsAre("/home/x/bin/x", "/home/xy", "a b", ""));
}

TEST(CommandWords, LeavesUnsetVariablesAsWrittenAndNamesThem) {
  const CommandWords command = split("x $NOT ${NOR}/y");
  EXPECT_THAT(command.words, ElementsAre("x", "$NOT", "${NOR}/y"));
  EXPECT_THAT(command.unset, ElementsAre("NOT", "NOR"));
}

TEST(CommandWords, LeavesDollarsAloneThatNameNothing) {
  EXPECT_THAT(split("x $ $1 ${HOME ${} a$").words, ElementsAre("x", "$", "$1", "${HOME", "${}", "a$"));
}

TEST(CommandWords, IsNoShell) {
  EXPECT_THAT(split("a | b > c; ~").words, ElementsAre("a", "|", "b", ">", "c;", "~"));
}

TEST(CommandWords, RefusesOpenQuotesAndLinesWithoutProgram) {
  EXPECT_THROW(split("a 'b"), std::invalid_argument);
  EXPECT_THROW(split("a \"b"), std::invalid_argument);
  EXPECT_THROW(split("a b\\"), std::invalid_argument);
  EXPECT_THROW(split(""), std::invalid_argument);
  EXPECT_THROW(split("A=1"), std::invalid_argument);
}

TEST(CommandWords, KnowsTheProcessBehindACommand) {
  EXPECT_EQ(program_name("$LUMINAV_BIN/localizer --robot x"), "localizer");
  EXPECT_EQ(program_name("NICE=1 /usr/bin/luminav-camera"), "camera");
  EXPECT_EQ(program_name("'"), "");
  EXPECT_TRUE(announces_itself("A=1 $LUMINAV_BIN/localizer"));
  EXPECT_TRUE(announces_itself("/usr/bin/luminav-localizer"));
  EXPECT_FALSE(announces_itself("lcm-logger -i x"));
}

}  // namespace
}  // namespace luminav::launcher
