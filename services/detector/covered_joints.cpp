#include "services/detector/covered_joints.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr int kBegin = -72;                            // [places] outwards of the outline, where profiles begin ...
constexpr std::size_t kSteps = 18;                     // ... and how long they are: as far as joints are looked for
constexpr int kPerStep = 8;                            // places from one grey level of a profile to the next
constexpr double kInwards = kBegin * EndCosts::kStep;  // [m]
constexpr double kFromCorner = 0.012;                  // [m] of the side's lines from its corners, which blur rounds
constexpr double kBeyondCorner = 0.025;                // [m] of the lines beyond them, where the other joint may cross
constexpr double kApart = 0.004;                       // [m] between lines on the side, about a pixel ...
constexpr double kApartBeyond = 0.004;                 // ... and beyond its corners
constexpr int kLeastLines = 8;                         // on the side, and beyond its corners
constexpr int kBeyond = 64;                            // lines beyond each corner
constexpr std::array<double, EndCosts::kBlurs> kWidths{3.4, 4.5, 6.0, 8.0, 12.0};  // [px] of an edge, foot to top
constexpr double kUnknowns = 4.0;                                                  // inside, outside, place and blur
constexpr double kCorrelation = 1.8;  // neighbouring samples are alike: chi squared counts that much less
constexpr double kLeastShare = 0.3;   // of a pixel's variance that a line has
constexpr double kMisfit = 0.0003;    // [m] by which a size may be off ...
constexpr double kScale = 0.001;      // ... plus this share of half the size
constexpr int kMostMisfit = 4;        // places

/// How much of a blurred edge's far side is seen, `outside` [m] of it.
double passed(double outside, double width) {
  const double t = std::clamp(0.5 + outside / width, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

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
/// another place. `costs_of(blur)` are those of each place. Nothing when a place at the border of the search is best,
/// for what lies beyond may be better.
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

using Greys = std::array<double, kSteps>;

SideProfile profile_of_side(const GreyView& image, const CeilingCamera& camera, const SideLine& side) {
  const double usable = 2.0 * (side.half_length - kFromCorner);
  const int count = std::clamp(static_cast<int>(usable / kApart) + 1, 2, SideProfile::kMostLines);
  return mean_profile(
      image, camera, side,
      {.first = kInwards, .steps = kSteps, .from = -0.5 * usable, .apart = usable / (count - 1), .count = count});
}

/// The ceiling beyond both corners of a side.
struct CeilingBeyond {
  Greys grey{};
  int lines = 0;
};

CeilingBeyond ceiling_beyond_corners(const GreyView& image, const CeilingCamera& camera, const SideLine& side) {
  CeilingBeyond ceiling;
  for (const double corner : {1.0, -1.0}) {
    const SideProfile beyond = mean_profile(image, camera, side,
                                            {.first = kInwards,
                                             .steps = kSteps,
                                             .from = corner * (side.half_length + kBeyondCorner),
                                             .apart = corner * kApartBeyond,
                                             .count = kBeyond});
    for (std::size_t k = 0; k < kSteps; ++k) {
      ceiling.grey[k] += beyond.lines * beyond.grey[k];
    }
    ceiling.lines += beyond.lines;
  }
  for (double& grey : ceiling.grey) {
    grey /= std::max(ceiling.lines, 1);
  }
  return ceiling;
}

/// How much of a blurred edge's far side is seen at each place beside it: all profiles ask for the same places.
class BlurredEdge {
  static_assert(kPerStep * EndCosts::kStep == SideProfile::kStep);

 public:
  /// `width` [m] from foot to top.
  explicit BlurredEdge(double width) : half_width_(0.5 * width / EndCosts::kStep) {
    const int half = std::min(kMost, static_cast<int>(half_width_));
    for (int offset = -half; offset <= half; ++offset) {
      passed_[static_cast<std::size_t>(offset + kMost)] = passed(offset * EndCosts::kStep, width);
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
  SideFit(const SideProfile& own, const CeilingBeyond& ceiling) : own_(own), ceiling_(ceiling) {
    for (std::size_t k = 0; k < kSteps; ++k) {
      const double g = own.grey[k];
      const double c = ceiling.grey[k];
      g_[k + 1] = g_[k] + g;
      cc_[k + 1] = cc_[k] + c * c;
      cg_[k + 1] = cg_[k] + c * g;
      gg_ += g * g;
    }
  }

  /// Sum of squares that a fixture which ends at `place` leaves of the grey levels:
  /// grey = inside * (1 - passed) + gain * passed * ceiling, inside and gain by least squares.
  [[nodiscard]] double misfit(int place, const BlurredEdge& edge) const {
    const std::size_t first = edge.foot(place);  // before it all is inside ...
    const std::size_t last = edge.top(place);    // ... and from there on outside
    auto ii = static_cast<double>(first);
    double ic = 0.0;
    double cc = cc_[kSteps] - cc_[last];
    double ig = g_[first];
    double cg = cg_[kSteps] - cg_[last];
    for (std::size_t k = first; k < last; ++k) {
      const double beyond = edge.passed_at(kBegin + kPerStep * static_cast<int>(k) - place);
      const double i = 1.0 - beyond;
      const double c = beyond * ceiling_.grey[k];
      const double g = own_.grey[k];
      ii += i * i;
      ic += i * c;
      cc += c * c;
      ig += i * g;
      cg += c * g;
    }
    const double determinant = std::max(ii * cc - ic * ic, 1e-9);
    const double inside = (cc * ig - ic * cg) / determinant;
    const double gain = (ii * cg - ic * ig) / determinant;
    return std::max(0.0, gg_ - inside * ig - gain * cg);
  }

 private:
  const SideProfile& own_;
  const CeilingBeyond& ceiling_;
  // Sums of the grey levels, of the ceiling's squared and of their products over the first steps.
  std::array<double, kSteps + 1> g_{};
  std::array<double, kSteps + 1> cc_{};
  std::array<double, kSteps + 1> cg_{};
  double gg_ = 0.0;
};

}  // namespace

std::optional<EndCosts> end_costs(const GreyView& image, const CeilingCamera& camera, const SideLine& side,
                                  double metres_per_px, double noise, CeilingOutside outside) {
  const SideProfile own = profile_of_side(image, camera, side);
  if (own.lines < kLeastLines) {
    return std::nullopt;
  }
  CeilingBeyond ceiling;
  if (outside == CeilingOutside::kEven) {
    ceiling.grey.fill(1.0);
  } else {
    ceiling = ceiling_beyond_corners(image, camera, side);
    if (ceiling.lines < kLeastLines) {
      return std::nullopt;
    }
  }
  const SideFit fit(own, ceiling);
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
  const double variance =
      kCorrelation * std::max(least / (kSteps - kUnknowns), kLeastShare * noise * noise / own.lines);
  for (auto& of_blur : costs.cost) {
    for (double& cost : of_blur) {
      cost /= variance;
    }
  }
  return costs;
}

std::optional<PlaceBetween> place_between(const EndCosts& positive, const EndCosts& negative, double half_size) {
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
      costs.add(least);
    }
    return costs;
  });
}

std::optional<PlaceBetween> place_of(const EndCosts& end, double half_size) {
  auto place = mean_place([&](std::size_t blur) {
    PlaceCosts costs;
    for (int at = -EndCosts::kReach; at <= EndCosts::kReach; ++at) {
      costs.add(end.at(blur, at));
    }
    return costs;
  });
  if (place) {
    place->variance += size_sigma(half_size) * size_sigma(half_size);
  }
  return place;
}

}  // namespace luminav
