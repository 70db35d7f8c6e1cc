#include "services/common/process/status/given_files.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

const std::string kHut = "name = \"hut\"\nceiling_height = 2.5\n";
const std::string kHutWithStairs = kHut + "[[zone]]\nname = \"stairs\"\npolygon = [[0, 0], [1, 0], [1, 1]]\n";

TEST(GivenFiles, AreNoneWhereNoneWereGiven) {
  GivenFiles given;
  EXPECT_FALSE(given.take_over());
  EXPECT_FALSE(given.take_over(17));
  EXPECT_EQ(given.files().building_hash, 0);
}

TEST(GivenFiles, TakeOverTheBuildingThatAnotherProcessHas) {
  const TemporaryFolder folder;
  const auto file = folder.write("building.toml", kHut);
  GivenFiles given;
  std::vector<std::size_t> zones;
  given.follow_building(file, [&](const Building& building) { zones.push_back(building.zones.size()); });
  EXPECT_EQ(given.files().building, "hut");
  const std::int64_t before = given.files().building_hash;
  folder.write("building.toml", kHutWithStairs);
  EXPECT_FALSE(given.take_over(before)) << "nobody has another one";
  const std::int64_t sum = BuildingWatch(file).sum();
  EXPECT_TRUE(given.take_over(sum));
  EXPECT_EQ(given.files().building_hash, sum);
  EXPECT_EQ(zones, (std::vector<std::size_t>{0, 1}));
}

TEST(GivenFiles, TakeOverWhatThisProcessChanged) {
  const TemporaryFolder folder;
  GivenFiles given;
  given.follow_building(folder.write("building.toml", kHut), {});
  EXPECT_FALSE(given.take_over());
  folder.write("building.toml", kHutWithStairs);
  EXPECT_TRUE(given.take_over());
}

}  // namespace
}  // namespace luminav
