#include "services/detector/validation/half_lit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "services/detector/sampling/mean_profile.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr int kLines = 10;           // across a band ...
constexpr int kMinLines = 5;         // ... in view
constexpr double kPitch = 0.12;      // [m] from one stretch to the next; they overlap, so that no line is lost between
constexpr double kFromEnd = 0.02;    // [m] from the strip's ends, where its bloom is rounded
constexpr std::size_t kReach = 5;    // steps from a line's middle to the ceiling beside it
constexpr std::size_t kApart = 2;    // steps by which a line may lie elsewhere on the other side of the strip
constexpr std::size_t kOblique = 8;  // steps within which one is looked for that does not run across the strip
constexpr double kMinDepth = 3.0;    // [grey]
constexpr double kMinSigmas = 3.5;   // of the mean of a band's lines
constexpr double kRibbed = 0.6;      // of the stretches
constexpr double kEnds = 0.3;        // of a line's depth: it does not go on
constexpr double kClearlyDarker = 6.0;  // [grey]

using Band = std::array<double, 2>;  // [widths of the strip] outwards of its edge
constexpr Band kBeside{0.30, 0.90};
constexpr Band kBeyond{1.15, 1.75};
constexpr Band kWithin{0.45, 0.75};  // of the width of the dark lamps, which lie there ...
constexpr Band kOutside{1.20, 1.50};

/// How much darker it is at a step of a profile than to both sides of it.
double depth_at(const SideProfile& profile, std::size_t k) {
  const auto& grey = profile.grey;
  const double before = 0.5 * (grey[k - kReach] + grey[k - kReach + 1]);
  const double after = 0.5 * (grey[k + kReach - 1] + grey[k + kReach]);
  return std::min(before, after) - (grey[k - 1] + grey[k] + grey[k + 1]) / 3.0;
}

struct GridLine {
  std::size_t step;
  double depth;  // [grey]
};

GridLine deepest(const SideProfile& profile, std::size_t first, std::size_t last) {
  GridLine line{first, -1e9};
  for (std::size_t k = std::max(first, kReach); k <= last && k + kReach < profile.steps; ++k) {
    const double depth = depth_at(profile, k);
    if (depth > line.depth) {
      line = {k, depth};
    }
  }
  return line;
}

/// An oblique line lies elsewhere on the other side, and tells nothing of it. `inner` and `outer` halves of a band.
bool runs_across(const GridLine& line, const SideProfile& inner, const SideProfile& outer) {
  const auto step_in = [&](const SideProfile& half) {
    const std::size_t from = line.step - std::min(line.step, kOblique);
    return static_cast<double>(deepest(half, from, line.step + kOblique).step);
  };
  return std::abs(step_in(inner) - step_in(outer)) <= 1.0;
}

/// Sums over the lines that are known to run towards a side.
struct Evidence {
  double known = 0.0;  // [grey]
  double seen = 0.0;
  int stretches = 0;  // of the side that are in view ...
  int lined = 0;      // ... and in which there is a line

  [[nodiscard]] bool is_covered() const { return seen < kEnds * known; }
  /// Tiles are longer than stretches, louvres have their ribs everywhere.
  [[nodiscard]] bool is_louvre() const { return stretches >= 2 && lined > kRibbed * stretches; }
};

}  // namespace

std::optional<int> find_darker_side(const GreyView& image, const CeilingCamera& camera, const Outline& strip,
                                    const OutlinePlacement& placement, double dark_width, double pixel_noise) {
  const double edge = 0.5 * strip.width + std::max(0.0, placement.side_outset);
  const auto mean_of = [&](const Band& band, double side) {
    const SideLine line{placement.pose, strip.height, Vector2d::UnitX(), side * Vector2d::UnitY()};
    const auto steps = static_cast<std::size_t>((band[1] - band[0]) * dark_width / SideProfile::kStep) + 2;
    const SideProfile profile = mean_profile(image, camera, line,
                                             {.first = edge + band[0] * dark_width,
                                              .steps = steps,
                                              .from = -0.45 * strip.length,
                                              .apart = 0.9 * strip.length / (SideProfile::kMaxLines - 1),
                                              .count = SideProfile::kMaxLines});
    const double sum = std::accumulate(profile.grey.begin(), profile.grey.end(), 0.0);
    return profile.lines < kMinLines ? std::nullopt : std::optional(sum / static_cast<double>(profile.steps));
  };
  int found = 0;
  bool is_seen = true;
  for (const int side : {1, -1}) {
    const auto near = mean_of(kWithin, side);
    const auto far = mean_of(kOutside, side);
    if (near && far && *near < *far - std::max({kClearlyDarker, 0.1 * *far, pixel_noise})) {
      found += side;
    }
    is_seen = is_seen && near && far;
  }
  return is_seen || found != 0 ? std::optional(found) : std::nullopt;
}

int find_covered_side(const GreyView& image, const CeilingCamera& camera, const Outline& strip,
                      const OutlinePlacement& placement, double pixel_noise) {
  const double edge = 0.5 * strip.width + std::max(0.0, placement.side_outset);
  const SideLine line{placement.pose, strip.height, Vector2d::UnitY(), Vector2d::UnitX()};
  const auto profile_of = [&](const Band& band, double side, double first) {
    return mean_profile(image, camera, line,
                        {.first = first,
                         .steps = SideProfile::kMaxSteps,
                         .from = side * (edge + band[0] * strip.width),
                         .apart = side * (band[1] - band[0]) * strip.width / (kLines - 1),
                         .count = kLines});
  };
  constexpr double kStretch = SideProfile::kStep * (SideProfile::kMaxSteps - 1);
  const int stretches = std::max(1, static_cast<int>((strip.length - 2.0 * kFromEnd - kStretch) / kPitch) + 1);
  std::array<Evidence, 2> evidence;
  for (int i = 0; i < stretches; ++i) {
    const double first = (i - 0.5 * (stretches - 1)) * kPitch - 0.5 * kStretch;
    const std::array<SideProfile, 2> beside{profile_of(kBeside, 1.0, first), profile_of(kBeside, -1.0, first)};
    const auto add = [&](const Band& band, double outwards) {
      const SideProfile source = profile_of(band, outwards, first);
      if (source.lines < kMinLines) {
        return false;
      }
      // Of a line at the end of a stretch only the flank may be in it, and over there less still.
      const GridLine deepest_line = deepest(source, kReach + 1, source.steps - kReach - 2);
      if (deepest_line.depth < std::max(kMinDepth, kMinSigmas * pixel_noise / std::sqrt(source.lines))) {
        return false;
      }
      const double middle = 0.5 * (band[0] + band[1]);
      if (!runs_across(deepest_line, profile_of({band[0], middle}, outwards, first),
                       profile_of({middle, band[1]}, outwards, first))) {
        evidence[outwards > 0.0 ? 0 : 1].seen += deepest_line.depth;  // whatever its direction, it is not covered
        return false;
      }
      for (std::size_t side = 0; side < 2; ++side) {
        if (beside[side].lines >= kMinLines) {
          evidence[side].known += deepest_line.depth;
          evidence[side].seen +=
              std::clamp(deepest(beside[side], deepest_line.step - kApart, deepest_line.step + kApart).depth, 0.0,
                         deepest_line.depth);
        }
      }
      return true;
    };
    for (std::size_t side = 0; side < 2; ++side) {
      evidence[side].stretches += beside[side].lines >= kMinLines ? 1 : 0;
      evidence[side].lined += add(kBeside, side == 0 ? 1.0 : -1.0) ? 1 : 0;
    }
    if (beside[0].lines < kMinLines || beside[1].lines < kMinLines) {
      add(kBeyond, 1.0);
      add(kBeyond, -1.0);
    }
  }
  if (evidence[0].is_louvre() != evidence[1].is_louvre()) {
    return evidence[0].is_louvre() ? 1 : -1;
  }
  return (evidence[0].is_covered() ? 1 : 0) - (evidence[1].is_covered() ? 1 : 0);
}

}  // namespace luminav
