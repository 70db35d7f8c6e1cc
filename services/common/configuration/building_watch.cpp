#include "services/common/configuration/building_watch.hpp"

#include <exception>
#include <utility>

#include <fmt/format.h>

#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_edit.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/whole_file.hpp"

namespace luminav {

FileSum& FileSum::add(std::string_view bytes) {
  for (const char byte : bytes) {
    value_ = (value_ ^ static_cast<std::uint8_t>(byte)) * 0x100000001b3;
  }
  return *this;
}

FileSum sum_of_map(const std::string& map_file) {
  FileSum sum;
  if (!map_file.empty()) {
    const PriorMap map = read_map(map_file);
    const GridGeometry& g = map.geometry;
    sum.add(fmt::format("{} {} {} {} {}", g.columns, g.rows, g.resolution, g.origin.x(), g.origin.y()));
    sum.add({reinterpret_cast<const char*>(map.cells.data()), map.cells.size() * sizeof(Prior)});
  }
  return sum;
}

BuildingWatch::BuildingWatch(std::filesystem::path file) : file_(std::move(file)) {
  building_ = read_building(file_);
  map_sum_ = sum_of_map(building_.map_file);
  sum_ = sum_of_file();
  building_ = read_building(file_);  // newer than its sum at worst: then it is taken over once more
}

// Anybody may say a sum, as often as he likes: only a file that was written anew is read.
std::int64_t BuildingWatch::sum_of_file() {
  const std::pair written(std::filesystem::last_write_time(file_), std::filesystem::file_size(file_));
  if (written != written_) {
    sum_of_file_ = FileSum(map_sum_).add(read_whole_file(file_)).value();
    written_ = written;
  }
  return sum_of_file_;
}

bool BuildingWatch::take_over(std::int64_t heard) {
  return heard != 0 && heard != sum_ && take_over(std::optional(heard));
}

bool BuildingWatch::take_over() {
  written_ = {};  // it may be of the same tick
  return take_over(std::optional<std::int64_t>());
}

bool BuildingWatch::take_over(const std::optional<std::int64_t>& heard) {
  try {
    const std::int64_t sum = sum_of_file();
    if (sum == sum_ || (heard && sum != *heard)) {
      return false;
    }
    Building building = read_building(file_);
    if (!differ_in_zones_and_places_alone(building, building_) || sum_of_file() != sum) {
      return false;
    }
    building_ = std::move(building);
    sum_ = sum;
    return true;
  } catch (const std::exception&) {
    return false;  // a file that cannot be read changes nothing
  }
}

}  // namespace luminav
