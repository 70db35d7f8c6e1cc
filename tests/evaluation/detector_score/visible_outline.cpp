#include "tests/evaluation/detector_score/visible_outline.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace luminav::score {
namespace {

using Eigen::Vector2d;

constexpr double kPatch = 0.1;      // [m] along the outline
constexpr double kFirst = 0.015;    // [m] from it: a line of the grid may run along it
constexpr double kSpacing = 0.005;  // [m] between samples, about a pixel
constexpr int kDeep = 6;            // samples across a patch
constexpr int kLong = 20;           // along it

/// A part of the outline in the fixture's frame.
struct Stretch {
  Vector2d middle;
  Vector2d outwards;
};

std::vector<Stretch> stretches_of(const Fixture& fixture) {
  std::vector<Stretch> stretches;
  if (fixture.shape == FixtureShape::kRound) {
    const int count = std::max(4, static_cast<int>(kPi * fixture.length / kPatch));
    for (int i = 0; i < count; ++i) {
      const Vector2d outwards(std::cos(2.0 * kPi * i / count), std::sin(2.0 * kPi * i / count));
      stretches.push_back({0.5 * fixture.length * outwards, outwards});
    }
    return stretches;
  }
  const auto add_sides = [&](double extent, double apart, const Vector2d& along, const Vector2d& outwards) {
    const int count = std::max(1, static_cast<int>(extent / kPatch));
    for (int i = 0; i < count; ++i) {
      for (const double side : {1.0, -1.0}) {
        stretches.push_back(
            {extent * ((i + 0.5) / count - 0.5) * along + 0.5 * side * apart * outwards, side * outwards});
      }
    }
  };
  add_sides(fixture.length, fixture.width, Vector2d::UnitX(), Vector2d::UnitY());
  add_sides(fixture.width, fixture.length, Vector2d::UnitY(), Vector2d::UnitX());
  return stretches;
}

}  // namespace

double seen_share(const GreyView& image, const CeilingCamera& camera, const Fixture& fixture,
                  const Pose2& robot_from_fixture) {
  const double breadth = std::min({kPatch, fixture.width, fixture.length});
  const auto mean_of = [&](const Stretch& stretch, double side) -> std::optional<double> {
    const Vector2d along(-stretch.outwards.y(), stretch.outwards.x());
    double sum = 0.0;
    for (int i = 0; i < kLong; ++i) {
      for (int k = 0; k < kDeep; ++k) {
        const Vector2d place = stretch.middle + breadth * ((i + 0.5) / kLong - 0.5) * along +
                               side * (kFirst + kSpacing * k) * stretch.outwards;
        const auto pixel = camera.pixel_of_ceiling_point(robot_from_fixture * place, fixture.height);
        if (!pixel || !camera.is_in_image(*pixel, 1.0)) {
          return std::nullopt;
        }
        const auto column = static_cast<std::size_t>(std::lround(pixel->x()));
        sum += image.pixels[static_cast<std::size_t>(std::lround(pixel->y())) * static_cast<std::size_t>(image.width) +
                            column];
      }
    }
    return sum / (kLong * kDeep);
  };
  int in_image = 0;
  int seen = 0;
  for (const Stretch& stretch : stretches_of(fixture)) {
    const auto inside = mean_of(stretch, -1.0);
    const auto outside = mean_of(stretch, 1.0);
    in_image += inside && outside ? 1 : 0;
    seen += inside && outside && std::abs(*inside - *outside) >= kSeenStep ? 1 : 0;
  }
  return in_image == 0 ? 0.0 : static_cast<double>(seen) / in_image;
}

}  // namespace luminav::score
