#include "services/mapper/tile_schedule.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace luminav {
namespace {

constexpr std::int64_t kStart = 1'000'000'000;
constexpr std::int64_t kTick = 100'000;  // [us]

TEST(TileSchedule, SendsEveryTileWithinARound) {
  for (const int tiles : {1, 12, 3969}) {  // 3969: a map of 4000 x 4000 cells
    TileSchedule schedule({}, tiles);
    std::vector<std::int64_t> last(static_cast<std::size_t>(tiles), kStart);
    std::size_t max = 0;
    std::int64_t longest = 0;
    for (std::int64_t now = kStart; now <= kStart + 31'000'000; now += kTick) {
      const std::vector<int> due = schedule.due(now);
      max = std::max(max, due.size());
      for (const int tile : due) {
        longest = std::max(longest, now - last[static_cast<std::size_t>(tile)]);
        last[static_cast<std::size_t>(tile)] = now;
      }
    }
    EXPECT_LE(longest, 10'000'000) << tiles;
    EXPECT_LE(max, 200U) << tiles;
  }
}

TEST(TileSchedule, SendsAChangedTileAtOnceAndThenNoOftenerThanItsLimit) {
  TileSchedule schedule({}, 400);
  (void)schedule.due(kStart);
  int sent = 0;
  for (int i = 1; i <= 20; ++i) {  // two seconds
    schedule.mark_changed(300);
    const std::vector<int> due = schedule.due(kStart + i * kTick);
    sent += static_cast<int>(std::count(due.begin(), due.end(), 300));
    if (i == 1) {
      EXPECT_EQ(sent, 1);
    }
  }
  EXPECT_GE(sent, 9);
  EXPECT_LE(sent, 12);
}

TEST(TileSchedule, SendsRequestedTilesFirstAndOnce) {
  TileSchedule schedule({}, 400);
  for (int i = 0; i < 10; ++i) {
    (void)schedule.due(kStart + i * kTick);
  }
  schedule.request(399);
  schedule.request(399);
  const std::vector<int> due = schedule.due(kStart + 10 * kTick);
  EXPECT_EQ(due.front(), 399);
  EXPECT_EQ(std::count(due.begin(), due.end(), 399), 1);
}

TEST(TileSchedule, SpreadsARequestForEverything) {
  TileSchedule schedule({}, 3969);
  schedule.request_all();
  std::vector<bool> sent(3969, false);
  int ticks = 0;
  while (std::count(sent.begin(), sent.end(), true) < 3969 && ticks < 100) {
    for (const int tile : schedule.due(kStart + ticks * kTick)) {
      sent[static_cast<std::size_t>(tile)] = true;
    }
    ++ticks;
  }
  EXPECT_LE(ticks, 80);
}

}  // namespace
}  // namespace luminav
