#include "services/detector/column_sort.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace luminav {
namespace {

template <std::size_t kColumns>
void expect_sorted_columns(std::size_t rows) {
  std::mt19937 rng(3);
  std::vector<std::array<float, kColumns>> table(rows);
  for (auto& row : table) {
    for (float& value : row) {
      value = static_cast<float>(rng() % 20);
    }
  }
  auto sorted = table;
  sort_columns(sorted);
  for (std::size_t k = 0; k < kColumns; ++k) {
    std::vector<float> expected;
    std::vector<float> column;
    for (std::size_t i = 0; i < rows; ++i) {
      expected.push_back(table[i][k]);
      column.push_back(sorted[i][k]);
    }
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(column, expected) << rows << " rows, column " << k;
  }
}

TEST(ColumnSort, SortsEveryColumnOfTablesOfAnyHeight) {
  for (std::size_t rows = 0; rows <= 70; ++rows) {
    expect_sorted_columns<8>(rows);
    expect_sorted_columns<16>(rows);
  }
}

}  // namespace
}  // namespace luminav
