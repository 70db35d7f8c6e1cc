#include <algorithm>
#include <array>
#include <functional>
#include <vector>

#include "services/planner/search/cost_field.hpp"
#include "services/planner/search/grid_steps.hpp"

namespace luminav {
namespace {

constexpr std::uint32_t kUnreached = CostField::kUnreached;
constexpr std::uint32_t kBlocked = CostField::kBlocked;

// a step of repair costs some times what a cell costs a new field
constexpr std::size_t kMaxShare = 16;
constexpr std::size_t kFewestSteps = 16384;

/// The work of repair_cost_field: one queue by cost; of one cost, cells that may have lost their support come first.
class Repair {
 public:
  Repair(const CostTerrain& terrain, CostField& field)
      : terrain_(terrain), field_(field), queue_(field.pending), steps_(grid_steps(terrain.columns())) {}

  void note(const std::vector<PriceChange>& changes) {
    for (const PriceChange& change : changes) {
      std::uint32_t& own = field_.stored[change.cell];
      if (own == kBlocked) {
        continue;
      }
      raise_children(change.cell, own, change.price_before);
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
        queue(own, PendingTask::kSpread, change.cell);
      }
    }
  }

  /// False when it is not done after so many steps.
  [[nodiscard]] bool run(const CostStop& stop, std::size_t max) {
    const auto goal = static_cast<std::size_t>(stop.cell);
    std::uint32_t limit = kUnreached;
    const std::size_t queued_before = queue_.size();
    for (std::size_t steps = 0; !queue_.empty(); ++steps) {
      if (steps > max || queue_.size() > max + queued_before) {
        return false;
      }
      const auto [level, task, cell] = pending_of(queue_.front());
      const std::uint32_t wanted = field_.stored[goal];
      if (wanted != kUnreached && wanted < level) {
        limit = wanted + stop.margin;  // nothing queued can make it cheaper
        if (level > limit) {
          break;
        }
      }
      std::pop_heap(queue_.begin(), queue_.end(), std::greater<>());
      queue_.pop_back();
      if (task == PendingTask::kSettle) {
        settle(cell, level);
      } else if (field_.stored[cell] == level) {
        task == PendingTask::kRaise ? check(cell, level) : spread(cell, level);
      }
    }
    field_.settled_to = queue_.empty() ? kUnreached : limit;
    if (queue_.size() > std::max(kFewestSteps / 4, 2 * field_.pending_needed)) {
      tidy();
    }
    return true;
  }

 private:
  // Entries that others have overtaken go; what is left, sorted, is a heap.
  void tidy() {
    std::erase_if(queue_, [&](std::uint64_t entry) {
      const auto [level, task, cell] = pending_of(entry);
      return task == PendingTask::kSettle ? field_.stored[cell] <= level : field_.stored[cell] != level;
    });
    std::sort(queue_.begin(), queue_.end());
    queue_.erase(std::unique(queue_.begin(), queue_.end()), queue_.end());
    field_.pending_needed = queue_.size();
  }
  void queue(std::uint32_t level, PendingTask task, std::size_t cell) {
    queue_.push_back(pending_entry(level, task, cell));
    std::push_heap(queue_.begin(), queue_.end(), std::greater<>());
  }
  [[nodiscard]] bool is_passable(std::size_t cell) const {
    const auto columns = static_cast<std::size_t>(field_.columns);
    return terrain_.passable->test({static_cast<int>(cell % columns), static_cast<int>(cell / columns)});
  }
  /// Cells whose path led into this one when it cost `price`.
  void raise_children(std::size_t cell, std::uint32_t cost, std::uint32_t price) {
    if (cost == kUnreached) {
      return;
    }
    for (const GridStep& step : steps_) {
      const std::size_t neighbour = moved(cell, step.offset);
      if (field_.stored[neighbour] == cost + price * step.length) {
        queue(field_.stored[neighbour], PendingTask::kRaise, neighbour);
      }
    }
  }
  [[nodiscard]] std::uint32_t best_offer(std::size_t cell) const {
    std::uint32_t best = kUnreached;
    for (const GridStep& step : steps_) {
      const std::size_t neighbour = moved(cell, step.offset);
      const std::uint32_t cost = field_.stored[neighbour];
      if (cost != kBlocked && cost != kUnreached) {
        best = std::min(best, cost + terrain_.price(neighbour) * step.length);
      }
    }
    return best;
  }
  /// Queues a cell that nothing holds any more. It stays unreached until then: two cells without a path to the seed
  /// would else hold each other up, ever higher.
  void find_support(std::size_t cell) {
    const std::uint32_t cost = best_offer(cell);
    if (cost != kUnreached) {
      queue(cost, PendingTask::kSettle, cell);
    }
  }
  void settle(std::size_t cell, std::uint32_t level) {
    if (field_.stored[cell] <= level) {
      return;
    }
    if (best_offer(cell) != level) {
      find_support(cell);  // the neighbour that made the offer has lost its own path since
      return;
    }
    lower(cell, level);
    spread(cell, level);
  }
  // The work may be left before this cost is spread, and the cell be raised then: nobody would know any more that the
  // cost before held others up.
  void lower(std::size_t cell, std::uint32_t cost) {
    raise_children(cell, field_.stored[cell], terrain_.price(cell));
    field_.stored[cell] = cost;
  }
  void check(std::size_t cell, std::uint32_t level) {
    if (best_offer(cell) == level) {
      return;  // another neighbour holds it
    }
    field_.stored[cell] = kUnreached;
    raise_children(cell, level, terrain_.price(cell));
    find_support(cell);
  }
  void spread(std::size_t cell, std::uint32_t level) {
    const std::uint32_t price = terrain_.price(cell);
    for (const GridStep& step : steps_) {
      const std::size_t neighbour = moved(cell, step.offset);
      const std::uint32_t cost = level + price * step.length;
      if (cost < field_.stored[neighbour]) {
        lower(neighbour, cost);
        queue(cost, PendingTask::kSpread, neighbour);
      }
    }
  }

  const CostTerrain& terrain_;
  CostField& field_;
  std::vector<std::uint64_t>& queue_;  // a heap, the least in front
  std::array<GridStep, 8> steps_;
};

}  // namespace

bool repair_cost_field(const CostTerrain& terrain, const std::vector<PriceChange>& changes, const CostStop& stop,
                       CostField& field) {
  Repair repair(terrain, field);
  repair.note(changes);
  return repair.run(stop, std::max(kFewestSteps, field.stored.size() / kMaxShare));
}

}  // namespace luminav
