#include "services/detector/covered_joints.hpp"

#include <algorithm>
#include <cmath>

#include "services/detector/blurred_edge.hpp"

namespace luminav {
namespace {

constexpr int kBegin = -104;                           // [places] outwards of the outline, where profiles begin ...
constexpr std::size_t kSteps = 26;                     // ... and how long they are: texture hides a tile's grey
constexpr int kPerStep = 8;                            // places from one grey level of a profile to the next
constexpr double kInwards = kBegin * EndCosts::kStep;  // [m]
constexpr double kFromCorner = 0.008;                  // [m] of the side's lines from its corners, which blur rounds
constexpr double kApart = 0.004;                       // [m] between lines on the side, about a pixel
constexpr int kLeastLines = 8;                         // on the side
constexpr std::array<double, EndCosts::kBlurs> kWidths{3.6, 4.4, 5.4, 7.0, 10.0};  // [px] of an edge, foot to top
constexpr double kUnlike = 12.0;      // chi squared by which one blur and the next speak against each other
constexpr double kUnknowns = 4.0;     // inside, outside, place and blur
constexpr double kCorrelation = 1.5;  // neighbouring samples are alike: chi squared counts that much less
constexpr double kNotQuite = 3.0;     // the same beside a joint, that is not quite as bright as beyond the corners
constexpr double kLeastShare = 0.3;   // of a pixel's variance that a line has
constexpr double kMisfit = 0.0003;    // [m] by which a size may be off ...
constexpr double kScale = 0.001;      // ... plus this share of half the size
constexpr int kMostMisfit = 4;        // places

/// Costs of the places from -count / 2 on.
struct PlaceCosts {
  std::array<double, EndCosts::kPlaces> cost;
  int count = 0;
  double least = 1e18;

  void add(double here) {
    cost[static_cast<std::size_t>(count++)] = here;
    least = std::min(least, here);
  }
};

/// Mean and variance, each place weighted by its likelihood over all blurs: beside a joint another blur may mean
/// another place. `costs_of(blur)` are those of each place. Nothing when a place at
/// the border of the search is best, for what lies beyond may be better.
template <typename CostsOf>
std::optional<PlaceBetween> mean_place(CostsOf costs_of) {
  std::array<PlaceCosts, EndCosts::kBlurs> costs;
  double least = 1e18;
  for (std::size_t blur = 0; blur < costs.size(); ++blur) {
    costs[blur] = costs_of(blur);
    least = std::min(least, costs[blur].least);
  }
  const int count = costs[0].count;
  double weights = 0.0;
  double sum = 0.0;
  double squares = 0.0;
  double most = 0.0;  // of one place
  int best = 0;
  for (int i = 0; i < count; ++i) {
    double weight = 0.0;
    for (const PlaceCosts& of_blur : costs) {
      weight += std::exp(-0.5 * (of_blur.cost[static_cast<std::size_t>(i)] - least));
    }
    if (weight > most) {
      most = weight;
      best = i;
    }
    const double place = EndCosts::kStep * (i - count / 2);
    weights += weight;
    sum += weight * place;
    squares += weight * place * place;
  }
  if (best == 0 || best == count - 1) {
    return std::nullopt;
  }
  const double mean = sum / weights;
  return PlaceBetween{mean, std::max(0.0, squares / weights - mean * mean) + EndCosts::kStep * EndCosts::kStep / 12.0};
}

/// [m] by which each side may lie farther out than the size says, as the other does.
double size_sigma(double half_size) {
  return kMisfit + kScale * half_size;
}

SideProfile profile_of_side(const GreyView& image, const CeilingCamera& camera, const SideLine& side) {
  const double usable = 2.0 * (side.half_length - kFromCorner);
  const int count = std::clamp(static_cast<int>(usable / kApart) + 1, 2, SideProfile::kMostLines);
  return mean_profile(
      image, camera, side,
      {.first = kInwards, .steps = kSteps, .from = -0.5 * usable, .apart = usable / (count - 1), .count = count});
}

/// How much of a blurred edge's far side is seen at each place beside it: all profiles ask for the same places.
class BlurredEdge {
  static_assert(kPerStep * EndCosts::kStep == SideProfile::kStep);

 public:
  /// `width` [m] from foot to top.
  explicit BlurredEdge(double width) : half_width_(0.5 * width / EndCosts::kStep) {
    const int half = std::min(kMost, static_cast<int>(half_width_));
    for (int offset = -half; offset <= half; ++offset) {
      passed_[static_cast<std::size_t>(offset + kMost)] = blurred_step(offset * EndCosts::kStep, width);
    }
  }

  /// `offset` [places] outwards of the edge, between its foot and its top.
  [[nodiscard]] double passed_at(int offset) const { return passed_[static_cast<std::size_t>(offset + kMost)]; }
  /// The first step of a profile that lies outwards of the foot of an edge at `place`; kSteps if none does.
  [[nodiscard]] std::size_t foot(int place) const { return step_at(place - half_width_); }
  /// The same for its top.
  [[nodiscard]] std::size_t top(int place) const { return step_at(place + half_width_); }

 private:
  static constexpr int kMost = kPerStep * static_cast<int>(kSteps);
  static_assert(kMost >= EndCosts::kReach - kBegin && kMost >= kBegin + kMost + EndCosts::kReach);

  static std::size_t step_at(double place) {
    return static_cast<std::size_t>(std::clamp(std::ceil((place - kBegin) / kPerStep), 0.0, 1.0 * kSteps));
  }

  double half_width_;  // [places]
  std::array<double, 2 * kMost + 1> passed_{};
};

/// Grey levels across a side, to be compared with fixtures that end at different places.
class SideFit {
 public:
  SideFit(const SideProfile& own, const std::optional<CeilingJoint>& joint) : own_(own) {
    for (std::size_t k = 0; k < kSteps; ++k) {
      const double share = joint ? joint->share_at(kInwards + SideProfile::kStep * static_cast<double>(k)) : 0.0;
      tile_[k] = 1.0 - share;
      of_joint_[k] = joint ? share * joint->grey : 0.0;
      inside_[k + 1] = inside_[k];
      inside_[k + 1].add(1.0, 0.0, own.grey[k]);
      outside_[k + 1] = outside_[k];
      outside_[k + 1].add(0.0, tile_[k], own.grey[k] - of_joint_[k]);
    }
  }

  /// Sum of squares that a fixture which ends at `place` leaves of the grey levels:
  /// grey = inside * (1 - passed) + passed * (tile * (1 - share) + joint * share), inside and tile by least squares.
  [[nodiscard]] double misfit(int place, const BlurredEdge& edge) const {
    const std::size_t first = edge.foot(place);  // before it all is inside ...
    const std::size_t last = edge.top(place);    // ... and from there on outside
    Sums sums = inside_[first];
    sums.add(outside_[kSteps], 1.0);
    sums.add(outside_[last], -1.0);
    for (std::size_t k = first; k < last; ++k) {
      const double beyond = edge.passed_at(kBegin + kPerStep * static_cast<int>(k) - place);
      sums.add(1.0 - beyond, beyond * tile_[k], own_.grey[k] - beyond * of_joint_[k]);
    }
    return sums.rest();
  }

 private:
  /// Of the shares that inside and tile have in the grey levels.
  struct Sums {
    double ii = 0.0;
    double it = 0.0;
    double tt = 0.0;
    double ig = 0.0;
    double tg = 0.0;
    double gg = 0.0;

    void add(double inside, double tile, double grey) {
      ii += inside * inside;
      it += inside * tile;
      tt += tile * tile;
      ig += inside * grey;
      tg += tile * grey;
      gg += grey * grey;
    }
    void add(const Sums& others, double sign) {
      ii += sign * others.ii;
      it += sign * others.it;
      tt += sign * others.tt;
      ig += sign * others.ig;
      tg += sign * others.tg;
      gg += sign * others.gg;
    }
    /// What both levels leave when each is as it fits best.
    [[nodiscard]] double rest() const {
      const double determinant = std::max(ii * tt - it * it, 1e-9);
      const double inside = (tt * ig - it * tg) / determinant;
      const double tile = (ii * tg - it * ig) / determinant;
      return std::max(0.0, gg - inside * ig - tile * tg);
    }
  };

  const SideProfile& own_;
  std::array<double, kSteps> tile_{};      // share of the tile where there is no fixture
  std::array<double, kSteps> of_joint_{};  // [grey] what the joint adds there
  // Over the first steps, if they are all inside or all outside of the fixture.
  std::array<Sums, kSteps + 1> inside_{};
  std::array<Sums, kSteps + 1> outside_{};
};

}  // namespace

std::optional<EndCosts> end_costs(const GreyView& image, const CeilingCamera& camera, const SideLine& side,
                                  double metres_per_px, double noise, const std::optional<CeilingJoint>& joint) {
  const SideProfile own = profile_of_side(image, camera, side);
  if (own.lines < kLeastLines) {
    return std::nullopt;
  }
  const SideFit fit(own, joint);
  EndCosts costs;
  double least = 1e18;
  for (std::size_t blur = 0; blur < EndCosts::kBlurs; ++blur) {
    const BlurredEdge edge(kWidths[blur] * metres_per_px);
    for (std::size_t place = 0; place < EndCosts::kPlaces; ++place) {
      const double misfit = fit.misfit(static_cast<int>(place) - EndCosts::kReach, edge);
      costs.cost[blur][place] = misfit;
      least = std::min(least, misfit);
    }
  }
  // What the best leaves of the grey levels is their noise, with texture and whatever else is there.
  const double variance = (joint ? kNotQuite : 1.0) * kCorrelation *
                          std::max(least / (kSteps - kUnknowns), kLeastShare * noise * noise / own.lines);
  for (auto& of_blur : costs.cost) {
    for (double& cost : of_blur) {
      cost /= variance;
    }
  }
  return costs;
}

void learn_blur(const EndCosts& side, BlurCosts& blurs) {
  BlurCosts least;
  for (std::size_t blur = 0; blur < least.size(); ++blur) {
    least[blur] = *std::min_element(side.cost[blur].begin(), side.cost[blur].end());
  }
  const double best = *std::min_element(least.begin(), least.end());
  for (std::size_t blur = 0; blur < blurs.size(); ++blur) {
    double cost = 1e18;
    for (std::size_t other = 0; other < least.size(); ++other) {
      const double apart = static_cast<double>(blur) - static_cast<double>(other);
      cost = std::min(cost, least[other] - best + kUnlike * apart * apart);
    }
    blurs[blur] += cost;
  }
}

std::optional<PlaceBetween> place_between(const EndCosts& positive, const EndCosts& negative, double half_size,
                                          const BlurCosts& blurs) {
  const double sigma = size_sigma(half_size);
  constexpr int kMostShift = EndCosts::kReach - kMostMisfit;
  return mean_place([&](std::size_t blur) {
    PlaceCosts costs;
    for (int shift = -kMostShift; shift <= kMostShift; ++shift) {
      double least = 1e18;
      for (int misfit = -kMostMisfit; misfit <= kMostMisfit; ++misfit) {
        least = std::min(least, positive.at(blur, misfit + shift) + negative.at(blur, misfit - shift) +
                                    std::pow(misfit * EndCosts::kStep / sigma, 2));
      }
      costs.add(least + blurs[blur]);
    }
    return costs;
  });
}

std::optional<PlaceBetween> place_of(const EndCosts& end, double half_size, const BlurCosts& blurs) {
  auto place = mean_place([&](std::size_t blur) {
    PlaceCosts costs;
    for (int at = -EndCosts::kReach; at <= EndCosts::kReach; ++at) {
      costs.add(end.at(blur, at) + blurs[blur]);
    }
    return costs;
  });
  if (place) {
    place->variance += size_sigma(half_size) * size_sigma(half_size);
  }
  return place;
}

}  // namespace luminav
