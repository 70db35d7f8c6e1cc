#include "services/viewer/snapshot_board.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace luminav {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Lane = SnapshotBoard::Lane;

constexpr std::size_t kPlenty = 1'000'000;

// After a tick.
std::vector<std::string> read(SnapshotBoard& board, SnapshotBoard::Cursor& cursor, std::size_t budget = kPlenty) {
  board.tick();
  std::vector<std::string> texts;
  for (const SnapshotBoard::Text& text : board.read(cursor, budget)) {
    texts.push_back(*text);
  }
  return texts;
}

TEST(SnapshotBoard, GivesANewReaderEverythingAndThenOnlyNews) {
  SnapshotBoard board;
  SnapshotBoard::Cursor cursor;
  board.put(Lane::kLive, "a", "a1");
  board.put(Lane::kLive, "b", "b1");
  EXPECT_THAT(read(board, cursor), ElementsAre("a1", "b1"));
  EXPECT_THAT(read(board, cursor), IsEmpty());
  board.put(Lane::kLive, "a", "a2");
  EXPECT_THAT(read(board, cursor), ElementsAre("a2"));
}

TEST(SnapshotBoard, ASlowReaderSkipsWhatWasReplaced) {
  SnapshotBoard board;
  SnapshotBoard::Cursor cursor;
  for (int i = 0; i < 1000; ++i) {
    board.put(Lane::kLive, "state", std::to_string(i));
  }
  EXPECT_THAT(read(board, cursor), ElementsAre("999"));
}

TEST(SnapshotBoard, HandsOutBulkWithinTheBudgetButLiveAlways) {
  SnapshotBoard board;
  SnapshotBoard::Cursor cursor;
  board.put(Lane::kBulk, "t1", std::string(60, '1'));
  board.put(Lane::kBulk, "t2", std::string(60, '2'));
  board.put(Lane::kLive, "state", "s");
  EXPECT_THAT(read(board, cursor, 100), ElementsAre("s", std::string(60, '1')));
  board.put(Lane::kLive, "state", "s2");
  EXPECT_THAT(read(board, cursor, 1), ElementsAre("s2", std::string(60, '2')));
}

TEST(SnapshotBoard, ForgetsALane) {
  SnapshotBoard board;
  SnapshotBoard::Cursor cursor;
  board.put(Lane::kBulk, "t1", "old map");
  board.clear(Lane::kBulk);
  board.put(Lane::kBulk, "t2", "new map");
  EXPECT_THAT(read(board, cursor), ElementsAre("new map"));
}

TEST(SnapshotBoard, HandsOutNothingBetweenTwoTicks) {
  SnapshotBoard board;
  SnapshotBoard::Cursor cursor;
  EXPECT_THAT(read(board, cursor), IsEmpty());
  board.put(Lane::kLive, "state", "new");
  EXPECT_THAT(board.read(cursor, kPlenty), IsEmpty());
  EXPECT_THAT(read(board, cursor), ElementsAre("new"));
}

TEST(SnapshotBoard, ShowsANewReaderNothingFromBeforeTheNextTick) {
  SnapshotBoard board;
  board.put(Lane::kLive, "state", "of a minute ago");
  board.tick();
  SnapshotBoard::Cursor cursor = board.new_reader();
  EXPECT_THAT(board.read(cursor, kPlenty), IsEmpty());
  board.put(Lane::kLive, "state", "new");
  EXPECT_THAT(read(board, cursor), ElementsAre("new"));
}

TEST(SnapshotBoard, WakesWhomItWasToldTo) {
  SnapshotBoard board;
  int woken = 0;
  board.report_ticks([&] { ++woken; });
  board.tick();
  EXPECT_EQ(woken, 1);
  board.report_ticks(nullptr);
  board.tick();
  EXPECT_EQ(woken, 1);
}

}  // namespace
}  // namespace luminav
