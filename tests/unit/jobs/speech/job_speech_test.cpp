#include "services/jobs/speech/job_speech.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/jobs/pretended_robot.hpp"

namespace luminav {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A robot, and all that it said.
class SpeakingRobot : public PretendedRobot {
 public:
  explicit SpeakingRobot(SpeechLanguage language = SpeechLanguage::kEnglish) : speech_(language) {}

  void listen(double seconds) {
    for (double t = 0.0; t < seconds - 1e-9; t += 0.2) {
      step();
      if (const std::optional<std::string> sentence = speech_.next(executor)) {
        said.push_back(*sentence);
      }
    }
  }
  void arrive_and_listen() {
    listen(3.0);
    navigation.state = Drive::kArrived;
    listen(0.4);
  }
  std::vector<std::string> said;

 private:
  JobSpeech speech_;
};

TEST(JobSpeech, TellsAVisitorWhereItLeadsHimAndThatItWaits) {
  SpeakingRobot robot;
  robot.moment.world_from_robot = Pose2{};
  robot.add(JobKind::kGuide, {"lab"});
  robot.listen(3.0);
  EXPECT_THAT(robot.said, ElementsAre("Please follow me to lab."));
  robot.moment.driven = 0.2;  // and nobody near
  robot.listen(5.0);
  EXPECT_THAT(robot.said, ElementsAre("Please follow me to lab.", "I am waiting for you."));
}

TEST(JobSpeech, SaysTheTextOfAStopOnce) {
  SpeakingRobot robot;
  JobRequest request;
  request.kind = JobKind::kTour;
  request.stops = {{.place = "lab", .pause = 5.0, .text = "The laboratory."}, {.place = "office"}};
  EXPECT_EQ(robot.ask(request), "");
  robot.arrive_and_listen();
  robot.listen(2.0);
  EXPECT_THAT(robot.said, ElementsAre("The laboratory."));
}

TEST(JobSpeech, AsksToBeLoadedAndForHelp) {
  SpeakingRobot robot;
  robot.add(JobKind::kCarry, {"lab", "office"});
  robot.listen(3.0);
  robot.navigation.state = Drive::kBlocked;
  robot.navigation.cause = "the way is shut";
  robot.listen(1.0);
  ASSERT_EQ(robot.said.size(), 1U);
  EXPECT_EQ(robot.said[0], "I need help. on the way to lab: the way is shut.");
  EXPECT_EQ(robot.say(JobRequest::Action::kAnswer, robot.executor.active()->id, "opened"), "");
  robot.arrive_and_listen();
  EXPECT_THAT(robot.said.back(), HasSubstr("This is lab. Please load me"));
}

TEST(JobSpeech, SpeaksGermanButForWordsOfItsOwn) {
  SpeakingRobot robot(SpeechLanguage::kGerman);
  robot.add(JobKind::kGuide, {"lab"});
  robot.listen(3.0);
  robot.navigation.state = Drive::kBlocked;
  robot.navigation.cause = "the way is shut";
  robot.listen(1.0);
  EXPECT_THAT(robot.said, ElementsAre("Bitte folgen Sie mir zu lab.",
                                      "Ich brauche Hilfe auf dem Weg zu lab. Meine Frage steht auf der Seite."));
}

TEST(JobSpeech, SaysNothingOfADriveWithoutPeople) {
  SpeakingRobot robot;
  robot.add(JobKind::kGo, {"lab"});
  robot.arrive_and_listen();
  robot.add(JobKind::kHome, {});
  robot.listen(3.0);
  EXPECT_THAT(robot.said, IsEmpty());
}

}  // namespace
}  // namespace luminav
