#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>

#include "services/common/geometry/camera_model.hpp"
#include "services/common/geometry/pose2.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/outline.hpp"

namespace luminav {

/// What opposite sides differ by, as a function of the place along them and the distance from them.
struct Differences {
  static constexpr int kStretches = 8;   // of a pair of sides, each averaged
  static constexpr int kInside = 3;      // [px] of a profile that lie inside the outline as it looks ...
  static constexpr int kDistances = 15;  // ... of its pixels
  static constexpr int kLeast = 40;      // with fewer there is nothing to balance

  std::array<std::array<float, kDistances>, kStretches> value{};  // [grey]
  std::array<std::array<bool, kDistances>, kStretches> valid{};
  std::array<double, kStretches> place{};                // [m] along the sides
  std::array<std::array<double, kDistances>, 2> fall{};  // [grey/px] outwards, of the positive and the negative side
  double apart = 0.0;                                    // [px] from the one side to the other
  int lines = 1;                                         // of a stretch
  int count = 0;                                         // of those that are valid
};

/// What becomes of saturated samples.
enum class Saturated {
  kCutOff,   // both sides are cut off equally high above their ceilings, saturated or not
  kLeftOut,  // with the opposite sample
};

struct StretchLines;

/// Two opposite sides of a lit outline, to compare the light that falls off outwards from them.
class OppositeSides {
 public:
  static constexpr std::size_t kMostLines = 6;  // profiles in a stretch

  /// `along` is the direction of the sides in the outline's frame, `out` the normal of the positive one.
  OppositeSides(const GreyView& image, const CeilingCamera& camera, const Outline& outline, double vignetting,
                const Eigen::Vector2d& along, const Eigen::Vector2d& out, double length, double half_width)
      : image_(image),
        camera_(camera),
        height_(outline.height),
        vignetting_(vignetting),
        along_(along),
        out_(out),
        length_(length),
        half_width_(half_width) {}

  /// Profiles outwards from both sides, `step` [m] between samples, vignetting undone. Saturation begins nearer to a
  /// lamp on the side with the darker ceiling; cut off, the sides differ but by what the ceilings do and by where the
  /// lamp is, up to its steep edge. Where the ceiling beyond the bloom is out of view saturated samples are always left
  /// out.
  [[nodiscard]] Differences measure(const Pose2& robot_from_outline, double step, Saturated saturated) const;

  /// Takes off the differences what the ceiling differs by where it shows beyond the corners, `from_corner` [m] and
  /// farther: its joints, which lie beside the sides as well. False, and no change, where no corner shows both sides.
  bool take_ceiling_off(const Pose2& robot_from_outline, double step, double from_corner,
                        Differences& differences) const;

 private:
  /// A profile outwards from one side.
  struct LineEnds {
    Eigen::Vector2d first;    // [px]
    Eigen::Vector2d advance;  // [px] from one distance to the next
    std::size_t in_view = 0;  // distances from the first on
  };
  /// `count` lines in each stretch, evenly along both sides, by turns.
  void project(const PointTransform& pose, double usable, double step, std::size_t count,
               std::span<LineEnds> lines) const;
  /// Those pairs that are in view, `count` lines of each side in a stretch.
  void place_lines(std::span<const LineEnds> lines, std::size_t count,
                   std::array<StretchLines, Differences::kStretches>& stretches) const;

  const GreyView& image_;
  const CeilingCamera& camera_;
  double height_;
  double vignetting_;
  Eigen::Vector2d along_;
  Eigen::Vector2d out_;
  double length_;
  double half_width_;
};

}  // namespace luminav
