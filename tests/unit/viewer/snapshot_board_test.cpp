#include "services/viewer/snapshot_board.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

namespace luminav {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Lane = SnapshotBoard::Lane;

constexpr std::size_t kPlenty = 1'000'000;

std::vector<std::string> read(SnapshotBoard& board, SnapshotBoard::Cursor& cursor, std::size_t budget = kPlenty) {
  std::vector<std::string> texts;
  for (const SnapshotBoard::Text& text : board.read(cursor, 0, budget)) {
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

TEST(SnapshotBoard, WakesReadersWithTheTickAndWhenItCloses) {
  SnapshotBoard board;
  SnapshotBoard::Cursor cursor;
  EXPECT_THAT(read(board, cursor), IsEmpty());
  std::vector<SnapshotBoard::Text> texts;
  std::thread reader([&] { texts = board.read(cursor, 60'000, kPlenty); });
  board.put(Lane::kLive, "state", "new");
  board.tick();
  reader.join();
  ASSERT_EQ(texts.size(), 1U);
  EXPECT_EQ(*texts.front(), "new");
  std::thread last_reader([&] { texts = board.read(cursor, 60'000, kPlenty); });
  board.close();
  last_reader.join();
  EXPECT_TRUE(texts.empty());
  EXPECT_TRUE(board.is_closed());
}

}  // namespace
}  // namespace luminav
