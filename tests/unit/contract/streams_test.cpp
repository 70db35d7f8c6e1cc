#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "drivers/contract/clause.hpp"
#include "drivers/contract/odometry_watch.hpp"
#include "drivers/contract/ring_watch.hpp"
#include "drivers/contract/stream_watch.hpp"

namespace luminav {
namespace {

using Verdict = Clause::Verdict;

enum StreamClause { kRate, kStamps, kPace, kSequence };

constexpr std::int64_t kStart = 1'000'000'000;  // [us]
constexpr std::int64_t kPeriod = 100'000;       // [us]

/// Ten seconds at 10 Hz, as `change` makes them.
std::vector<Clause> judge_stream(const std::function<void(int, StreamHead&)>& change) {
  StreamWatch watch({"ODOMETRY", 10.0, 0.3});
  for (int i = 0; i < 100; ++i) {
    StreamHead head{kStart + i * kPeriod, kStart + i * kPeriod, 1, i};
    change(i, head);
    watch.hear(head);
  }
  return watch.clauses();
}

TEST(Clause, IsBrokenOnceAndForAllAndKeepsTheFirstEvidence) {
  Clause clause("it holds");
  EXPECT_EQ(clause.verdict(), Verdict::kNotSeen);
  clause.keep("well");
  EXPECT_EQ(clause.verdict(), Verdict::kHolds);
  clause.breach("first");
  clause.breach("second");
  clause.keep("well again");
  EXPECT_EQ(clause.verdict(), Verdict::kBroken);
  EXPECT_EQ(clause.evidence(), "first");
  EXPECT_EQ(clause.breaches(), 2);
}

TEST(StreamWatch, HoldsForAnEvenStream) {
  for (const Clause& clause : judge_stream([](int, StreamHead&) {})) {
    EXPECT_EQ(clause.verdict(), Verdict::kHolds) << clause.text() << ": " << clause.evidence();
  }
}

TEST(StreamWatch, CountsArrivalsAndNotStampsForTheRate) {
  const auto clauses = judge_stream([](int i, StreamHead& head) { head.arrival = kStart + 2 * i * kPeriod; });
  EXPECT_EQ(clauses[kRate].verdict(), Verdict::kBroken);
  EXPECT_EQ(clauses[kPace].verdict(), Verdict::kBroken);
  EXPECT_EQ(clauses[kStamps].verdict(), Verdict::kHolds);
}

TEST(StreamWatch, FindsOneGap) {
  const auto clauses = judge_stream([](int i, StreamHead& head) {
    head.utime += i < 50 ? 0 : 250'000;
    head.arrival += i < 50 ? 0 : 250'000;
  });
  EXPECT_EQ(clauses[kRate].verdict(), Verdict::kBroken);
}

TEST(StreamWatch, FindsAStampThatIsRepeated) {
  const auto clauses = judge_stream([](int i, StreamHead& head) { head.utime -= i == 50 ? kPeriod : 0; });
  EXPECT_EQ(clauses[kStamps].verdict(), Verdict::kBroken);
}

TEST(StreamWatch, LetsASequenceBeginAnewWithASessionOnly) {
  const auto anew = [](bool with_session) {
    return judge_stream([=](int i, StreamHead& head) {
             head.sequence = i % 50;
             head.session = with_session ? i / 50 : 1;
           })[kSequence]
        .verdict();
  };
  EXPECT_EQ(anew(true), Verdict::kHolds);
  EXPECT_EQ(anew(false), Verdict::kBroken);
}

TEST(StreamWatch, ForgivesOneLostMessageOfAHundredButNotTen) {
  const auto lost = [](int count) {
    return judge_stream([=](int i, StreamHead& head) { head.sequence += i < 50 ? 0 : count; })[kSequence].verdict();
  };
  EXPECT_EQ(lost(1), Verdict::kHolds);
  EXPECT_EQ(lost(10), Verdict::kBroken);
}

odometry_t odometry_at(int i, double speed) {
  odometry_t message{};
  message.utime = kStart + i * kPeriod;
  message.session = 1;
  message.sequence = i;
  message.x = 0.1 * speed * i;
  message.linear = speed;
  return message;
}

TEST(OdometryWatch, HoldsThePoseAgainstTheTwist) {
  for (const double told : {0.3, 0.1}) {
    OdometryWatch watch;
    for (int i = 0; i < 30; ++i) {
      odometry_t message = odometry_at(i, 0.3);
      message.linear = told;
      watch.hear(message);
    }
    EXPECT_EQ(watch.clauses()[0].verdict(), told == 0.3 ? Verdict::kHolds : Verdict::kBroken);
  }
}

TEST(OdometryWatch, LetsThePoseJumpBetweenSessionsOnly) {
  for (const std::int64_t session : {1, 2}) {
    OdometryWatch watch;
    for (int i = 0; i < 60; ++i) {
      odometry_t message = odometry_at(i, 0.1);
      message.x += i < 30 ? 0.0 : 3.0;
      message.session = i < 30 ? 1 : session;
      watch.hear(message);
    }
    EXPECT_EQ(watch.clauses()[0].verdict(), session == 2 ? Verdict::kHolds : Verdict::kBroken);
  }
}

TEST(OdometryWatch, WantsTheSessionOfRobotStatus) {
  OdometryWatch watch;
  for (int i = 0; i < 30; ++i) {
    watch.hear(odometry_at(i, 0.0));
    robot_status_t status{};
    status.utime = kStart + i * kPeriod + 20'000;
    status.connected = 1;
    status.session = 2;
    watch.hear(status);
  }
  EXPECT_EQ(watch.clauses()[1].verdict(), Verdict::kBroken);
}

TEST(RingWatch, WantsAsManyDiscsAsTheFileAndNoneOfABaseWithoutAny) {
  SonarRing ring;
  EXPECT_TRUE(RingWatch(ring).clauses().empty());
  ring.robot_from_sonar.resize(2);
  RingWatch watch(ring);
  sonar_t message{};
  message.count = 1;
  message.range = {1.0F};
  message.has_echo = {1};
  message.fresh = {1};
  message.range_utime = {1};
  watch.hear(message);
  EXPECT_EQ(watch.clauses()[0].verdict(), Verdict::kBroken);
}

TEST(RingWatch, WantsTheMaximumWhereNothingEchoed) {
  SonarRing ring;
  ring.robot_from_sonar.resize(1);
  RingWatch watch(ring);
  sonar_t message{};
  message.utime = kStart;
  message.count = 1;
  message.range = {1.0F};
  message.has_echo = {0};
  message.fresh = {1};
  message.range_utime = {kStart};
  watch.hear(message);
  EXPECT_EQ(watch.clauses()[1].verdict(), Verdict::kBroken);
}

}  // namespace
}  // namespace luminav
