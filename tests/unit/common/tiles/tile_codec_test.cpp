#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "services/common/tiles/tile_codec.hpp"

namespace luminav {
namespace {

OccupancyGrid random_grid(int columns, int rows) {
  OccupancyGrid grid(GridGeometry{0.1, {-3.0, 4.0}, columns, rows});
  std::mt19937 rng(42);
  for (std::size_t i = 0; i < grid.geometry.size(); ++i) {
    grid.prior[i] = static_cast<Prior>(rng() % 4);
    grid.evidence[i] = static_cast<std::int8_t>(static_cast<int>(rng() % 255) - 127);
  }
  return grid;
}

TEST(GridTile, CarriesBothLayersToAnotherGrid) {
  const OccupancyGrid source = random_grid(150, 70);
  OccupancyGrid target(source.geometry);
  for (int row = 0; row < source.tile_rows(); ++row) {
    for (int column = 0; column < source.tile_columns(); ++column) {
      const grid_tile_t tile = encode_tile(source, column, row);
      EXPECT_LE(tile.getEncodedSize(), 65'000);
      ASSERT_TRUE(apply_tile(tile, target));
    }
  }
  EXPECT_EQ(target.prior, source.prior);
  EXPECT_EQ(target.evidence, source.evidence);
}

TEST(GridTile, IsRefusedWhenItDoesNotFit) {
  const OccupancyGrid source = random_grid(64, 64);
  const grid_tile_t tile = encode_tile(source, 0, 0);
  OccupancyGrid other(GridGeometry{0.1, {0.0, 0.0}, 64, 64});
  EXPECT_FALSE(apply_tile(tile, other));
  OccupancyGrid same(source.geometry);
  grid_tile_t cut = tile;
  cut.data.resize(cut.data.size() / 2);
  EXPECT_FALSE(apply_tile(cut, same));
  cut.size = static_cast<std::int32_t>(cut.data.size());
  EXPECT_FALSE(apply_tile(cut, same));
  grid_tile_t beyond = tile;
  beyond.tile_column = 1;
  EXPECT_FALSE(apply_tile(beyond, same));
  grid_tile_t enormous = tile;
  enormous.columns = 1'000'000;
  EXPECT_FALSE(is_possible(enormous));
  // 64 times these is 0 in 32 bits
  for (const std::int32_t alias : {1 << 26, 3 << 26, std::numeric_limits<std::int32_t>::max()}) {
    grid_tile_t wrapped = tile;
    wrapped.tile_column = alias;
    EXPECT_FALSE(is_possible(wrapped)) << alias;
    wrapped.tile_column = 0;
    wrapped.tile_row = alias;
    EXPECT_FALSE(is_possible(wrapped)) << alias;
  }
  EXPECT_EQ(same.evidence, OccupancyGrid(source.geometry).evidence);
}

}  // namespace
}  // namespace luminav
