#include "services/mapper/sonar/turning_direction.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace luminav {

Eigen::Vector2d unit_vector(double angle) {
  struct Kept {
    std::uint64_t angle = 0;  // its bits
    double x = 1.0;
    double y = 0.0;
  };
  constexpr std::size_t kKept = 64;
  constinit static thread_local std::array<Kept, kKept> kept{};  // there from the start: nobody asks whether it is
  const auto bits = std::bit_cast<std::uint64_t>(angle);
  Kept& place = kept[bits * 0x9E3779B97F4A7C15ULL >> 58];
  static_assert(kKept == std::size_t{1} << (64 - 58));
  if (place.angle != bits) {
    place = {bits, std::cos(angle), std::sin(angle)};
  }
  return {place.x, place.y};
}

}  // namespace luminav
