#include "services/localizer/audit/resolving_walk.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <unordered_map>

namespace luminav {
namespace {

constexpr std::size_t kWordBits = 64;

std::size_t index_of(std::int32_t number) {
  return static_cast<std::size_t>(number);
}

}  // namespace

ResolvingWalk::ResolvingWalk(const RivalGround& ground, std::size_t max_expanded)
    : ground_(ground),
      max_expanded_(max_expanded),
      lengths_(ground.points.size(), -1.0),
      bit_of_(ground.rival_count, -1),
      visited_(ground.points.size()) {}

double ResolvingWalk::step(std::int32_t from, std::int32_t to) const {
  return (ground_.points[index_of(to)] - ground_.points[index_of(from)]).norm();
}

void ResolvingWalk::begin(std::int32_t from) {
  for (const std::int32_t place : touched_) {
    visited_[index_of(place)].is_known = false;
    visited_[index_of(place)].labels.clear();
  }
  touched_.clear();
  labels_.clear();
  left_.clear();
  queue_.clear();
  std::fill(bit_of_.begin(), bit_of_.end(), -1);
  std::int32_t bits = 0;
  for (const RivalAtPlace& rival : ground_.rivals[index_of(from)]) {
    bit_of_[index_of(rival.rival)] = bits++;
  }
  words_ = (index_of(bits) + kWordBits - 1) / kWordBits;
  const std::vector<Word> all(words_, ~Word{0});
  add(from, 0.0, all);
}

ResolvingWalk::Visited& ResolvingWalk::visited(std::int32_t place) {
  Visited& visited = visited_[index_of(place)];
  if (!visited.is_known) {
    visited.is_known = true;
    touched_.push_back(place);
    visited.farthest_first.clear();
    visited.rivals.assign(words_, 0);
    for (const RivalAtPlace& rival : ground_.rivals[index_of(place)]) {
      const std::int32_t bit = bit_of_[index_of(rival.rival)];
      if (bit >= 0) {
        visited.farthest_first.push_back({bit, rival.distance});
        visited.rivals[index_of(bit) / kWordBits] |= Word{1} << (index_of(bit) % kWordBits);
      }
    }
  }
  return visited;
}

bool ResolvingWalk::is_subset(const Word* a, const Word* b) const {
  for (std::size_t i = 0; i < words_; ++i) {
    if ((a[i] & ~b[i]) != 0) {
      return false;
    }
  }
  return true;
}

double ResolvingWalk::farthest(const Visited& here, const Word* rivals) {
  const auto left = std::find_if(here.farthest_first.begin(), here.farthest_first.end(), [&](const RivalBit& rival) {
    return (rivals[index_of(rival.bit) / kWordBits] >> (index_of(rival.bit) % kWordBits) & 1) != 0;
  });
  return left == here.farthest_first.end() ? 0.0 : left->distance;
}

void ResolvingWalk::add(std::int32_t place, double distance, std::span<const Word> rivals) {
  Visited& here = visited(place);
  const std::size_t index = labels_.size();
  left_.resize((index + 1) * words_);
  Word* const left = left_.data() + index * words_;
  std::transform(rivals.begin(), rivals.end(), here.rivals.begin(), left, std::bit_and<>());
  const auto left_by = [&](std::size_t label) { return left_.data() + label * words_; };
  if (std::any_of(here.labels.begin(), here.labels.end(), [&](std::size_t other) {
        return labels_[other].distance <= distance && is_subset(left_by(other), left);
      })) {
    return;  // the next label takes its words
  }
  std::erase_if(here.labels, [&](std::size_t other) {
    labels_[other].is_dominated = distance <= labels_[other].distance && is_subset(left, left_by(other));
    return labels_[other].is_dominated;
  });
  here.labels.push_back(index);
  labels_.push_back({place, false, distance});
  queue_.emplace_back(distance + farthest(here, left), index);
  std::push_heap(queue_.begin(), queue_.end(), std::greater<>());
}

double ResolvingWalk::length_in_sight(std::int32_t from) {
  double& length = lengths_[index_of(from)];
  length = length < 0.0 ? search(from) : length;
  return length;
}

double ResolvingWalk::search(std::int32_t from) {
  begin(from);
  std::vector<Word> left(words_);
  for (std::size_t expanded = 0;;) {
    const auto [bound, index] = queue_.front();
    std::pop_heap(queue_.begin(), queue_.end(), std::greater<>());
    queue_.pop_back();
    const Label label = labels_[index];
    if (label.is_dominated) {
      continue;
    }
    const auto first = left_.begin() + static_cast<std::ptrdiff_t>(index * words_);
    left.assign(first, first + static_cast<std::ptrdiff_t>(words_));
    const bool is_resolved = std::all_of(left.begin(), left.end(), [](Word word) { return word == 0; });
    if (is_resolved || std::isinf(bound) || ++expanded > max_expanded_) {
      return bound;
    }
    for (const std::int32_t next : ground_.neighbours[index_of(label.place)]) {
      add(next, label.distance + step(label.place, next), left);
    }
  }
}

// Who sees nothing drives to where something is seen, and goes on from there.
double ResolvingWalk::length(std::int32_t from) {
  if (!ground_.is_blind[index_of(from)]) {
    return length_in_sight(from);
  }
  using Entry = std::pair<double, std::int32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  std::unordered_map<std::int32_t, double> distances;
  const auto reach = [&](std::int32_t place, double distance) {
    const auto [known, is_new] = distances.try_emplace(place, distance);
    if (is_new || distance < known->second) {
      known->second = distance;
      queue.emplace(distance, place);
    }
  };
  double best = kNever;
  reach(from, 0.0);
  while (!queue.empty() && queue.top().first < best) {
    const auto [distance, place] = queue.top();
    queue.pop();
    if (distance > distances[place]) {
      continue;
    }
    if (!ground_.is_blind[index_of(place)]) {
      const std::vector<RivalAtPlace>& rivals = ground_.rivals[index_of(place)];
      const double min = rivals.empty() ? 0.0 : rivals.front().distance;
      best = distance + min < best ? std::min(best, distance + length_in_sight(place)) : best;
      continue;
    }
    for (const std::int32_t next : ground_.neighbours[index_of(place)]) {
      reach(next, distance + step(place, next));
    }
  }
  return best;
}

}  // namespace luminav
