#include "services/planner/space/cell_reading.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace luminav {
namespace {

struct CellRow {
  std::vector<Prior> prior;
  std::vector<std::int8_t> evidence;
};

CellRow random_row(int columns, std::mt19937& random) {
  CellRow row;
  for (int i = 0; i < columns; ++i) {
    row.prior.push_back(static_cast<Prior>(random() % 4));
    row.evidence.push_back(static_cast<std::int8_t>(static_cast<int>(random() % 256) - 128));
  }
  return row;
}

TEST(CellReading, IsThatOfEachCellByItself) {
  std::mt19937 random(1);
  for (const int columns : {1, 31, 63, 64, 65, 128, 200, 1000}) {
    for (int kind = 0; kind < 8; ++kind) {
      CellReading reading;
      reading.disputed_is_wall = (kind & 1) != 0;
      reading.unknown_blocks = (kind & 2) != 0;
      if ((kind & 4) != 0) {
        reading.occupied = 16;
        reading.not_free = -12;
      }
      const CellRow row = random_row(columns, random);
      std::vector<std::uint64_t> solid(static_cast<std::size_t>(columns + 63) / 64, 0);
      std::vector<std::uint64_t> unknown = solid;
      for (std::size_t i = 0; i < row.prior.size(); ++i) {
        const bool is_wall =
            row.prior[i] == Prior::kOccupied || (row.prior[i] == Prior::kDisputed && reading.disputed_is_wall);
        const bool is_solid = is_wall || row.evidence[i] > reading.occupied;
        const bool is_unknown =
            row.prior[i] == Prior::kUnknown && reading.unknown_blocks && row.evidence[i] > reading.not_free;
        solid[i / 64] |= std::uint64_t{is_solid} << (i % 64);
        unknown[i / 64] |= std::uint64_t{is_unknown} << (i % 64);
      }
      std::vector<std::uint64_t> read_solid(solid.size(), 0x5555);
      std::vector<std::uint64_t> read_unknown(solid.size(), 0x5555);
      read_cells(reading, row.prior.data(), row.evidence.data(), columns, read_solid.data(), read_unknown.data());
      EXPECT_EQ(read_solid, solid) << columns << " columns, kind " << kind;
      EXPECT_EQ(read_unknown, unknown) << columns << " columns, kind " << kind;
    }
  }
}

}  // namespace
}  // namespace luminav
