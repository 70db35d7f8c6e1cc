#include <algorithm>
#include <array>
#include <functional>
#include <queue>
#include <tuple>

#include "services/planner/wave_steps.hpp"
#include "services/planner/wavefront.hpp"

namespace luminav {
namespace {

constexpr std::uint32_t kUnreached = WaveField::kUnreached;
constexpr std::uint32_t kBlocked = WaveField::kBlocked;

/// The work of repair_wave: one queue by cost; of one cost, cells that may have lost their support come first.
class Repair {
 public:
  Repair(const WaveTerrain& terrain, WaveField& field)
      : terrain_(terrain), field_(field), steps_(wave_steps(terrain.columns())) {}

  void note(const std::vector<PriceChange>& changes) {
    for (const PriceChange& change : changes) {
      std::uint32_t& own = field_.stored[change.cell];
      if (own == kBlocked) {
        continue;
      }
      doubt_children(change.cell, own, change.price_before);
      if (!is_passable(change.cell)) {
        own = kBlocked;
      }
    }
    for (const PriceChange& change : changes) {
      std::uint32_t& own = field_.stored[change.cell];
      if (!is_passable(change.cell)) {
        continue;
      }
      if (own == kBlocked) {
        own = kUnreached;
        find_support(change.cell);
      } else if (own != kUnreached) {
        queue_.emplace(own, kSpread, change.cell);
      }
    }
  }

  [[nodiscard]] bool run(const WaveStop& stop) {
    const auto goal = static_cast<std::size_t>(stop.cell);
    std::uint32_t limit = field_.settled_to;
    while (!queue_.empty()) {
      const auto [level, task, cell] = queue_.top();
      const std::uint32_t wanted = field_.stored[goal];
      if (wanted != kUnreached && wanted < level) {
        limit = std::min(field_.settled_to, wanted + stop.margin);  // nothing queued can make it cheaper
      }
      if (level > limit) {
        break;
      }
      queue_.pop();
      if (task == kSettle) {
        settle(cell, level);
      } else if (field_.stored[cell] == level) {
        task == kDoubt ? check(cell, level) : spread(cell, level);
      }
    }
    if (!queue_.empty()) {
      field_.settled_to = limit;
    }
    const std::uint32_t reached = field_.stored[goal];
    return field_.settled_to == kUnreached || (reached != kUnreached && reached <= field_.settled_to);
  }

 private:
  enum Task : int { kDoubt = 0, kSettle = 1, kSpread = 2 };

  [[nodiscard]] bool is_passable(std::size_t cell) const {
    const auto columns = static_cast<std::size_t>(field_.columns);
    return terrain_.passable->test({static_cast<int>(cell % columns), static_cast<int>(cell / columns)});
  }
  /// Cells whose way led into this one when it cost `price`.
  void doubt_children(std::size_t cell, std::uint32_t cost, std::uint32_t price) {
    if (cost == kUnreached) {
      return;
    }
    for (const WaveStep& step : steps_) {
      const std::size_t neighbour = moved(cell, step.offset);
      if (field_.stored[neighbour] == cost + price * step.length) {
        queue_.emplace(field_.stored[neighbour], kDoubt, neighbour);
      }
    }
  }
  [[nodiscard]] std::uint32_t best_offer(std::size_t cell) const {
    std::uint32_t best = kUnreached;
    for (const WaveStep& step : steps_) {
      const std::size_t neighbour = moved(cell, step.offset);
      const std::uint32_t cost = field_.stored[neighbour];
      if (cost != kBlocked && cost != kUnreached) {
        best = std::min(best, cost + terrain_.price(neighbour) * step.length);
      }
    }
    return best;
  }
  /// Queues a cell that nothing holds any more. It stays unreached until then: two cells without a way to the seed
  /// would else hold each other up, ever higher.
  void find_support(std::size_t cell) {
    const std::uint32_t cost = best_offer(cell);
    if (cost != kUnreached) {
      queue_.emplace(cost, kSettle, cell);
    }
  }
  void settle(std::size_t cell, std::uint32_t level) {
    if (field_.stored[cell] <= level) {
      return;
    }
    if (best_offer(cell) != level) {
      find_support(cell);  // who made the offer has lost its own way since
      return;
    }
    field_.stored[cell] = level;
    spread(cell, level);
  }
  void check(std::size_t cell, std::uint32_t level) {
    if (best_offer(cell) == level) {
      return;  // another neighbour holds it
    }
    field_.stored[cell] = kUnreached;
    doubt_children(cell, level, terrain_.price(cell));
    find_support(cell);
  }
  void spread(std::size_t cell, std::uint32_t level) {
    const std::uint32_t price = terrain_.price(cell);
    for (const WaveStep& step : steps_) {
      const std::size_t neighbour = moved(cell, step.offset);
      const std::uint32_t cost = level + price * step.length;
      if (cost < field_.stored[neighbour]) {
        field_.stored[neighbour] = cost;
        queue_.emplace(cost, kSpread, neighbour);
      }
    }
  }

  using Entry = std::tuple<std::uint32_t, int, std::size_t>;
  const WaveTerrain& terrain_;
  WaveField& field_;
  std::array<WaveStep, 8> steps_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace

bool repair_wave(const WaveTerrain& terrain, const std::vector<PriceChange>& changes, const WaveStop& stop,
                 WaveField& field) {
  Repair repair(terrain, field);
  repair.note(changes);
  return repair.run(stop);
}

}  // namespace luminav
