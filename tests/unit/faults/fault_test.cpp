#include "tests/system/faults/fault.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace luminav {
namespace {

constexpr int kDraws = 100;  // some decks

int full_disks(FaultDeck deck) {
  int count = 0;
  for (int i = 0; i < kDraws; ++i) {
    count += deck.draw().kind == FaultKind::kDiskFull ? 1 : 0;
  }
  return count;
}

FaultResult good_result() {
  FaultResult result;
  result.needs_no_resume = true;
  return result;
}

GoalTally all_reached() {
  GoalTally goals;
  goals.reached = 3;
  return goals;
}

TEST(FaultDeck, FillsADiskOnlyWhereThereIsOneOfItsOwn) {
  EXPECT_GT(full_disks(FaultDeck(1, {.full_disk = true})), 0);
  EXPECT_EQ(full_disks(FaultDeck(1, {})), 0);
}

TEST(FaultDeck, DrawsEachFaultBeforeAnyComesAgain) {
  for (const bool full_disk : {true, false}) {
    // 7 processes in 3 ways each; the deputy, the sheriff, all at once; two leaks; guardian, viewer and processor; with
    // a disk of its own two full and two read-only ones; with a network of its own 7 processes under loss and strangers
    const int kinds = full_disk ? 41 : 29;
    FaultDeck deck(1, {.full_disk = full_disk, .packet_loss = full_disk, .second_host = full_disk});
    for (int pass = 0; pass < 3; ++pass) {
      std::set<std::string> drawn;
      for (int i = 0; i < kinds; ++i) {
        drawn.insert(to_string(deck.draw()));
      }
      EXPECT_EQ(static_cast<int>(drawn.size()), kinds);
    }
  }
}

TEST(TorturePassed, NeedsAFaultThatWasInjected) {
  EXPECT_FALSE(passed({}, all_reached()));
  EXPECT_TRUE(passed({good_result()}, all_reached()));
}

TEST(TorturePassed, NeedsEveryFaultToEndWell) {
  FaultResult touched = good_result();
  touched.contacts = 1;
  EXPECT_FALSE(passed({good_result(), touched}, all_reached()));
  GoalTally missed = all_reached();
  missed.missed = 1;
  EXPECT_FALSE(passed({good_result()}, missed));
}

}  // namespace
}  // namespace luminav
