#include "services/launcher/deputy/sheriff_lease.hpp"

#include <gtest/gtest.h>

namespace luminav::launcher {
namespace {

constexpr std::int64_t kNow = 1'000'000'000;

TEST(SheriffLease, ReadsTheStartFromProcmansIds) {
  EXPECT_EQ(start_of_sheriff("host:123:1700000000000000"), 1700000000000000);
  EXPECT_EQ(start_of_sheriff("anything"), 0);
  EXPECT_EQ(start_of_sheriff("a:5"), 0);
  EXPECT_EQ(start_of_sheriff("a:5:x"), 0);
  EXPECT_EQ(start_of_sheriff("a:5:-7"), 0);
  EXPECT_EQ(start_of_sheriff("a:5:99999999999999999999999"), 0);
  EXPECT_EQ(start_of_sheriff(""), 0);
}

TEST(SheriffLease, LetsTheYoungerCommandAndTheOlderBackWhenThatIsGone) {
  SheriffLease lease;
  EXPECT_TRUE(lease.accepts("h:1:100", kNow));
  EXPECT_TRUE(lease.accepts("h:2:200", kNow + 1));
  EXPECT_FALSE(lease.accepts("h:1:100", kNow + 2));
  EXPECT_TRUE(lease.accepts("h:2:200", kNow + 3));
  EXPECT_FALSE(lease.accepts("h:1:100", kNow + 2 + SheriffLease::kLength));
  EXPECT_TRUE(lease.accepts("h:1:100", kNow + 3 + SheriffLease::kLength));
}

TEST(SheriffLease, RefusesAStrangerWithoutAgeWhileASheriffIsThere) {
  SheriffLease lease;
  EXPECT_TRUE(lease.accepts("h:1:100", kNow));
  EXPECT_FALSE(lease.accepts("intruder", kNow + 1));
  EXPECT_TRUE(lease.accepts("intruder", kNow + SheriffLease::kLength));
}

TEST(SheriffLease, LetsSheriffsOfUnknownAgeAlternateAsProcmanDoes) {
  SheriffLease lease;
  EXPECT_TRUE(lease.accepts("one", kNow));
  EXPECT_TRUE(lease.accepts("two", kNow + 1));
  EXPECT_TRUE(lease.accepts("one", kNow + 2));
}

}  // namespace
}  // namespace luminav::launcher
