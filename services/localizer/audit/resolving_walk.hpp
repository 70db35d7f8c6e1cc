#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "services/localizer/audit/walk_ground.hpp"

namespace luminav {

/// The shortest walk from a place on which the last of several rivals of the true pose is refuted. It may have to lead
/// one way for one of them and back for another. Of thousands of rivals a handful decide: a walk that refutes those is
/// tried on all others, and who survives it joins them, until nobody does. No walk is shorter then.
class ResolvingWalk {
 public:
  /// Is a rival, by its number, still possible at a place?
  using IsPossible = std::function<bool(std::size_t rival, std::int32_t place)>;
  struct Result {
    double length = 0.0;                // [m] infinite: there is none
    std::vector<std::size_t> deciding;  // rivals that it had to be found for
  };
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  /// The ground must outlive it. A search ends after `max_expanded` ways looked at.
  explicit ResolvingWalk(const WalkGround& ground, std::size_t max_expanded = 4000);

  /// From a place where the rivals 0 .. count - 1 are possible. A rival that is refuted nowhere is held to be one of
  /// all places that it was possible at. A search that ended early, or whose walk is longer than `enough` [m], gives a
  /// length that the shortest walk has at least.
  [[nodiscard]] Result find(std::int32_t from, std::size_t count, const IsPossible& is_possible,
                            double enough = kNever);

 private:
  using Path = std::vector<std::int32_t>;
  /// The places that a walk may lead to, and what of the deciding rivals is left there.
  struct Vicinity {
    WalkGround ground;
    std::vector<std::int32_t> places;             // in the whole ground; the first is where the walk begins
    std::vector<std::vector<double>> to_refuted;  // [m] by rival and place: to where it is refuted, 0 = there
  };
  struct Walk {
    double length = 0.0;  // [m]
    Path path;            // nothing: the search ended early
  };
  [[nodiscard]] std::optional<std::size_t> survivor(const Path& walk, std::size_t count, const IsPossible& is_possible);
  [[nodiscard]] bool extend(Path& walk, std::size_t rival, const IsPossible& is_possible);
  [[nodiscard]] Vicinity vicinity(std::int32_t from, double radius);
  void add_rival(Vicinity& vicinity, std::size_t rival, const IsPossible& is_possible) const;
  [[nodiscard]] Walk shortest(const Vicinity& vicinity) const;
  [[nodiscard]] double length(const Path& walk) const;

  const WalkGround& ground_;
  std::size_t max_expanded_;
  GroundSearch search_;
  std::vector<bool> is_never_;            // by place: some rival that is possible there is refuted nowhere
  std::vector<std::int32_t> refuted_at_;  // by rival: where it was found to be refuted last
  std::vector<bool> is_on_walk_;          // by place
};

}  // namespace luminav
