#include "services/planner/search/tile_cost_field.hpp"

#include <array>
#include <bit>
#include <numeric>

namespace luminav {
namespace {

// bit 8 * row + column of a tile
constexpr std::uint64_t kFirstColumn = 0x0101010101010101ULL;
constexpr std::uint64_t kLastColumn = 0x8080808080808080ULL;

std::uint64_t beside(std::uint64_t cells) {
  return (cells << 1 & ~kFirstColumn) | (cells >> 1 & ~kLastColumn);
}

std::uint64_t above_and_below(std::uint64_t cells) {
  return cells << 8 | cells >> 8;
}

}  // namespace

void TileCostField::cut(const BitGrid& passable) {
  const auto tile_columns = static_cast<std::size_t>(passable.columns() + 7) / 8;
  const auto tile_rows = static_cast<std::size_t>(passable.rows() + 7) / 8;
  stride_ = tile_columns + 2;
  const std::size_t tiles = stride_ * (tile_rows + 2);
  open_.assign(tiles, 0);
  front_.assign(tiles, 0);
  next_.assign(tiles, 0);
  last_entry_.assign(tiles, 0);
  for (int row = 0; row < passable.rows(); ++row) {
    const std::uint64_t* words = passable.row(row);
    std::uint64_t* tile = open_.data() + (static_cast<std::size_t>(row / 8) + 1) * stride_ + 1;
    const int shift = 8 * (row % 8);
    for (std::size_t i = 0; i < tile_columns; ++i) {
      tile[i] |= (words[i / 8] >> (8 * (i % 8)) & 0xFF) << shift;
    }
  }
}

void TileCostField::enter(std::uint32_t tile, std::uint64_t cells) {
  cells &= open_[tile];
  if (cells == 0) {
    return;
  }
  if (next_[tile] == 0) {
    entered_.push_back(tile);
  }
  next_[tile] |= cells;
}

// Cells of the front reach their neighbours: inside the tile by shifts, across its border into the tiles around.
void TileCostField::spread(std::uint32_t tile, bool to_eight) {
  const std::uint64_t front = front_[tile];
  const auto stride = static_cast<std::uint32_t>(stride_);
  const std::uint64_t wide = front | beside(front);
  const std::uint64_t tall = front | above_and_below(front);
  enter(tile, to_eight ? wide | above_and_below(wide) : wide | tall);
  // what leaves over a side: of eight neighbours the diagonal ones too
  const std::uint64_t sideways = to_eight ? tall : front;
  const std::uint64_t upwards = to_eight ? wide : front;
  if ((front & kFirstColumn) != 0) {
    enter(tile - 1, (sideways & kFirstColumn) << 7);
  }
  if ((front & kLastColumn) != 0) {
    enter(tile + 1, (sideways & kLastColumn) >> 7);
  }
  if (front << 56 != 0) {
    enter(tile - stride, upwards << 56);
  }
  if (front >> 56 != 0) {
    enter(tile + stride, upwards >> 56);
  }
  constexpr std::uint64_t kCorners = 0x8100000000000081ULL;
  if (to_eight && (front & kCorners) != 0) {
    if ((front & 1U) != 0) {
      enter(tile - stride - 1, std::uint64_t{1} << 63);
    }
    if ((front >> 7 & 1U) != 0) {
      enter(tile - stride + 1, std::uint64_t{1} << 56);
    }
    if ((front >> 56 & 1U) != 0) {
      enter(tile + stride - 1, std::uint64_t{1} << 7);
    }
    if ((front >> 63) != 0) {
      enter(tile + stride + 1, 1U);
    }
  }
}

// What was entered becomes the front.
void TileCostField::settle_entered() {
  ++last_tick_;
  active_.swap(entered_);
  entered_.clear();
  for (const std::uint32_t tile : active_) {
    const std::uint64_t cells = next_[tile];
    next_[tile] = 0;
    front_[tile] = cells;
    open_[tile] &= ~cells;
    entries_.push_back({cells, last_tick_, last_entry_[tile], tile});
    last_entry_[tile] = static_cast<std::uint32_t>(entries_.size() - 1);
  }
}

// False when the front reached nothing new.
bool TileCostField::step() {
  for (const std::uint32_t tile : active_) {
    spread(tile, last_tick_ % 2 == 0);
  }
  if (entered_.empty()) {
    return false;
  }
  settle_entered();
  return true;
}

void TileCostField::grow(const BitGrid& passable, std::span<const Cell> goals) {
  begin(passable, goals);
  while (step()) {
  }
}

void TileCostField::begin(const BitGrid& passable, std::span<const Cell> goals) {
  cut(passable);
  last_tick_ = 0;
  // office floors need 7 or 8 a tile; memory is touched only as it is used, while a list that moves needs it twice
  constexpr std::size_t kEntriesPerTile = 10;
  entries_.reserve(kEntriesPerTile * open_.size());
  entries_.assign(1, {});  // the first means none
  entered_.clear();
  active_.clear();
  for (const Cell& goal : goals) {
    enter(static_cast<std::uint32_t>(tile_of(goal)), bit_of(goal));
  }
  settle_entered();
}

bool TileCostField::grow_to(const Cell& cell) {
  while (!is_reached(cell)) {
    if (!step()) {
      return false;
    }
  }
  return true;
}

std::int64_t TileCostField::reached() const {
  return std::accumulate(entries_.begin(), entries_.end(), std::int64_t{0},
                         [](std::int64_t cells, const Entry& entry) { return cells + std::popcount(entry.cells); });
}

std::uint32_t TileCostField::tick(const Cell& cell) const {
  const std::uint64_t bit = bit_of(cell);
  for (std::uint32_t i = last_entry_[tile_of(cell)]; i != 0; i = entries_[i].before) {
    if ((entries_[i].cells & bit) != 0) {
      return entries_[i].tick;
    }
  }
  return kUnreached;
}

// Of one step the ticks say too little: on a slant every other diagonal one falls by 1 only, as a straight one does.
// So two steps are looked at together, and the pair that falls most for its length is taken.
std::vector<Cell> TileCostField::follow_gradient(const Cell& start) const {
  struct Step {
    int column;
    int row;
    std::uint32_t length;
  };
  constexpr std::array<Step, 8> kSteps = {
      {{1, 0, 5}, {-1, 0, 5}, {0, 1, 5}, {0, -1, 5}, {1, 1, 7}, {1, -1, 7}, {-1, 1, 7}, {-1, -1, 7}}};
  std::vector<Cell> cells;
  Cell cell = start;
  std::uint32_t here = tick(cell);
  if (here == kUnreached) {
    return cells;
  }
  cells.push_back(cell);
  Cell last{0, 0};
  // a ring of blocked tiles lies around the grid
  const auto tick_at = [&](const Cell& at) { return at.column >= 0 && at.row >= 0 ? tick(at) : kUnreached; };
  while (here > 1) {
    Cell best = cell;
    std::uint32_t best_fall = 0;
    std::uint32_t best_length = 1;
    std::uint32_t best_tick = here;
    const auto consider = [&](const Cell& first, std::uint32_t there, std::uint32_t fall, std::uint32_t length) {
      const bool is_straight_on = first.column - cell.column == last.column && first.row - cell.row == last.row;
      if (fall * best_length > best_fall * length || (fall * best_length == best_fall * length && is_straight_on)) {
        best = first;
        best_tick = there;
        best_fall = fall;
        best_length = length;
      }
    };
    for (const Step& step : kSteps) {
      const Cell first{cell.column + step.column, cell.row + step.row};
      const std::uint32_t there = tick_at(first);
      if (there == kUnreached || there >= here) {
        continue;
      }
      if (there == 1) {
        consider(first, there, here - there, step.length);
      }
      for (const Step& second : kSteps) {
        const std::uint32_t beyond = tick_at({first.column + second.column, first.row + second.row});
        if (beyond != kUnreached && beyond < there) {
          consider(first, there, here - beyond, step.length + second.length);
        }
      }
    }
    last = {best.column - cell.column, best.row - cell.row};
    cell = best;
    here = best_tick;
    cells.push_back(cell);
  }
  return cells;
}

}  // namespace luminav
