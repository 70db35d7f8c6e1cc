#include "services/detector/sampling/mean_profile.hpp"

#include <algorithm>

#include "services/detector/sampling/pixel_sampling.hpp"

namespace luminav {

using Eigen::Vector2d;

SideProfile mean_profile(const GreyView& image, const CeilingCamera& camera, const SideLine& side,
                         const ProfileLines& lines) {
  SideProfile profile;
  profile.steps = std::min(SideProfile::kMaxSteps, lines.steps);
  const PointTransform pose(side.pose);
  const double length = SideProfile::kStep * static_cast<double>(profile.steps - 1);
  const int count = std::min(SideProfile::kMaxLines, lines.count);
  std::array<Vector2d, 2 * SideProfile::kMaxLines> places;
  for (int i = 0; i < count; ++i) {
    const Vector2d place = (lines.from + lines.apart * i) * side.along;
    places[static_cast<std::size_t>(2 * i)] = pose * (place + lines.first * side.out);
    places[static_cast<std::size_t>(2 * i + 1)] = pose * (place + (lines.first + length) * side.out);
  }
  std::array<Vector2d, 2 * SideProfile::kMaxLines> pixels;
  const auto used = static_cast<std::size_t>(2 * count);
  camera.pixels_of_ceiling_points({places.data(), used}, side.height, {pixels.data(), used});
  for (std::size_t i = 0; i < used; i += 2) {
    if (!is_sampled(image, pixels[i]) || !is_sampled(image, pixels[i + 1])) {  // also where there is no pixel
      continue;
    }
    const Vector2d step = (pixels[i + 1] - pixels[i]) / static_cast<double>(profile.steps - 1);
    for (std::size_t k = 0; k < profile.steps; ++k) {
      const Vector2d at = pixels[i] + static_cast<double>(k) * step;
      profile.grey[k] += static_cast<double>(bilinear(image, static_cast<float>(at.x()), static_cast<float>(at.y())));
    }
    ++profile.lines;
  }
  for (double& mean : profile.grey) {
    mean /= std::max(profile.lines, 1);
  }
  return profile;
}

}  // namespace luminav
