#include "services/localizer/audit/walk_ground.hpp"

#include <algorithm>
#include <functional>

namespace luminav {

GroundSearch::GroundSearch(const WalkGround& ground) : ground_(ground), reached_(ground.points.size()) {}

void GroundSearch::begin(const std::vector<std::int32_t>& from) {
  for (const std::int32_t place : touched_) {
    reached_[static_cast<std::size_t>(place)] = {};
  }
  touched_.clear();
  queue_.clear();
  for (const std::int32_t place : from) {
    reach(place, 0.0, -1);
  }
}

std::optional<std::int32_t> GroundSearch::next() {
  while (!queue_.empty()) {
    const auto [length, place] = queue_.front();
    std::pop_heap(queue_.begin(), queue_.end(), std::greater<>());
    queue_.pop_back();
    if (length == distance(place)) {
      return place;
    }
  }
  return std::nullopt;
}

void GroundSearch::pass(std::int32_t place) {
  for (const std::int32_t neighbour : ground_.neighbours[static_cast<std::size_t>(place)]) {
    reach(neighbour, distance(place) + ground_.step(place, neighbour), place);
  }
}

void GroundSearch::reach(std::int32_t place, double distance, std::int32_t from) {
  Reached& reached = reached_[static_cast<std::size_t>(place)];
  if (reached.distance >= 0.0 && reached.distance <= distance) {
    return;
  }
  if (reached.distance < 0.0) {
    touched_.push_back(place);
  }
  reached = {distance, from};
  queue_.emplace_back(distance, place);
  std::push_heap(queue_.begin(), queue_.end(), std::greater<>());
}

void GroundSearch::append_path(std::int32_t to, std::vector<std::int32_t>& path) const {
  const auto first = static_cast<std::ptrdiff_t>(path.size());
  for (std::int32_t place = to; reached_[static_cast<std::size_t>(place)].from >= 0;
       place = reached_[static_cast<std::size_t>(place)].from) {
    path.push_back(place);
  }
  std::reverse(path.begin() + first, path.end());
}

}  // namespace luminav
