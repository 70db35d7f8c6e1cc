#include "services/detector/opposite_sides.hpp"

#include <algorithm>
#include <array>

#include "services/common/geometry/vector_clones.hpp"
#include "services/detector/pixel_sampling.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr int kStretches = Differences::kStretches;
constexpr int kDistances = Differences::kDistances;
constexpr int kLinesPerStretch = 6;  // profiles in a stretch
constexpr int kLines = kStretches * kLinesPerStretch;
constexpr int kPadded = OppositeSides::kPadded;
constexpr float kSaturated = 250.0F;
constexpr double kCorner = 6.0;  // [px] from a corner nothing is compared

/// Over the lines of one stretch.
struct DifferenceSums {
  alignas(32) std::array<float, kPadded> difference{};
  alignas(32) std::array<int, kPadded> lines{};
};

/// Over all lines.
struct Falls {
  alignas(32) std::array<std::array<double, kPadded>, 2> sum{};
  alignas(32) std::array<int, kPadded> count{};
};

LUMINAV_VECTOR_CLONES
void undo_vignetting(const double* x, const double* y, std::array<int, 2> size, double vignetting, float* light) {
  const double middle_x = 0.5 * size[0];
  const double middle_y = 0.5 * size[1];
  const double width = size[0];
  const double height = size[1];
  const double corner = 0.25 * (width * width + height * height);
  for (int k = 0; k < kPadded; ++k) {
    const double dx = x[k] - middle_x;
    const double dy = y[k] - middle_y;
    const double gain = 1.0 - vignetting * (dx * dx + dy * dy) / corner;
    light[k] = light[k] > kSaturated ? -1.0F : light[k] / static_cast<float>(gain);
  }
}

/// Adds what two opposite lines differ by and how the light falls along each, between the neighbours that are valid.
LUMINAV_VECTOR_CLONES
void compare(const OppositeSides::SideLights& lights, DifferenceSums& sums, Falls& falls) {
  // the first and the last are their own neighbours
  alignas(32) std::array<std::array<float, kPadded + 2>, 2> light;
  alignas(32) std::array<int, kPadded + 2> valid;
  for (std::size_t side = 0; side < 2; ++side) {
    for (std::size_t k = 0; k < kPadded; ++k) {
      light[side][k + 1] = lights[side][k];
    }
    light[side][0] = lights[side][0];
    light[side][kDistances + 1] = lights[side][kDistances - 1];
  }
  for (std::size_t k = 0; k < kPadded + 1; ++k) {
    valid[k] = (light[0][k] >= 0.0F) & (light[1][k] >= 0.0F) ? 1 : 0;
  }
  alignas(32) std::array<float, kPadded> from_before;  // [px] to the one after
  alignas(32) std::array<float, kPadded> from_here;
  from_before.fill(2.0F);
  from_here.fill(1.0F);
  from_before[0] = from_before[kDistances - 1] = 1.0F;
  from_here[kDistances - 1] = 0.0F;
  for (std::size_t k = 0; k < kDistances; ++k) {
    sums.difference[k] += valid[k + 1] != 0 ? light[0][k + 1] - light[1][k + 1] : 0.0F;
    sums.lines[k] += valid[k + 1];
    falls.count[k] += valid[k + 1] & valid[k + 2];
  }
  for (std::size_t side = 0; side < 2; ++side) {
    for (std::size_t k = 0; k < kDistances; ++k) {
      const float inner = valid[k] != 0 ? light[side][k] : light[side][k + 1];
      const float apart = valid[k] != 0 ? from_before[k] : from_here[k];
      const float fall = (inner - light[side][k + 2]) / apart;
      falls.sum[side][k] += (valid[k + 1] & valid[k + 2]) != 0 ? static_cast<double>(fall) : 0.0;
    }
  }
}

}  // namespace

Differences OppositeSides::measure(const Pose2& robot_from_outline, double step) const {
  Differences result;
  const double usable = length_ - 2.0 * std::min(kCorner * step, 0.2 * length_);
  std::array<LineEnds, 2 * kLines> lines;
  project(PointTransform(robot_from_outline), usable, step, lines);
  Falls falls;
  for (int s = 0; s < kStretches; ++s) {
    const auto stretch = static_cast<std::size_t>(s);
    result.place[stretch] = usable * ((s + 0.5) / kStretches - 0.5);
    DifferenceSums sums;
    for (std::size_t line = stretch * kLinesPerStretch; line < (stretch + 1) * kLinesPerStretch; ++line) {
      if (!lines[2 * line].is_in_view || !lines[2 * line + 1].is_in_view) {
        continue;
      }
      SideLights lights;
      for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
        light_along(lines[2 * line + side], lights[side]);
      }
      compare(lights, sums, falls);
    }
    for (std::size_t k = 0; k < kDistances; ++k) {
      result.valid[stretch][k] = 2 * sums.lines[k] > kLinesPerStretch;
      if (result.valid[stretch][k]) {
        result.value[stretch][k] = sums.difference[k] / static_cast<float>(sums.lines[k]);
        ++result.count;
      }
    }
  }
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    for (std::size_t k = 0; k < kDistances; ++k) {
      result.fall[side][k] = falls.count[k] > 0 ? falls.sum[side][k] / falls.count[k] : 0.0;
    }
  }
  return result;
}

void OppositeSides::project(const PointTransform& pose, double usable, double step, std::span<LineEnds> lines) const {
  constexpr double kAhead = 0.02;  // [m]
  std::array<Vector2d, 4 * kLines> points;
  for (int line = 0; line < kLines; ++line) {
    const double place = usable * ((line + 0.5) / kLines - 0.5);
    for (const int negative : {0, 1}) {
      const double side = negative == 0 ? 1.0 : -1.0;
      const Vector2d on_edge = place * along_ + side * half_width_ * out_;
      const auto i = static_cast<std::size_t>(4 * line + 2 * negative);
      points[i] = pose * on_edge;
      points[i + 1] = pose * (on_edge + kAhead * side * out_);
    }
  }
  std::array<Vector2d, 4 * kLines> pixels;
  camera_.pixels_of_ceiling_points(points, height_, pixels);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Vector2d& pixel = pixels[2 * i];
    LineEnds& line = lines[i];
    line.advance = (pixels[2 * i + 1] - pixel) * (step / kAhead);
    line.first = pixel - Differences::kInside * line.advance;
    // false as well where there is no pixel
    line.is_in_view =
        is_sampled(image_, line.first) && is_sampled(image_, line.first + (kDistances - 1) * line.advance);
  }
}

void OppositeSides::light_along(const LineEnds& line, Lights& light) const {
  alignas(32) std::array<double, kPadded> x;
  alignas(32) std::array<double, kPadded> y;
  alignas(32) std::array<float, kPadded> fx;
  alignas(32) std::array<float, kPadded> fy;
  for (int i = 0; i < kPadded; ++i) {
    const int k = std::min(i, kDistances - 1);
    const auto n = static_cast<std::size_t>(i);
    x[n] = line.first.x() + k * line.advance.x();
    y[n] = line.first.y() + k * line.advance.y();
    fx[n] = static_cast<float>(x[n]);
    fy[n] = static_cast<float>(y[n]);
  }
  bilinear_at(image_, fx.data(), fy.data(), kPadded, light.data());
  undo_vignetting(x.data(), y.data(), {image_.width, image_.height}, vignetting_, light.data());
}

}  // namespace luminav
