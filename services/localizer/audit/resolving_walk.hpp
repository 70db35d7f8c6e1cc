#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace luminav {

/// A rival of the true pose that is still possible at a place.
struct RivalAtPlace {
  std::int32_t rival = 0;  // its number, from 0
  float distance = 0.0F;   // [m] from the place to the nearest one where it is refuted; infinite: nowhere
};

/// Places, which lead to which in a straight line, and which rivals are still possible there.
struct RivalGround {
  std::vector<Eigen::Vector2d> points;                // [m]
  std::vector<bool> is_blind;                         // nothing is seen there: rivals are counted from where it is
  std::vector<std::vector<std::int32_t>> neighbours;  // by place
  std::vector<std::vector<RivalAtPlace>> rivals;      // by place, the farthest from being refuted first
  std::size_t rival_count = 0;                        // numbers there are
};

/// The shortest walk on which the last of several rivals is refuted. It may have to lead one way for one of them and
/// back for another, and is then longer than the way that any of them needs alone. A* (Hart, Nilsson and Raphael 1968)
/// over place and rivals left; the way that the farthest of them needs is the bound.
class ResolvingWalk {
 public:
  /// The ground must outlive it. After `max_expanded` ways looked at a search ends with what it knows then.
  explicit ResolvingWalk(const RivalGround& ground, std::size_t max_expanded = 4000);

  /// Length [m] of the walk from a place, to something in view first where nothing is; infinite if there is none. Where
  /// the search ended early it is at least so long.
  [[nodiscard]] double length(std::int32_t from);

 private:
  using Word = std::uint64_t;
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  /// A way to a place; the rivals that it left are `words_` words from `words_` times its index on.
  struct Label {
    std::int32_t place = 0;
    bool is_dominated = false;  // another one came there by no longer way and left no other rivals
    double distance = 0.0;      // [m]
  };
  struct RivalBit {
    std::int32_t bit = 0;
    float distance = 0.0F;  // [m] that it needs
  };
  /// What the search from one start knows of a place.
  struct Visited {
    bool is_known = false;
    std::vector<RivalBit> farthest_first;  // of those at the start that are possible there
    std::vector<Word> rivals;              // likewise
    std::vector<std::size_t> labels;       // not dominated
  };
  [[nodiscard]] double length_in_sight(std::int32_t from);
  [[nodiscard]] double search(std::int32_t from);
  [[nodiscard]] double step(std::int32_t from, std::int32_t to) const;
  void begin(std::int32_t from);
  [[nodiscard]] Visited& visited(std::int32_t place);
  void add(std::int32_t place, double distance, std::span<const Word> rivals);
  /// All rivals of `a` are among those of `b`.
  [[nodiscard]] bool is_subset(const Word* a, const Word* b) const;
  /// Way [m] that the farthest of some rivals needs from there.
  [[nodiscard]] static double farthest(const Visited& here, const Word* rivals);

  const RivalGround& ground_;
  std::size_t max_expanded_;
  std::vector<double> lengths_;       // by place; negative = not searched yet
  std::vector<std::int32_t> bit_of_;  // by rival; -1 = was not possible at the start
  std::size_t words_ = 0;             // that hold the bits
  std::vector<Visited> visited_;      // by place
  std::vector<std::int32_t> touched_;
  std::vector<Label> labels_;
  std::vector<Word> left_;                             // rivals left, by label
  std::vector<std::pair<double, std::size_t>> queue_;  // heap: length at least [m], label
};

}  // namespace luminav
