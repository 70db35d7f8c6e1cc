#include "services/jobs/speech/speaker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cerrno>
#include <csignal>
#include <thread>

#include "services/common/configuration/whole_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

using ::testing::HasSubstr;

/// A program in place of espeak-ng, which writes down what it is told.
class SpeakerTest : public testing::Test {
 protected:
  /// `after`: what it does then, as a shell says it.
  std::vector<std::string> program(const std::string& after = "") {
    const auto file = folder_.write("voice", "#!/bin/sh\necho \"$$ $# $1 $2\" >>" + heard_.string() + ".pids\ncat >>" +
                                                 heard_.string() + "\n" + after + "\n");
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    return {file.string(), "-v", "en"};
  }
  [[nodiscard]] std::string heard() const { return std::filesystem::exists(heard_) ? read_whole_file(heard_) : ""; }
  static void finish(Speaker& speaker) {
    do {
      speaker.tick();
      std::this_thread::yield();
    } while (speaker.is_busy());
  }
  void hear(Speaker& speaker, const std::string& sentence) {
    while (heard().find(sentence) == std::string::npos) {
      speaker.tick();
      std::this_thread::yield();
    }
  }

  TemporaryFolder folder_;
  std::filesystem::path heard_ = folder_.path() / "heard";
  std::filesystem::path never_ = folder_.path() / "never";  // a pipe into which nobody writes
};

TEST_F(SpeakerTest, GivesTheSentenceToTheProgramAsData) {
  Speaker speaker(program());
  speaker.say("Hier: $(touch x); `ls` | \"größer\" [[h@'loU]]\n-w /tmp/x");
  finish(speaker);
  EXPECT_EQ(heard(), "Hier: $(touch x); `ls` | \"größer\"   h@'loU   -w /tmp/x\n") << "on one line, without phonemes";
  EXPECT_THAT(read_whole_file(heard_.string() + ".pids"), HasSubstr(" 2 -v en"));
  EXPECT_EQ(speaker.take_complaint(), "");
}

TEST_F(SpeakerTest, SpeaksOneSentenceAtATimeAndTheNewestWins) {
  mkfifo(never_.c_str(), 0600);
  Speaker speaker(program("read -r word <" + never_.string()));
  speaker.say("one");
  hear(speaker, "one");
  speaker.say("two");
  speaker.say("three");
  hear(speaker, "three");
  EXPECT_EQ(heard(), "one\nthree\n");
  EXPECT_EQ(speaker.take_complaint(), "") << "a sentence that is cut short is no fault";
}

TEST_F(SpeakerTest, IsSilentAndSaysSoOnceWhereTheProgramIsMissing) {
  Speaker speaker({"/nonexistent/espeak-ng", "--stdin"});
  for (int i = 0; i < 3; ++i) {
    speaker.say("Hello.");
    speaker.tick();
    EXPECT_FALSE(speaker.is_busy());
    EXPECT_EQ(speaker.take_complaint().empty(), i > 0);
  }
}

TEST_F(SpeakerTest, SaysOnceThatTheProgramFails) {
  Speaker speaker(program("exit 1"));
  speaker.say("Hello.");
  finish(speaker);
  EXPECT_THAT(speaker.take_complaint(), HasSubstr("sound device"));
  speaker.say("Hello again.");
  finish(speaker);
  EXPECT_EQ(heard(), "Hello.\nHello again.\n") << "it is tried again: a device may have been plugged in";
  EXPECT_EQ(speaker.take_complaint(), "");
}

TEST_F(SpeakerTest, EndsWhatIsBeingSpokenWithItself) {
  mkfifo(never_.c_str(), 0600);
  {
    Speaker speaker(program("read -r word <" + never_.string()));
    speaker.say("one");
    hear(speaker, "one");
  }
  const pid_t child = std::stoi(read_whole_file(heard_.string() + ".pids"));
  EXPECT_EQ(kill(child, 0), -1);
  EXPECT_EQ(errno, ESRCH);
}

TEST(Speaker, AsksEspeakToReadItsInput) {
  EXPECT_EQ(espeak_command("de"), (std::vector<std::string>{"espeak-ng", "-v", "de", "-b", "1", "--stdin"}));
}

}  // namespace
}  // namespace luminav
