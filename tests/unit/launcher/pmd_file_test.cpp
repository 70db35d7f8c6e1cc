#include "services/launcher/pmd_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/configuration/toml_table.hpp"

namespace luminav::launcher {
namespace {

using ::testing::HasSubstr;

constexpr const char* kMinimal = R"(cmd "a" { exec = "x"; deputy = "d"; })";

std::string error_of(const std::string& text) {
  try {
    parse_pmd(text, "f.pmd");
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "no error";
}

TEST(PmdFile, TakesAnEmptyFile) {
  EXPECT_TRUE(parse_pmd("", "f").commands.empty());
  EXPECT_TRUE(parse_pmd(" \t\r\n# only a comment", "f").scripts.empty());
}

TEST(PmdFile, GivesACommandProcmansDefaults) {
  const Command command = parse_pmd(kMinimal, "f").commands.at(0);
  EXPECT_EQ(command.name, "a");
  EXPECT_EQ(command.exec, "x");
  EXPECT_EQ(command.deputy, "d");
  EXPECT_EQ(command.group, "");
  EXPECT_FALSE(command.auto_respawn);
  EXPECT_EQ(command.stop_signal, 2);
  EXPECT_DOUBLE_EQ(command.stop_time_allowed, 7.0);
}

TEST(PmdFile, ReadsAllAttributes) {
  const PmdFile file = parse_pmd(R"(cmd "a" {
      exec = "p -x"; deputy = "d"; group = "ignored"; auto_respawn = "YES";
      stop_signal = 15; stop_time_allowed = 3; })",
                                 "f");
  const Command& command = file.commands.at(0);
  EXPECT_TRUE(command.auto_respawn);
  EXPECT_EQ(command.stop_signal, 15);
  EXPECT_DOUBLE_EQ(command.stop_time_allowed, 3.0);
  EXPECT_EQ(command.group, "") << "the enclosing group counts";
}

TEST(PmdFile, TakesHostForDeputy) {
  EXPECT_EQ(parse_pmd(R"(cmd "a" { exec = "x"; host = "h"; })", "f").commands.at(0).deputy, "h");
}

TEST(PmdFile, TakesOnlyTrueAndYesForTrue) {
  for (const auto& [word, expected] : std::vector<std::pair<std::string, bool>>{
           {"true", true}, {"True", true}, {"yes", true}, {"false", false}, {"no", false}, {"1", false}, {"", false}}) {
    const std::string text = "cmd \"a\" { exec = \"x\"; deputy = \"d\"; auto_respawn = \"" + word + "\"; }";
    EXPECT_EQ(parse_pmd(text, "f").commands.at(0).auto_respawn, expected) << word;
  }
}

TEST(PmdFile, NamesACommandWithoutNameAfterItsProgram) {
  EXPECT_EQ(parse_pmd(R"(cmd { exec = "/usr/bin/tool -v"; deputy = "d"; })", "f").commands.at(0).name, "tool");
}

TEST(PmdFile, NestsGroupsAndMergesThoseOfOneName) {
  const PmdFile file = parse_pmd(R"(
    group "outer" {
      cmd "a" { exec = "x"; deputy = "d"; }
      group "inner" { cmd "b" { exec = "x"; deputy = "d"; } }
    }
    group "outer" { cmd "c" { exec = "x"; deputy = "d"; } group "empty" { } }
    script "s" { start group "outer/inner"; stop group "outer/empty"; })",
                                 "f");
  EXPECT_EQ(file.find_command("a")->group, "outer");
  EXPECT_EQ(file.find_command("b")->group, "outer/inner");
  EXPECT_EQ(file.find_command("c")->group, "outer");
  EXPECT_TRUE(file.has_group("outer"));
  EXPECT_TRUE(is_in_group("outer/inner", "outer"));
  EXPECT_FALSE(is_in_group("outer2", "outer"));
  EXPECT_FALSE(is_in_group("outer", "outer/inner"));
}

TEST(PmdFile, ResolvesEscapesInStrings) {
  EXPECT_EQ(parse_pmd(R"(cmd "a" { exec = "t\tn\nr\rq\"b\\x\x"; deputy = "d"; })", "f").commands.at(0).exec,
            "t\tn\nr\rq\"b\\xx");
}

TEST(PmdFile, ReadsEveryKindOfAction) {
  const PmdFile file = parse_pmd(std::string(kMinimal) + R"(
    group "g" { }
    script "other" { }
    script "s" {
      start everything;
      stop cmd "a" wait "stopped";
      restart group "g" wait "running";
      wait ms 250;
      wait cmd "a" status "running";
      wait group "g" status "stopped";
      run_script "other";
    })",
                                 "f");
  const std::vector<Action>& actions = file.find_script("s")->actions;
  ASSERT_EQ(actions.size(), 7U);
  EXPECT_EQ(actions[0].kind, Action::Kind::kStart);
  EXPECT_EQ(actions[0].target.kind, Target::Kind::kEverything);
  EXPECT_FALSE(actions[0].await.has_value());
  EXPECT_EQ(actions[1].kind, Action::Kind::kStop);
  EXPECT_EQ(actions[1].target.name, "a");
  EXPECT_EQ(actions[1].await, AwaitedStatus::kStopped);
  EXPECT_EQ(actions[2].kind, Action::Kind::kRestart);
  EXPECT_EQ(actions[2].target.kind, Target::Kind::kGroup);
  EXPECT_EQ(actions[2].await, AwaitedStatus::kRunning);
  EXPECT_EQ(actions[3].kind, Action::Kind::kWaitTime);
  EXPECT_DOUBLE_EQ(actions[3].seconds, 0.25);
  EXPECT_EQ(actions[4].kind, Action::Kind::kWaitStatus);
  EXPECT_EQ(actions[4].await, AwaitedStatus::kRunning);
  EXPECT_EQ(actions[5].target.kind, Target::Kind::kGroup);
  EXPECT_EQ(actions[5].await, AwaitedStatus::kStopped);
  EXPECT_EQ(actions[6].kind, Action::Kind::kRunScript);
  EXPECT_EQ(actions[6].script, "other");
}

struct WrongFile {
  const char* text;
  const char* line;
  const char* found;
  const char* expected;
};

TEST(PmdFile, SaysFileAndLineAndWhatWasExpected) {
  const std::vector<WrongFile> table = {
      {"\nbla", "f.pmd:2:", "'bla'", "'cmd', 'group', 'script'"},
      {"?", "f.pmd:1:", "'?'", "expected a word"},
      {"\x01", "f.pmd:1:", "byte 0x01", "expected a word"},
      {"cmd \"a", "f.pmd:1:", "\"a...", "expected \" on the same line"},
      {"cmd \"a\n\"", "f.pmd:1:", "\"a...", "expected \" on the same line"},
      {"cmd \"a\\", "f.pmd:1:", "\"a...", "expected \" on the same line"},
      {"cmd a {", "f.pmd:1:", "'a'", "as a \"string\""},
      {"cmd \"a\"\n;", "f.pmd:2:", "';'", "'{' after the command's name"},
      {"cmd \"a/b\" {", "f.pmd:1:", "\"a/b\"", "without '/'"},
      {"cmd \"\" {", "f.pmd:1:", "\"\"", "not empty"},
      {"cmd \"a\" {\n\nexec", "f.pmd:3:", "end of file", "'=' after exec"},
      {"cmd \"a\" { exec = 3;", "f.pmd:1:", "'3'", "the value of exec as a \"string\""},
      {"cmd \"a\" { exec = \"x\" }", "f.pmd:1:", "'}'", "';' after the value of exec"},
      {"cmd \"a\" { colour = \"x\"; }", "f.pmd:1:", "'colour'", "one of exec, deputy"},
      {"cmd \"a\" { 7 }", "f.pmd:1:", "'7'", "an attribute"},
      {"cmd \"a\" { exec = \"x\"; exec = \"y\"; }", "f.pmd:1:", "'exec'", "twice"},
      {"cmd \"a\" { exec = \"x\"; deputy = \"\"; }", "f.pmd:1:", "\"\"", "the id of a deputy"},
      {"cmd \"a\" { deputy = \"d\"; }", "f.pmd:1:", "no exec", "expected exec ="},
      {"cmd \"a\" { exec = \"x\"; }", "f.pmd:1:", "no deputy", "expected deputy ="},
      {"cmd \"a\" { stop_signal = 0; }", "f.pmd:1:", "0", "a signal's number, 1 to 64"},
      {"cmd \"a\" { stop_signal = 65; }", "f.pmd:1:", "65", "a signal's number, 1 to 64"},
      {"cmd \"a\" { stop_time_allowed = 0; }", "f.pmd:1:", "0", "seconds"},
      {"cmd \"a\" { stop_time_allowed = 99999999999; }", "f.pmd:1:", "number above", "2147483647"},
      {"cmd \"a\" { stop_time_allowed = \"3\"; }", "f.pmd:1:", "\"3\"", "seconds"},
      {"group g {", "f.pmd:1:", "'g'", "the group's name"},
      {"group \"g\" }", "f.pmd:1:", "'}'", "'{' after the group's name"},
      {"group \"g/h\" {", "f.pmd:1:", "\"g/h\"", "without '/'"},
      {"group \"g\" {\nscript \"s\" { } }", "f.pmd:2:", "'script'", "ends group \"g\" of line 1"},
      {"group \"g\" {", "f.pmd:1:", "end of file", "ends group \"g\" of line 1"},
      {"script s {", "f.pmd:1:", "'s'", "the script's name"},
      {"script \"s\" {\n dance; }", "f.pmd:2:", "'dance'", "an action"},
      {"script \"s\" { start; }", "f.pmd:1:", "';'", "'everything', 'cmd' or 'group'"},
      {"script \"s\" { start everything }", "f.pmd:1:", "'}'", "';' after an action"},
      {"script \"s\" { start cmd a; }", "f.pmd:1:", "'a'", "a name as a \"string\""},
      {"script \"s\" { start everything wait \"ready\"; }", "f.pmd:1:", "\"ready\"", "\"running\" or \"stopped\""},
      {"script \"s\" { wait everything status \"running\"; }", "f.pmd:1:", "'everything'", "'ms', 'cmd' or 'group'"},
      {"script \"s\" { wait ms \"3\"; }", "f.pmd:1:", "\"3\"", "milliseconds"},
      {"script \"s\" { wait cmd \"a\" \"running\"; }", "f.pmd:1:", "\"running\"", "'status'"},
      {"script \"s\" { run_script s; }", "f.pmd:1:", "'s'", "the script's name"},
      {"script \"s\" {\nstart cmd \"a\"; }", "f.pmd:2:", "\"a\"", "a command of this file"},
      {"script \"s\" { start group \"a\"; }", "f.pmd:1:", "\"a\"", "a group of this file"},
      {"script \"s\" { run_script \"t\"; }", "f.pmd:1:", "\"t\"", "a script of this file"},
  };
  for (const WrongFile& wrong : table) {
    const std::string error = error_of(wrong.text);
    EXPECT_THAT(error, HasSubstr(wrong.line)) << wrong.text;
    EXPECT_THAT(error, HasSubstr(wrong.found)) << wrong.text;
    EXPECT_THAT(error, HasSubstr(wrong.expected)) << wrong.text;
  }
}

TEST(PmdFile, RefusesWhatIsThereTwice) {
  EXPECT_THAT(error_of(std::string(kMinimal) + "\n" + kMinimal), HasSubstr("f.pmd:2: command \"a\" stands in line 1"));
  EXPECT_THAT(error_of("script \"s\" { }\nscript \"s\" { }"), HasSubstr("f.pmd:2: script \"s\" stands in line 1"));
}

TEST(PmdFile, RefusesScriptsThatRunEachOtherInACircle) {
  EXPECT_THAT(error_of("script \"s\" { run_script \"s\"; }"), HasSubstr("s -> s"));
  EXPECT_THAT(error_of("script \"s\" { run_script \"t\"; } script \"t\" { run_script \"s\"; }"),
              HasSubstr("s -> t -> s"));
  EXPECT_EQ(error_of("script \"s\" { run_script \"t\"; run_script \"t\"; } script \"t\" { }"), "no error");
}

std::string scripts_that_run_the_next_twice(int levels) {
  std::string text;
  for (int i = 1; i < levels; ++i) {
    text += "script \"s" + std::to_string(i) + "\" { run_script \"s" + std::to_string(i + 1) + "\"; run_script \"s" +
            std::to_string(i + 1) + "\"; }\n";
  }
  return text + "script \"s" + std::to_string(levels) + "\" { }";
}

TEST(PmdFile, LimitsWhatScriptsThatRunScriptsComeTo) {
  EXPECT_EQ(error_of(scripts_that_run_the_next_twice(10)), "no error");
  EXPECT_THAT(error_of(scripts_that_run_the_next_twice(40)), HasSubstr("comes to more than 10000 actions"));
  EXPECT_THAT(error_of(scripts_that_run_the_next_twice(80)), HasSubstr("scripts run each other deeper than 50"));
}

TEST(PmdFile, SurvivesEveryTruncationAndFlippedByte) {
  const std::string text = std::string(kMinimal) + "group \"g\" { } script \"s\" { start cmd \"a\" wait \"running\"; }";
  for (std::size_t length = 0; length < text.size(); ++length) {
    error_of(text.substr(0, length));
    for (const char byte : {'\0', '"', '{', '}', ';', '\\', '\xff'}) {
      std::string damaged = text;
      damaged[length] = byte;
      error_of(damaged);
    }
  }
  EXPECT_THAT(error_of([] {
                std::string deep;
                for (int i = 0; i < 1000; ++i) {
                  deep += "group \"g\" {";
                }
                return deep;
              }()),
              HasSubstr("nested deeper"));
}

TEST(PmdFile, SaysThatAFileCannotBeRead) {
  EXPECT_THROW(read_pmd("/no/such/file.pmd"), ConfigurationError);
  EXPECT_THROW(read_pmd("/tmp"), ConfigurationError);
}

}  // namespace
}  // namespace luminav::launcher
