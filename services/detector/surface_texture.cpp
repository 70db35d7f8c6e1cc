#include "services/detector/surface_texture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "services/detector/pixel_sampling.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr double kRim = 0.045;    // [m] beside an edge: blur, and a vent's plain frame
constexpr double kStep = 0.0075;  // [m] between the places of a profile: slats are 25 mm apart and more
constexpr int kWindow = 4;        // places to each side whose mean is taken off: shading is smoother than slats
constexpr int kMostPlaces = 64;
constexpr int kLines = 48;         // averaged
constexpr double kSmooth = 0.16;   // of the step at the edges; slats of a vent reach 0.3
constexpr double kCertain = 0.18;  // of the step: more noise than that leaves it open

struct Stretch {
  double from = 0.0;
  double to = 0.0;
};

/// Deviation of a profile from its own smooth course [grey]; negative when too little of it is in view.
template <typename PlaceOf>
double roughness(const GreyView& image, const CeilingCamera& camera, const Outline& outline, const Pose2& pose,
                 const Stretch& along, const Stretch& across, PlaceOf place_of) {
  const PointTransform to_robot(pose);
  std::array<double, kMostPlaces> profile{};
  const int places = std::min(kMostPlaces, static_cast<int>((along.to - along.from) / kStep));
  int count = 0;
  for (int i = 0; i < places; ++i) {
    const double u = along.from + (i + 0.5) * kStep;
    double sum = 0.0;
    int sampled = 0;
    std::array<Vector2d, kLines> points;
    for (int line = 0; line < kLines; ++line) {
      const double v = across.from + (across.to - across.from) * (line + 0.5) / kLines;
      points[static_cast<std::size_t>(line)] = to_robot * place_of(u, v);
    }
    std::array<Vector2d, kLines> pixels;
    camera.pixels_of_ceiling_points(points, outline.height, pixels);
    for (const Vector2d& pixel : pixels) {
      if (is_sampled(image, pixel)) {
        sum += bilinear(image, static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
        ++sampled;
      }
    }
    if (2 * sampled < kLines) {
      if (count > 2 * kWindow) {
        break;
      }
      count = 0;
      continue;
    }
    profile[static_cast<std::size_t>(count++)] = sum / sampled;
  }
  if (count < 2 * kWindow + 4) {
    return -1.0;
  }
  double squares = 0.0;
  int used = 0;
  for (int i = kWindow; i + kWindow < count; ++i) {
    double mean = 0.0;
    for (int k = -kWindow; k <= kWindow; ++k) {
      mean += profile[static_cast<std::size_t>(i + k)];
    }
    squares += std::pow(profile[static_cast<std::size_t>(i)] - mean / (2 * kWindow + 1), 2);
    ++used;
  }
  return std::sqrt(squares / used);
}

}  // namespace

bool is_surely_smooth(const GreyView& image, const CeilingCamera& camera, const Outline& outline, const OutlineFit& fit,
                      double pixel_noise) {
  const Stretch along{fit.visible_from + kRim, fit.visible_to - kRim};
  const Stretch across{kRim - 0.5 * outline.width, 0.5 * outline.width - kRim};
  const double noise = pixel_noise / std::sqrt(1.0 * kLines);
  if (noise > kCertain * fit.step) {
    return false;
  }
  const Pose2& pose = fit.robot_from_outline;
  const double lengthwise =
      roughness(image, camera, outline, pose, along, across, [](double u, double v) { return Vector2d(u, v); });
  const double crosswise =
      roughness(image, camera, outline, pose, across, along, [](double u, double v) { return Vector2d(v, u); });
  return lengthwise >= 0.0 && crosswise >= 0.0 &&
         std::max(lengthwise, crosswise) < std::hypot(kSmooth * fit.step, noise);
}

}  // namespace luminav
