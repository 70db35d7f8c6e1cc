#include "services/surveyor/explore/tried_floor.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <set>

#include "services/common/configuration/whole_file.hpp"

namespace luminav {
namespace {

constexpr double kCell = 0.1;  // [m]
constexpr long kAround = 2;    // [cells] beside a point: an estimate may shift the map a little

std::pair<long, long> cell_of(const Eigen::Vector2d& point) {
  return {static_cast<long>(std::floor(point.x() / kCell)), static_cast<long>(std::floor(point.y() / kCell))};
}

}  // namespace

void TriedFloor::add(const std::vector<Eigen::Vector2d>& points) {
  std::set<std::pair<long, long>> cells;
  for (const Eigen::Vector2d& point : points) {
    const auto [column, row] = cell_of(point);
    for (long dr = -kAround; dr <= kAround; ++dr) {
      for (long dc = -kAround; dc <= kAround; ++dc) {
        cells.insert({column + dc, row + dr});
      }
    }
  }
  for (const std::pair<long, long>& cell : cells) {
    ++tries_[cell];
  }
}

int TriedFloor::tries(const Eigen::Vector2d& point) const {
  const auto found = tries_.find(cell_of(point));
  return found == tries_.end() ? 0 : found->second;
}

TriedFloor read_tried_floor(const std::filesystem::path& file) {
  TriedFloor tried;
  std::ifstream stream(file);
  long column = 0;
  long row = 0;
  int tries = 0;
  while (stream >> column >> row >> tries) {
    tried.tries_[{column, row}] = tries;
  }
  return tried;
}

void write_tried_floor(const std::filesystem::path& file, const TriedFloor& tried) {
  std::string text;
  for (const auto& [cell, tries] : tried.tries_) {
    text += fmt::format("{} {} {}\n", cell.first, cell.second, tries);
  }
  write_whole_file(file, text);
}

}  // namespace luminav
