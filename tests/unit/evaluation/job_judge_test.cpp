#include "tests/evaluation/judge/job_judge.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/process/channels.hpp"
#include "tests/unit/simulator/text_world.hpp"

namespace luminav {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A robot that stands at (3, 3), two jobs that somebody orders, and a job service that says what the test says.
class JobJudgeTest : public ::testing::Test {
 protected:
  static Building building() {
    Building building;
    building.places = {{"here", {3.1, 3.0, 0.0}, false}, {"there", {5.0, 3.0, 0.0}, false}};
    return building;
  }
  static DrawnJobs two_jobs() {
    DrawnJobs drawn;
    drawn.jobs.resize(2);
    drawn.jobs[1].is_to_be_done = false;
    return drawn;
  }
  void SetUp() override {
    say({});
    for (int i = 0; i < 2; ++i) {
      sim_truth_t truth{};
      truth.utime = 1000 + i;
      lcm.publish(channels::kSimTruth, &truth);
      handle();
      status.echo_ids.push_back(1001 + i);
      status.objections.emplace_back();
      status.echo_count = i + 1;
      say({});
    }
  }
  static job_state_t job(std::int64_t id, int state, const std::string& place = "here") {
    job_state_t job{};
    job.id = id;
    job.state = static_cast<std::int8_t>(state);
    job.stops = {place};
    job.stop_count = 1;
    job.sentence = "as it is";
    return job;
  }
  static job_state_t guide(int state, const std::string& sentence) {
    job_state_t guide = job(1001, state);
    guide.kind = job_t::KIND_GUIDE;
    guide.sentence = sentence;
    return guide;
  }
  /// The robot drives ahead while it leads somebody, and the job ends.
  std::vector<std::string> complaints_after_guiding(const VisitorHabit& habit, double seconds, int end,
                                                    const std::string& meanwhile) {
    EXPECT_TRUE(world.add_visitor(habit));
    for (double t = 0.0; t < seconds; t += World::kTick) {
      world.step({0.5, 0.0, true});
      say({guide(State::STATE_DRIVING, meanwhile), job(1002, State::STATE_FAILED)});
    }
    say({guide(end, "as it is"), job(1002, State::STATE_FAILED)});
    return judge.result().wrong;
  }
  void say(std::vector<job_state_t> jobs) {
    status.utime = 1;
    status.jobs = std::move(jobs);
    status.count = static_cast<std::int32_t>(status.jobs.size());
    lcm.publish(channels::kJobStatus, &status);
    handle();
  }
  void handle() {
    while (lcm.handleTimeout(0) > 0) {
    }
  }
  using State = job_state_t;

  lcm::LCM lcm{"memq://"};
  World world{1, exact_truth(map_from_text(hall(20, 10)), {3.0, 3.0, 0.0})};
  JobPeople people{lcm, Scenario{}, two_jobs(), world};
  JobJudge judge{lcm, building(), people, world};
  job_status_t status{};
};

TEST_F(JobJudgeTest, FindsAllRightWhatEndsAsItShould) {
  ASSERT_THAT(people.promised(), ElementsAre(1001, 1002));
  say({job(1001, State::STATE_AT_STOP), job(1002, State::STATE_QUEUED)});
  say({job(1001, State::STATE_DONE), job(1002, State::STATE_QUEUED)});
  say({job(1001, State::STATE_DONE), job(1002, State::STATE_FAILED)});
  const JobsResult result = judge.result();
  EXPECT_THAT(result.wrong, IsEmpty());
  EXPECT_EQ(result.right, 2);
  EXPECT_EQ(JobJudge::failure(result), "");
  EXPECT_TRUE(people.is_finished());
}

TEST_F(JobJudgeTest, TellsOfAJobThatEndsOtherwise) {
  say({job(1001, State::STATE_FAILED), job(1002, State::STATE_DONE)});
  EXPECT_THAT(judge.result().wrong, ElementsAre(HasSubstr("not done: as it is"), HasSubstr("done, but should not be")));
}

TEST_F(JobJudgeTest, TellsOfARobotThatStandsElsewhere) {
  say({job(1001, State::STATE_AT_STOP, "there"), job(1002, State::STATE_FAILED)});
  say({job(1001, State::STATE_DONE, "there"), job(1002, State::STATE_FAILED)});
  EXPECT_THAT(judge.result().wrong, ElementsAre(HasSubstr("said to be at there, was 2.00 m from it")));
}

TEST_F(JobJudgeTest, WantsAGuideToArriveWithItsVisitor) {
  EXPECT_THAT(complaints_after_guiding({}, 6.0, State::STATE_DONE, "leads"), IsEmpty());
}

TEST_F(JobJudgeTest, TellsOfAGuideThatArrivesAlone) {
  EXPECT_THAT(complaints_after_guiding({.speed = 0.01}, 6.0, State::STATE_DONE, "leads"),
              ElementsAre(HasSubstr("done, but its visitor was 4.")));
}

TEST_F(JobJudgeTest, TellsOfAVisitorWhoWasGivenUpAndHadNotTurnedAway) {
  EXPECT_THAT(complaints_after_guiding({.speed = 0.01}, 6.0, State::STATE_FAILED, "goes back for its visitor"),
              ElementsAre(HasSubstr("not done, its visitor was 4.")));
}

TEST_F(JobJudgeTest, WantsWhoTurnedAwayGivenUpAfterGoingBack) {
  EXPECT_THAT(
      complaints_after_guiding({.stops_after = 0.5, .leaves = true}, 6.0, State::STATE_FAILED, "goes back for him"),
      IsEmpty());
}

TEST_F(JobJudgeTest, TellsOfAVisitorForWhomNobodyWentBack) {
  EXPECT_THAT(complaints_after_guiding({.stops_after = 0.5, .leaves = true}, 6.0, State::STATE_FAILED, "leads"),
              ElementsAre(HasSubstr("did not go back")));
}

TEST_F(JobJudgeTest, MissesAJobThatIsGone) {
  say({job(1001, State::STATE_DRIVING), job(1002, State::STATE_FAILED)});
  say({job(1002, State::STATE_FAILED)});
  EXPECT_THAT(JobJudge::failure(judge.result()), HasSubstr("1 jobs lost"));
}

TEST_F(JobJudgeTest, MissesAJobThatWasPromisedAndNeverCame) {
  say({job(1002, State::STATE_FAILED)});
  EXPECT_EQ(judge.result().lost, 1);
}

TEST_F(JobJudgeTest, SeesAJobThatIsDoneTwice) {
  say({job(1001, State::STATE_DONE), job(1002, State::STATE_FAILED)});
  say({job(1001, State::STATE_DRIVING), job(1002, State::STATE_FAILED)});
  say({job(1001, State::STATE_DONE), job(1002, State::STATE_FAILED)});
  EXPECT_EQ(judge.result().doubled, 1);
}

}  // namespace
}  // namespace luminav
