#include "services/localizer/audit/resolving_walk.hpp"

#include <algorithm>
#include <bit>
#include <functional>
#include <queue>
#include <unordered_map>
#include <utility>

namespace luminav {
namespace {

constexpr std::size_t kMaxDeciding = 64;  // rivals: those left are the bits of a word

std::size_t index_of(std::int32_t number) {
  return static_cast<std::size_t>(number);
}

/// A* (Hart, Nilsson and Raphael 1968) over places and rivals left; the way that the farthest of them needs is the
/// bound.
class WalkSearch {
 public:
  WalkSearch(const WalkGround& ground, const std::vector<std::vector<double>>& to_refuted)
      : ground_(ground), to_refuted_(to_refuted), labels_at_(ground.points.size()) {
    add(0, 0.0, ~std::uint64_t{0} >> (kMaxDeciding - to_refuted.size()), -1);
  }

  struct Label {
    std::int32_t place = 0;
    bool is_dominated = false;  // another one came there by no longer way and left no other rivals
    double distance = 0.0;      // [m]
    std::uint64_t left = 0;     // rivals, as bits
    std::int32_t before = -1;   // label
  };
  using Entry = std::pair<double, std::int32_t>;  // [m] that the whole walk has at least, and a label

  /// The most promising way; the walk is complete when it left no rivals.
  Entry next() {
    while (true) {
      const Entry entry = queue_.top();
      queue_.pop();
      if (!label(entry.second).is_dominated) {
        return entry;
      }
    }
  }
  void expand(std::int32_t index) {
    const Label from = label(index);
    for (const std::int32_t next : ground_.neighbours[index_of(from.place)]) {
      add(next, from.distance + ground_.step(from.place, next), from.left, index);
    }
  }
  [[nodiscard]] const Label& label(std::int32_t index) const { return labels_[index_of(index)]; }

 private:
  void add(std::int32_t place, double distance, std::uint64_t rivals, std::int32_t before) {
    Label next{place, false, distance, 0, before};
    double farthest = 0.0;
    for (std::uint64_t rest = rivals; rest != 0; rest &= rest - 1) {
      const int rival = std::countr_zero(rest);
      const double way = to_refuted_[static_cast<std::size_t>(rival)][index_of(place)];
      next.left |= way > 0.0 ? std::uint64_t{1} << rival : 0;
      farthest = std::max(farthest, way);
    }
    std::vector<std::int32_t>& here = labels_at_[index_of(place)];
    if (std::any_of(here.begin(), here.end(), [&](std::int32_t other) {
          return label(other).distance <= distance && (label(other).left & ~next.left) == 0;
        })) {
      return;
    }
    std::erase_if(here, [&](std::int32_t other) {
      labels_[index_of(other)].is_dominated =
          distance <= label(other).distance && (next.left & ~label(other).left) == 0;
      return label(other).is_dominated;
    });
    here.push_back(static_cast<std::int32_t>(labels_.size()));
    queue_.emplace(distance + farthest, here.back());
    labels_.push_back(next);
  }

  const WalkGround& ground_;
  const std::vector<std::vector<double>>& to_refuted_;
  std::vector<std::vector<std::int32_t>> labels_at_;  // by place: not dominated
  std::vector<Label> labels_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace

ResolvingWalk::ResolvingWalk(const WalkGround& ground, std::size_t max_expanded)
    : ground_(ground),
      max_expanded_(max_expanded),
      search_(ground),
      is_never_(ground.points.size(), false),
      is_on_walk_(ground.points.size(), false) {}

ResolvingWalk::Result ResolvingWalk::find(std::int32_t from, std::size_t count, const IsPossible& is_possible,
                                          double enough) {
  refuted_at_.assign(count, from);
  Result result;
  Path walk{from};
  // one survivor after the other: some walk, by which the shortest one is bounded
  while (const auto rival = survivor(walk, count, is_possible)) {
    result.deciding.push_back(*rival);
    if (is_never_[index_of(from)] || !extend(walk, *rival, is_possible)) {
      result.length = kNever;
      return result;
    }
    if (result.deciding.size() == 1 && length(walk) > enough) {
      result.length = length(walk);
      return result;
    }
  }
  result.deciding.resize(std::min(kMaxDeciding, result.deciding.size()));
  Vicinity vicinity = this->vicinity(from, length(walk) + 1e-6);  // sums differ in their last bit
  for (const std::size_t rival : result.deciding) {
    add_rival(vicinity, rival, is_possible);
  }
  while (!result.deciding.empty()) {
    const Walk best = shortest(vicinity);
    result.length = best.length;
    if (best.path.empty() || best.length > enough) {
      break;
    }
    const auto rival = survivor(best.path, count, is_possible);
    if (!rival || result.deciding.size() == kMaxDeciding) {
      break;
    }
    result.deciding.push_back(*rival);
    add_rival(vicinity, *rival, is_possible);
  }
  return result;
}

double ResolvingWalk::length(const Path& walk) const {
  double length = 0.0;
  for (std::size_t i = 1; i < walk.size(); ++i) {
    length += ground_.step(walk[i - 1], walk[i]);
  }
  return length;
}

// The first rival that is possible all along a walk. Backwards: the end differs most from where it began.
std::optional<std::size_t> ResolvingWalk::survivor(const Path& walk, std::size_t count, const IsPossible& is_possible) {
  for (const std::int32_t place : walk) {
    is_on_walk_[index_of(place)] = true;
  }
  is_on_walk_[index_of(walk.front())] = false;  // all are possible there
  std::size_t rival = 0;
  for (; rival < count; ++rival) {
    if (is_on_walk_[index_of(refuted_at_[rival])]) {
      continue;
    }
    const auto refuted =
        std::find_if(walk.rbegin(), walk.rend(), [&](std::int32_t place) { return !is_possible(rival, place); });
    if (refuted == walk.rend()) {
      break;
    }
    refuted_at_[rival] = *refuted;
  }
  for (const std::int32_t place : walk) {
    is_on_walk_[index_of(place)] = false;
  }
  return rival < count ? std::optional(rival) : std::nullopt;
}

// On to the nearest place where a rival is refuted; false if there is none.
bool ResolvingWalk::extend(Path& walk, std::size_t rival, const IsPossible& is_possible) {
  search_.begin({walk.back()});
  while (const auto place = search_.next()) {
    if (!is_possible(rival, *place)) {
      search_.append_path(*place, walk);
      return true;
    }
    search_.pass(*place);
  }
  for (const std::int32_t place : search_.touched()) {
    is_never_[index_of(place)] = true;
  }
  return false;
}

ResolvingWalk::Vicinity ResolvingWalk::vicinity(std::int32_t from, double radius) {
  Vicinity vicinity;
  std::unordered_map<std::int32_t, std::int32_t> index;
  search_.begin({from});
  for (auto place = search_.next(); place && search_.distance(*place) <= radius; place = search_.next()) {
    index.emplace(*place, static_cast<std::int32_t>(vicinity.places.size()));
    vicinity.places.push_back(*place);
    vicinity.ground.points.push_back(ground_.points[index_of(*place)]);
    search_.pass(*place);
  }
  for (const std::int32_t place : vicinity.places) {
    std::vector<std::int32_t>& neighbours = vicinity.ground.neighbours.emplace_back();
    for (const std::int32_t neighbour : ground_.neighbours[index_of(place)]) {
      if (const auto known = index.find(neighbour); known != index.end()) {
        neighbours.push_back(known->second);
      }
    }
  }
  return vicinity;
}

// What lies beyond is left out: no shortest walk leads there.
void ResolvingWalk::add_rival(Vicinity& vicinity, std::size_t rival, const IsPossible& is_possible) const {
  std::vector<double>& way = vicinity.to_refuted.emplace_back(vicinity.places.size(), 0.0);
  std::vector<std::int32_t> inside{0};
  way[0] = kNever;
  std::vector<std::int32_t> rim;
  std::vector<bool> is_known(vicinity.places.size(), false);
  is_known[0] = true;
  for (std::size_t next = 0; next < inside.size(); ++next) {  // it grows meanwhile
    for (const std::int32_t neighbour : vicinity.ground.neighbours[index_of(inside[next])]) {
      if (is_known[index_of(neighbour)]) {
        continue;
      }
      is_known[index_of(neighbour)] = true;
      const bool is_inside = is_possible(rival, vicinity.places[index_of(neighbour)]);
      (is_inside ? inside : rim).push_back(neighbour);
      way[index_of(neighbour)] = is_inside ? kNever : 0.0;
    }
  }
  GroundSearch search(vicinity.ground);
  search.begin(rim);
  while (const auto place = search.next()) {
    const bool is_inside = way[index_of(*place)] > 0.0;
    if (is_inside || search.distance(*place) == 0.0) {
      way[index_of(*place)] = search.distance(*place);
      search.pass(*place);
    }
  }
}

ResolvingWalk::Walk ResolvingWalk::shortest(const Vicinity& vicinity) const {
  WalkSearch search(vicinity.ground, vicinity.to_refuted);
  for (std::size_t expanded = 0;; ++expanded) {
    const auto [bound, last] = search.next();
    const bool is_complete = search.label(last).left == 0;
    if (!is_complete && expanded < max_expanded_) {
      search.expand(last);
      continue;
    }
    Walk walk{bound, {}};
    for (std::int32_t label = is_complete ? last : -1; label >= 0; label = search.label(label).before) {
      walk.path.push_back(vicinity.places[index_of(search.label(label).place)]);
    }
    std::reverse(walk.path.begin(), walk.path.end());
    return walk;
  }
}

}  // namespace luminav
