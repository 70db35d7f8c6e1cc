#include "services/planner/execution/people_in_the_way.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

Situation at(double x, std::int64_t now, bool yielding) {
  Situation situation;
  situation.now = now;
  situation.world_from_robot = {x, 0.0, 0.0};
  situation.control = ControlReport{};
  situation.control->yielding = yielding;
  situation.control->reason = "waiting for a person";
  return situation;
}

std::optional<std::string> heard(PeopleInTheWay& people, const Situation& situation) {
  people.hear(situation);
  return people.cause(situation);
}

TEST(PeopleInTheWay, SaysThatItWaitsUntilTheRobotHasSetOff) {
  PeopleInTheWay people;
  EXPECT_FALSE(heard(people, at(0.0, 1'000'000, false)));
  EXPECT_EQ(heard(people, at(0.0, 2'000'000, true)), "waiting for a person");
  EXPECT_TRUE(heard(people, at(0.01, 2'500'000, false))) << "they let it go for a moment";
  EXPECT_FALSE(heard(people, at(0.06, 2'600'000, false)));
}

TEST(PeopleInTheWay, SaysSoNoLongerWhenNobodyIsThereForASecond) {
  PeopleInTheWay people;
  EXPECT_TRUE(heard(people, at(0.0, 2'000'000, true)));
  EXPECT_TRUE(heard(people, at(0.0, 3'000'000, false)));
  EXPECT_FALSE(heard(people, at(0.0, 3'000'001, false)));
}

TEST(PeopleInTheWay, RemembersThemForTwentySeconds) {
  PeopleInTheWay people;
  EXPECT_FALSE(people.were_met_lately(1'000'000));
  people.hear(at(0.0, 2'000'000, true));
  EXPECT_TRUE(people.were_met_lately(21'999'999));
  EXPECT_FALSE(people.were_met_lately(22'000'000));
}

TEST(PeopleInTheWay, AreLeftOnceOnTheWayToAStop) {
  PeopleInTheWay people;
  EXPECT_TRUE(people.may_be_left());
  EXPECT_FALSE(people.may_be_left());
  people.reset();
  EXPECT_TRUE(people.may_be_left());
}

}  // namespace
}  // namespace luminav
