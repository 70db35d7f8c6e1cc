#pragma once

#include <array>
#include <optional>

#include "services/detector/ceiling_joint.hpp"
#include "services/detector/side_profile.hpp"

namespace luminav {

/// How well the grey levels across one side of an unlit outline agree with a fixture that ends at each place: inside of
/// it there is the fixture's grey, outside of it the ceiling.
struct EndCosts {
  static constexpr double kStep = 0.0005;  // [m] from one place to the next
  static constexpr int kReach = 40;        // places to each side of the outline
  static constexpr std::size_t kPlaces = 2 * kReach + 1;
  static constexpr std::size_t kBlurs = 5;  // how soft the edge is

  std::array<std::array<double, kPlaces>, kBlurs> cost;  // chi squared

  [[nodiscard]] double at(std::size_t blur, int place) const {
    return cost[blur][static_cast<std::size_t>(kReach + place)];
  }
};

/// `joint`: what runs along the side. Nothing when too little is in view. `noise` [grey] of a pixel.
std::optional<EndCosts> end_costs(const GreyView& image, const CeilingCamera& camera, const SideLine& side,
                                  double metres_per_px, double noise, const std::optional<CeilingJoint>& joint);

/// What other sides say against each blur, chi squared; 0: nothing is known.
using BlurCosts = std::array<double, EndCosts::kBlurs>;
/// Adds what a side says. All sides of a fixture are about as soft, and beside a joint the softness of an edge cannot
/// be told from its place.
void learn_blur(const EndCosts& side, BlurCosts& blurs);

/// Where an outline of known size lies between two sides.
struct PlaceBetween {
  double shift = 0.0;     // [m] towards the positive side
  double variance = 0.0;  // [m^2]
};
/// `half_size` [m] from the middle to each of the sides. Nothing when it agrees best at the border of the search: then
/// the fixture's side is not what was seen.
std::optional<PlaceBetween> place_between(const EndCosts& positive, const EndCosts& negative, double half_size,
                                          const BlurCosts& blurs = {});
/// The same by one side alone, outwards, where the other is not in view.
std::optional<PlaceBetween> place_of(const EndCosts& end, double half_size, const BlurCosts& blurs = {});

}  // namespace luminav
