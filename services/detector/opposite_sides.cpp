#include "services/detector/opposite_sides.hpp"

#include <algorithm>
#include <array>

#include "services/detector/pixel_sampling.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr int kLinesPerStretch = 6;  // profiles in a stretch
constexpr float kSaturated = 250.0F;
constexpr double kCorner = 6.0;  // [px] from a corner nothing is compared

}  // namespace

Differences OppositeSides::measure(const Pose2& robot_from_outline, double step) const {
  constexpr int kStretches = Differences::kStretches;
  Differences result;
  const PointTransform pose(robot_from_outline);
  const double usable = length_ - 2.0 * std::min(kCorner * step, 0.2 * length_);
  std::array<std::array<double, kDistances>, 2> falls{};
  std::array<int, kDistances> count{};
  for (int s = 0; s < kStretches; ++s) {
    const auto stretch = static_cast<std::size_t>(s);
    result.place[stretch] = usable * ((s + 0.5) / kStretches - 0.5);
    std::array<float, kDistances> difference{};
    std::array<int, kDistances> lines{};
    for (int line = 0; line < kLinesPerStretch; ++line) {
      const double place = usable * ((s * kLinesPerStretch + line + 0.5) / (kStretches * kLinesPerStretch) - 0.5);
      std::array<std::array<float, kDistances>, 2> light;
      if (!profile(pose, place, 1.0, step, light[0]) || !profile(pose, place, -1.0, step, light[1])) {
        continue;
      }
      const auto is_valid = [&](std::size_t k) { return light[0][k] >= 0.0F && light[1][k] >= 0.0F; };
      for (std::size_t k = 0; k < kDistances; ++k) {
        if (is_valid(k)) {
          difference[k] += light[0][k] - light[1][k];
          ++lines[k];
        }
        const std::size_t before = k > 0 ? k - 1 : k;
        const std::size_t after = k + 1 < kDistances ? k + 1 : k;
        const std::size_t inner = is_valid(before) ? before : k;
        if (is_valid(k) && is_valid(after)) {
          for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
            falls[side][k] += (light[side][inner] - light[side][after]) / static_cast<float>(after - inner);
          }
          ++count[k];
        }
      }
    }
    for (std::size_t k = 0; k < kDistances; ++k) {
      result.valid[stretch][k] = 2 * lines[k] > kLinesPerStretch;
      if (result.valid[stretch][k]) {
        result.value[stretch][k] = difference[k] / static_cast<float>(lines[k]);
        ++result.count;
      }
    }
  }
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    for (std::size_t k = 0; k < kDistances; ++k) {
      result.fall[side][k] = count[k] > 0 ? falls[side][k] / count[k] : 0.0;
    }
  }
  return result;
}

bool OppositeSides::profile(const PointTransform& pose, double place, double side, double step,
                            std::array<float, kDistances>& light) const {
  constexpr double kAhead = 0.02;  // [m]
  const Vector2d on_edge = place * along_ + side * half_width_ * out_;
  const auto pixel = camera_.pixel_of_ceiling_point(pose * on_edge, height_);
  const auto ahead = camera_.pixel_of_ceiling_point(pose * (on_edge + kAhead * side * out_), height_);
  if (!pixel || !ahead) {
    return false;
  }
  const Vector2d advance = (*ahead - *pixel) * (step / kAhead);
  const Vector2d first = *pixel - Differences::kInside * advance;
  if (!is_sampled(image_, first) || !is_sampled(image_, first + (kDistances - 1) * advance)) {
    return false;
  }
  const Vector2d size(image_.width, image_.height);
  const double corner = 0.25 * size.squaredNorm();
  for (int k = 0; k < kDistances; ++k) {
    const Vector2d at = first + k * advance;
    const float grey = bilinear(image_, static_cast<float>(at.x()), static_cast<float>(at.y()));
    const double gain = 1.0 - vignetting_ * (at - 0.5 * size).squaredNorm() / corner;
    light[static_cast<std::size_t>(k)] = grey > kSaturated ? -1.0F : grey / static_cast<float>(gain);
  }
  return true;
}

}  // namespace luminav
