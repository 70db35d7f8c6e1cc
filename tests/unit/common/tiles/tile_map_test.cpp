#include "services/common/tiles/tile_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>

#include "services/common/tiles/tile_codec.hpp"

namespace luminav {
namespace {

const GridGeometry kTwoTiles{0.1, {0.0, 0.0}, 100, 50};

grid_tile_t tile_of(std::int64_t session, int column, Prior all) {
  OccupancyGrid grid(kTwoTiles);
  std::fill(grid.prior.begin(), grid.prior.end(), all);
  grid_tile_t tile = encode_tile(grid, column, 0);
  tile.map_session = session;
  tile.revision = 1;
  return tile;
}

TEST(TileMap, ShowsTheTilesOfTheFirstSessionAsTheyCome) {
  TileMap map;
  EXPECT_EQ(map.add(tile_of(1, 0, Prior::kFree)), TileMap::Result::kChanged);
  EXPECT_FALSE(map.is_complete());
  EXPECT_EQ(map.grid().prior.front(), Prior::kFree);
  EXPECT_EQ(map.grid().prior.back(), Prior::kUnknown);
}

TEST(TileMap, KeepsTheWholeMapUntilThatOfANewSessionIsWhole) {
  TileMap map;
  map.add(tile_of(1, 0, Prior::kFree));
  map.add(tile_of(1, 1, Prior::kFree));
  ASSERT_TRUE(map.is_complete());
  map.add(tile_of(2, 0, Prior::kOccupied));  // the other one is lost on its way
  EXPECT_FALSE(map.is_complete());
  EXPECT_EQ(map.grid().prior.front(), Prior::kFree);
  EXPECT_EQ(map.grid().prior.back(), Prior::kFree) << "a goal there is reachable as before";
  map.add(tile_of(3, 0, Prior::kOccupied));  // once more a new mapper
  EXPECT_EQ(map.grid().prior.back(), Prior::kFree);
  map.add(tile_of(3, 1, Prior::kOccupied));
  EXPECT_TRUE(map.is_complete());
  EXPECT_EQ(map.grid().prior.front(), Prior::kOccupied);
}

TEST(TileMap, RefusesASessionThatNoClockGives) {
  TileMap map;
  map.add(tile_of(2, 0, Prior::kFree));
  EXPECT_EQ(map.add(tile_of(std::numeric_limits<std::int64_t>::min() + 2, 0, Prior::kOccupied)),
            TileMap::Result::kRefused);
  EXPECT_EQ(map.grid().prior.front(), Prior::kFree);
}

TEST(TileMap, ForgetsNothingForATileThatDoesNotDecompress) {
  TileMap map;
  for (const int column : {0, 1}) {
    EXPECT_EQ(map.add(tile_of(5, column, Prior::kFree)), TileMap::Result::kChanged);
  }
  grid_tile_t broken = tile_of(6, 0, Prior::kOccupied);
  std::fill(broken.data.begin(), broken.data.end(), std::uint8_t{7});
  EXPECT_EQ(map.add(broken), TileMap::Result::kRefused);
  EXPECT_TRUE(map.is_complete());
  EXPECT_EQ(map.grid().prior.front(), Prior::kFree);
  grid_tile_t next = tile_of(5, 0, Prior::kOccupied);
  next.revision = 2;
  EXPECT_EQ(map.add(next), TileMap::Result::kChanged) << "the map goes on";
  EXPECT_EQ(map.grid().prior.front(), Prior::kOccupied);
  next.revision = -1;
  next.map_session = 7;
  EXPECT_EQ(map.add(next), TileMap::Result::kRefused);
}

}  // namespace
}  // namespace luminav
