#include "services/surveyor/explore/tried_floor.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

TEST(TriedFloor, CountsGoalsAndNotTheirPoints) {
  TriedFloor tried;
  tried.add({{1.05, 2.05}, {1.15, 2.05}});
  EXPECT_EQ(tried.tries({1.05, 2.05}), 1);
  tried.add({{1.05, 2.05}});
  EXPECT_EQ(tried.tries({1.05, 2.05}), 2);
}

TEST(TriedFloor, CountsWhatLiesCloseByAsTheSame) {
  TriedFloor tried;
  tried.add({{-0.05, -0.05}});
  EXPECT_EQ(tried.tries({-0.25, 0.15}), 1);
  EXPECT_EQ(tried.tries({-0.35, -0.05}), 0);
  EXPECT_EQ(tried.tries({0.25, -0.05}), 0);
}

TEST(TriedFloor, IsReadAsItWasWritten) {
  const TemporaryFolder folder;
  TriedFloor tried;
  tried.add({{1.05, -2.05}});
  tried.add({{1.05, -2.05}, {7.05, 3.05}});
  write_tried_floor(folder.path() / "tried.txt", tried);
  const TriedFloor read = read_tried_floor(folder.path() / "tried.txt");
  EXPECT_EQ(read.tries({1.05, -2.05}), 2);
  EXPECT_EQ(read.tries({7.05, 3.05}), 1);
  EXPECT_EQ(read.tries({4.05, 3.05}), 0);
  EXPECT_EQ(read_tried_floor(folder.path() / "nothing.txt").tries({1.05, -2.05}), 0);
  EXPECT_EQ(read_tried_floor(folder.write("damaged.txt", "10 20 3\n11 x")).tries({1.05, 2.05}), 3);
}

}  // namespace
}  // namespace luminav
