#include "services/jobs/job_executor.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/jobs/pretended_robot.hpp"

namespace luminav {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using Action = JobRequest::Action;

TEST(JobExecutor, DrivesAStoredTourThatWasChangedMeanwhileFromItsNextStartOn) {
  PretendedRobot robot;
  JobRequest request;
  request.kind = JobKind::kTour;
  request.tour = "morning";
  EXPECT_EQ(robot.ask(request), "");
  JobsFile jobs = PretendedRobot::site().jobs;
  jobs.tours = {{.name = "evening", .stops = {{.place = "dock", .text = "Good night."}}}};
  robot.executor.set_jobs(jobs);
  EXPECT_EQ(robot.executor.table().jobs[0].stops.size(), 2U) << "one that was taken stays as it was";
  EXPECT_THAT(robot.ask(request), HasSubstr("no tour \"morning\" in laboratory; known: evening"));
  request.tour = "evening";
  EXPECT_EQ(robot.ask(request), "");
  EXPECT_EQ(robot.executor.table().jobs[1].stops[0].text, "Good night.");
}

TEST(JobExecutor, DrivesToAPlaceAndSaysThatItIsDone) {
  PretendedRobot robot;
  const std::int64_t job = robot.add(JobKind::kGo, {"lab"});
  robot.run(5.0);
  EXPECT_EQ(robot.job(job).state, JobState::kDriving);
  EXPECT_THAT(robot.job(job).sentence, HasSubstr("drives to lab"));
  robot.arrive();
  robot.run(1.0);
  EXPECT_EQ(robot.job(job).state, JobState::kDone);
  EXPECT_THAT(robot.goals, ElementsAre("lab"));
  EXPECT_EQ(robot.executor.table().open_goal, 0);
}

TEST(JobExecutor, CarriesWhenItIsLoadedAndEndsWhenItIsUnloaded) {
  PretendedRobot robot;
  const std::int64_t job = robot.add(JobKind::kCarry, {"lab", "office"});
  robot.arrive();
  robot.run(100.0);
  EXPECT_EQ(robot.job(job).state, JobState::kAtStop);
  EXPECT_THAT(robot.goals, ElementsAre("lab")) << "nobody has loaded it";
  EXPECT_EQ(robot.say(Action::kConfirm, job, "loaded"), "");
  robot.arrive();
  robot.run(10.0);
  EXPECT_EQ(robot.job(job).state, JobState::kAtStop);
  EXPECT_EQ(robot.say(Action::kConfirm, job), "") << "without a word it is whatever it waits for";
  EXPECT_EQ(robot.job(job).state, JobState::kDone);
  EXPECT_THAT(robot.goals, ElementsAre("lab", "office"));
}

TEST(JobExecutor, TakesAConfirmationForTheJobThatWaitsAlone) {
  PretendedRobot robot;
  const std::int64_t first = robot.add(JobKind::kCarry, {"lab", "office"});
  const std::int64_t second = robot.add(JobKind::kCarry, {"office", "lab"});
  robot.arrive();
  EXPECT_THAT(robot.say(Action::kConfirm, second, "loaded"),
              HasSubstr(fmt::format("job {} waits for \"loaded\"", first)));
  EXPECT_THAT(robot.say(Action::kConfirm, first, "unloaded"), HasSubstr("waits for \"loaded\", not for \"unloaded\""));
  EXPECT_THAT(robot.say(Action::kConfirm, 77, "loaded"), HasSubstr("there is no job 77"));
  EXPECT_EQ(robot.job(first).state, JobState::kAtStop);
  EXPECT_EQ(robot.job(second).state, JobState::kQueued);
}

TEST(JobExecutor, DoesNotDriveWhileSomebodyHandlesIt) {
  PretendedRobot robot;
  const std::int64_t job = robot.add(JobKind::kCarry, {"lab", "office"});
  robot.arrive();
  robot.moment.handled = "a bumper is pressed";
  robot.step();
  EXPECT_EQ(robot.say(Action::kConfirm, job, "loaded"), "");
  robot.run(20.0);
  EXPECT_THAT(robot.job(job).sentence, HasSubstr("a bumper is pressed"));
  EXPECT_THAT(robot.goals, SizeIs(1));
  robot.moment.handled.clear();
  robot.run(1.0);
  EXPECT_THAT(robot.goals, SizeIs(1)) << "a hand that let go may come back";
  robot.run(2.0);
  EXPECT_THAT(robot.goals, SizeIs(2));
}

struct TimeoutCase {
  TimeoutPolicy policy;
  JobState after;
};
TEST(JobExecutor, ActsByItsPolicyWhenNobodyLoads) {
  for (const TimeoutCase& expected :
       {TimeoutCase{TimeoutPolicy::kAsk, JobState::kAsking}, TimeoutCase{TimeoutPolicy::kGiveUp, JobState::kFailed},
        TimeoutCase{TimeoutPolicy::kGoOn, JobState::kDriving}}) {
    JobParams params;
    params.handover_timeout = 60.0;
    PretendedRobot robot(params);
    JobRequest request;
    request.id = 5;
    request.kind = JobKind::kCarry;
    request.stops = {{.place = "lab"}, {.place = "office"}};
    request.on_timeout = expected.policy;
    ASSERT_EQ(robot.ask(request), "");
    robot.arrive();
    robot.run(59.0);
    EXPECT_EQ(robot.job(5).state, JobState::kAtStop);
    robot.run(2.0);
    EXPECT_EQ(robot.job(5).state, expected.after);
  }
}

TEST(JobExecutor, AsksWhatABlockedDriveNeedsAndTriesAgainWhenItIsAnswered) {
  PretendedRobot robot;
  const std::int64_t job = robot.add(JobKind::kGo, {"lab"});
  robot.end_drive(Drive::kBlocked, "door 3 is shut");
  ASSERT_EQ(robot.job(job).state, JobState::kAsking);
  EXPECT_EQ(robot.job(job).question->text, "on the way to lab: door 3 is shut");
  EXPECT_THAT(robot.job(job).question->answers, ElementsAre("opened", "give up"));
  EXPECT_THAT(robot.say(Action::kAnswer, job, "perhaps"), HasSubstr("say one of: opened, give up"));
  robot.run(30.0);
  EXPECT_THAT(robot.goals, SizeIs(1)) << "it stands until somebody answers";
  EXPECT_EQ(robot.say(Action::kAnswer, job, "opened"), "");
  robot.arrive();
  robot.run(1.0);
  EXPECT_EQ(robot.job(job).state, JobState::kDone);
  EXPECT_THAT(robot.goals, ElementsAre("lab", "lab"));
  EXPECT_THAT(robot.say(Action::kAnswer, job, "opened"), HasSubstr("is over"));
}

TEST(JobExecutor, GivesUpAQuestionThatNobodyAnswersAndTakesTheNextJob) {
  JobParams params;
  params.question_timeout = 60.0;
  PretendedRobot robot(params);
  const std::int64_t job = robot.add(JobKind::kGo, {"lab"});
  const std::int64_t next = robot.add(JobKind::kGo, {"office"});
  robot.end_drive(Drive::kStuck, "no progress");
  robot.run(62.0);
  EXPECT_EQ(robot.job(job).state, JobState::kFailed);
  EXPECT_THAT(robot.job(job).sentence, HasSubstr("nobody answered for 1 min: on the way to lab: no progress"));
  EXPECT_EQ(robot.job(next).state, JobState::kDriving);
}

TEST(JobExecutor, LeavesAStopOfATourOutWhenToldSo) {
  PretendedRobot robot;
  const std::int64_t job = robot.add(JobKind::kTour, {"lab", "office"});
  robot.end_drive(Drive::kNoPath, "no way");
  EXPECT_THAT(robot.job(job).question->answers, ElementsAre("try again", "leave out", "give up"));
  EXPECT_EQ(robot.say(Action::kAnswer, job, "leave out"), "");
  robot.arrive();
  robot.run(1.0);
  EXPECT_EQ(robot.job(job).state, JobState::kDone);
  EXPECT_THAT(robot.goals, ElementsAre("lab", "office"));
}

TEST(JobExecutor, StaysAtTheStopsOfATourAsLongAsTheyWant) {
  PretendedRobot robot;
  JobRequest request;
  request.id = 5;
  request.kind = JobKind::kTour;
  request.tour = "morning";
  ASSERT_EQ(robot.ask(request), "");
  robot.arrive();
  robot.run(4.0);
  EXPECT_EQ(robot.job(5).state, JobState::kAtStop);
  robot.run(2.0);
  EXPECT_EQ(robot.job(5).state, JobState::kDriving);
  EXPECT_EQ(robot.job(5).stop, 1U);
}

TEST(JobExecutor, CancelsTheDriveOfACancelledJobUntilThePlannerObeys) {
  PretendedRobot robot;
  const std::int64_t job = robot.add(JobKind::kGo, {"lab"});
  robot.run(3.0);
  robot.is_deaf = true;
  EXPECT_EQ(robot.say(Action::kCancel, job), "");
  EXPECT_EQ(robot.job(job).state, JobState::kCancelled);
  robot.run(5.0);
  ASSERT_TRUE(robot.executor.goal());
  EXPECT_EQ(robot.executor.goal()->action, DriveAction::kCancel);
  EXPECT_NE(robot.executor.table().open_goal, 0);
  robot.is_deaf = false;
  robot.run(1.0);
  EXPECT_EQ(robot.navigation.state, Drive::kCancelled);
  EXPECT_FALSE(robot.executor.goal());
  EXPECT_EQ(robot.executor.table().open_goal, 0);
}

TEST(JobExecutor, AsksBeforeItTakesTheRobotBackFromSomebodyElse) {
  PretendedRobot robot;
  const std::int64_t job = robot.add(JobKind::kGo, {"lab"});
  robot.run(3.0);
  robot.navigation = {robot.navigation.goal_id + 50, Drive::kUnderWay, "", DriveTarget{"", {4.0, 4.0, 0.0}}, 3.0};
  robot.run(1.0);
  EXPECT_EQ(robot.job(job).state, JobState::kAsking);
  EXPECT_THAT(robot.job(job).question->answers, ElementsAre("go on", "give up"));
  EXPECT_FALSE(robot.executor.goal());
  EXPECT_EQ(robot.say(Action::kAnswer, job, "go on"), "");
  robot.run(1.0);
  EXPECT_THAT(robot.goals, ElementsAre("lab", "lab"));
  EXPECT_EQ(robot.job(job).state, JobState::kDriving);
}

TEST(JobExecutor, GoesOnWhenAPausedDriveIsResumedUnderAnotherId) {
  PretendedRobot robot;
  const std::int64_t job = robot.add(JobKind::kGo, {"lab"});
  robot.run(3.0);
  robot.navigation.goal_id += 7;
  robot.navigation.state = Drive::kPaused;
  robot.run(60.0);
  EXPECT_THAT(robot.job(job).sentence, HasSubstr("paused"));
  robot.navigation.goal_id += 7;
  robot.navigation.state = Drive::kUnderWay;
  robot.run(1.0);
  EXPECT_EQ(robot.job(job).state, JobState::kDriving);
  robot.arrive();
  robot.run(1.0);
  EXPECT_EQ(robot.job(job).state, JobState::kDone);
}

TEST(JobExecutor, SendsTheGoalAnewToAPlannerThatForgotIt) {
  PretendedRobot robot;
  const std::int64_t job = robot.add(JobKind::kGo, {"lab"});
  robot.run(3.0);
  robot.navigation = {};
  robot.run(1.0);
  EXPECT_THAT(robot.goals, ElementsAre("lab", "lab"));
  EXPECT_EQ(robot.job(job).state, JobState::kDriving);
}

TEST(JobExecutor, KnowsThePlacesThatTheBuildingHasNow) {
  PretendedRobot robot;
  EXPECT_EQ(robot.add(JobKind::kGo, {"coffee"}), 0);
  std::vector<Place> places = PretendedRobot::site().places;
  places.push_back({"coffee", {3.0, 3.0, 0.0}, false});
  robot.executor.set_places(places);
  EXPECT_NE(robot.add(JobKind::kGo, {"coffee"}), 0);
  robot.run(5.0);
  EXPECT_THAT(robot.goals, ElementsAre("coffee"));
}

TEST(JobExecutor, FailsAJobWhosePlaceWasRenamed) {
  PretendedRobot before;
  const std::int64_t job = before.add(JobKind::kGo, {"lab"});
  JobSite site = PretendedRobot::site();
  site.places[0].name = "laboratory";
  PretendedRobot robot({}, site);
  robot.executor.load(before.executor.table());
  robot.run(1.0);
  EXPECT_EQ(robot.job(job).state, JobState::kFailed);
  EXPECT_EQ(robot.job(job).sentence, "laboratory has no place \"lab\" any more");
  EXPECT_THAT(robot.goals, IsEmpty());
}

TEST(JobExecutor, RefusesWhatCannotBeDoneInOneSentence) {
  PretendedRobot robot;
  const auto objection = [&](JobKind kind, std::vector<JobStop> stops, int priority = 0, const std::string& tour = "") {
    JobRequest request;
    request.kind = kind;
    request.stops = std::move(stops);
    request.priority = priority;
    request.tour = tour;
    return robot.ask(request);
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(objection(JobKind::kGo, {{.place = "kitchen"}}),
              HasSubstr("no place \"kitchen\" in laboratory; known: lab,"));
  EXPECT_THAT(objection(JobKind::kCarry, {{.place = "lab"}}), HasSubstr("has 2 stops, not 1"));
  EXPECT_THAT(objection(JobKind::kTour, {}), HasSubstr("has 1 to 20 stops, not 0"));
  EXPECT_THAT(objection(JobKind::kTour, {}, 0, "evening"),
              HasSubstr("no tour \"evening\" in laboratory; known: morning"));
  EXPECT_THAT(objection(JobKind::kGo, {{.place = "lab"}}, 101), HasSubstr("must be 0 to 100"));
  EXPECT_THAT(objection(JobKind::kGo, {{.pose = {kNan, 0.0, 0.0}}}), HasSubstr("impossibly far"));
  EXPECT_THAT(objection(JobKind::kGo, {{.pose = {1e9, 0.0, 0.0}}}), HasSubstr("impossibly far"));
  EXPECT_THAT(objection(JobKind::kTour, {{.place = "lab", .text = std::string(201, 'x')}}), HasSubstr("200 bytes"));
  EXPECT_THAT(robot.executor.table().jobs, IsEmpty());
}

TEST(JobExecutor, KeepsTheDriveWhenTheClockJumps) {
  PretendedRobot robot;
  const std::int64_t job = robot.add(JobKind::kCarry, {"lab", "office"});
  robot.arrive();
  robot.moment.utime += 86'400'000'000;  // a day ahead
  robot.run(1.0);
  EXPECT_EQ(robot.job(job).state, JobState::kAtStop) << "a jump is no time that passes";
  robot.moment.utime -= 3 * 86'400'000'000;
  EXPECT_EQ(robot.say(Action::kConfirm, job, "loaded"), "");
  robot.run(1.0);
  EXPECT_THAT(robot.goals, ElementsAre("lab", "office")) << "ids grow, whatever the clock shows";
}

TEST(JobExecutor, DrivesHomeWhenTheBatteryIsLowAndGoesOnWhenItIsCharged) {
  PretendedRobot robot;
  const std::int64_t job = robot.add(JobKind::kGo, {"lab"});
  robot.run(3.0);
  robot.moment.voltage = 11.0;
  robot.run(60.0);
  EXPECT_EQ(robot.job(job).state, JobState::kQueued);
  EXPECT_THAT(robot.goals, ElementsAre("lab", "")) << "to the point before the dock";
  robot.arrive();
  robot.arrive();
  EXPECT_THAT(robot.goals, ElementsAre("lab", "", "dock"));
  robot.moment.voltage = 13.0;
  robot.moment.charger = Charger::kCharges;
  robot.run(2.0);
  const Job& home = robot.executor.table().jobs.back();
  EXPECT_EQ(home.kind, JobKind::kHome);
  EXPECT_EQ(home.state, JobState::kDone);
  EXPECT_THAT(home.sentence, HasSubstr("charges at 13.0 V"));
  EXPECT_THAT(robot.job(job).sentence, HasSubstr("the battery is charged first"));
  robot.run(3600.0);
  EXPECT_EQ(robot.job(job).state, JobState::kQueued) << "13 V are the charger's, not the battery's";
  robot.moment.charger = Charger::kHasCharged;
  robot.run(5.0);
  EXPECT_EQ(robot.job(job).state, JobState::kDriving);
  EXPECT_EQ(robot.goals.back(), "lab");
}

TEST(JobExecutor, AsksAPersonAfterThreeTriesToCharge) {
  PretendedRobot robot;
  const std::int64_t job = robot.add(JobKind::kHome, {});
  robot.moment.voltage = 12.0;
  robot.moment.charger = Charger::kCharges;  // but the voltage does not rise
  robot.run(1.0);
  for (int attempt = 0; attempt < 3; ++attempt) {
    EXPECT_EQ(robot.job(job).state, JobState::kDriving);
    robot.arrive();
    robot.arrive();
    robot.run(31.0);
  }
  ASSERT_EQ(robot.job(job).state, JobState::kAsking);
  EXPECT_THAT(robot.job(job).question->text, HasSubstr("after 3 tries and does not charge: the charger is heard"));
  EXPECT_THAT(robot.goals, SizeIs(6));
}

TEST(JobExecutor, FindsItsWayHomeWithAFullQueueToo) {
  PretendedRobot robot;
  for (std::size_t i = 0; i < JobQueue::kMaxWaiting; ++i) {
    ASSERT_NE(robot.add(JobKind::kGo, {"lab"}), 0);
  }
  robot.run(3.0);
  robot.moment.voltage = 11.0;
  robot.run(60.0);
  EXPECT_THAT(robot.goals, ElementsAre("lab", ""));
}

TEST(JobExecutor, SaysWhenThePlannerIsSilent) {
  PretendedRobot robot;
  const std::int64_t job = robot.add(JobKind::kGo, {"lab"});
  robot.run(3.0);
  for (int i = 0; i < 40; ++i) {
    robot.moment.utime += 200'000;
    robot.moment.navigation.reset();
    robot.executor.update(robot.moment);
  }
  EXPECT_THAT(robot.job(job).sentence, HasSubstr("the planner has been silent for 8 s"));
}

TEST(JobExecutor, DrivesHomeOnceWhenItHasNothingToDo) {
  JobParams params;
  params.idle_time = 60.0;
  PretendedRobot robot(params);
  robot.run(59.0);
  EXPECT_THAT(robot.goals, IsEmpty());
  robot.run(5.0);
  EXPECT_THAT(robot.goals, ElementsAre(""));
  EXPECT_EQ(robot.say(Action::kCancel, robot.executor.table().active), "");
  robot.run(300.0);
  EXPECT_THAT(robot.goals, SizeIs(1)) << "somebody wants it to stay where it is";
}

TEST(JobExecutor, WaitsForAVisitorAndGoesBackForHim) {
  PretendedRobot robot;
  const std::int64_t job = robot.add(JobKind::kGuide, {"lab"});
  robot.moment.world_from_robot = Pose2{3.0, 3.0, 0.0};
  robot.run(3.0);
  bool is_followed = true;
  const auto lead = [&](double seconds) {
    robot.moment.driven = 0.08;
    for (double t = 0.0; t < seconds && robot.navigation.state == Drive::kUnderWay; t += 0.2) {
      robot.moment.world_from_robot->x += robot.moment.driven;
      robot.moment.echoes.clear();
      if (is_followed) {
        robot.moment.echoes.push_back({*robot.moment.world_from_robot * Pose2{-0.25, 0.0, kPi}, 0.26, 0.6});
      }
      robot.step();
    }
    robot.moment.driven = 0.0;
    robot.moment.echoes.clear();
  };
  lead(10.0);
  EXPECT_EQ(robot.navigation.state, Drive::kUnderWay);
  is_followed = false;
  lead(8.0);
  EXPECT_EQ(robot.navigation.state, Drive::kPaused);
  EXPECT_THAT(robot.job(job).sentence, HasSubstr("waits for its visitor"));
  robot.run(11.0);
  EXPECT_THAT(robot.job(job).sentence, HasSubstr("goes back"));
  EXPECT_THAT(robot.goals, ElementsAre("lab", ""));
  robot.navigation.state = Drive::kArrived;
  robot.run(12.0);
  EXPECT_THAT(robot.goals, ElementsAre("lab", "", "lab")) << "it leads on, and sees whether he comes";
  is_followed = true;
  lead(4.0);
  robot.arrive();
  robot.run(1.0);
  EXPECT_EQ(robot.job(job).state, JobState::kDone);
}

TEST(JobExecutor, GoesBackForAVisitorAsFarAsItGets) {
  PretendedRobot robot;
  const std::int64_t job = robot.add(JobKind::kGuide, {"lab"});
  robot.moment.world_from_robot = Pose2{3.0, 3.0, 0.0};
  robot.run(3.0);
  robot.moment.driven = 4.0;
  robot.step();
  robot.moment.driven = 0.0;
  robot.run(11.0);
  ASSERT_THAT(robot.goals, ElementsAre("lab", ""));
  robot.navigation.state = Drive::kBlocked;
  robot.run(1.0);
  EXPECT_EQ(robot.job(job).state, JobState::kDriving) << "nobody is asked about a door for that";
  EXPECT_THAT(robot.job(job).sentence, HasSubstr("waits where"));
  robot.run(11.0);
  EXPECT_THAT(robot.goals, ElementsAre("lab", "", "lab"));
}

TEST(JobExecutor, StartsAScheduledTourOnceADay) {
  PretendedRobot robot;
  const LocalTime at{.day = 4, .weekday = 2, .second = 34203};
  robot.executor.tell_time(at, robot.moment.utime);
  robot.executor.tell_time(at, robot.moment.utime);
  ASSERT_THAT(robot.executor.table().jobs, SizeIs(1));
  EXPECT_EQ(robot.executor.table().jobs[0].tour, "morning");
  EXPECT_EQ(robot.executor.table().jobs[0].sender, "schedule");
  robot.executor.tell_time({.day = 5, .weekday = 3, .second = 34203}, robot.moment.utime);
  EXPECT_THAT(robot.executor.table().jobs, SizeIs(1)) << "yesterday's waits still";
}

}  // namespace
}  // namespace luminav
