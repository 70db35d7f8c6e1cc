#include "services/detector/ceiling_joint.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "services/detector/blurred_edge.hpp"

namespace luminav {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kBeyondCorner = 0.025;  // [m] of the lines from the corner, where the other joint may cross
constexpr double kApart = 0.004;         // [m] between lines, about a pixel
constexpr int kMostLines = 64;           // beyond each corner
constexpr int kLeastLines = 8;
constexpr double kReach = 0.030;  // [m] of the profiles to both sides of the guess
constexpr std::size_t kSteps = 16;
constexpr double kStep = 0.0005;  // [m] from one place to the next
constexpr int kFarthest = 12;     // [places] from the guess
/// Width and depth of so thin a line cannot both be told: one of these fits, and then says how bright it is. One that
/// the lens blurs is taken narrower than it is: grey levels between pixels blur it once more.
struct JointShape {
  double half_width;  // [m]
  double blur_px;     // foot to top
};
constexpr std::array<JointShape, 3> kShapes{{{0.006, 2.0}, {0.005, 4.4}, {0.012, 4.4}}};

/// Tile, joint and tile of one profile.
struct LineFit {
  CeilingJoint joint;
  double misfit = 1e18;  // sum of squares
};

LineFit fit_at(const SideProfile& profile, double first, CeilingJoint joint) {
  Matrix3d normal = 1e-6 * Matrix3d::Identity();
  Vector3d right_side = Vector3d::Zero();
  double squares = 0.0;
  for (std::size_t k = 0; k < kSteps; ++k) {
    const double outside = first + SideProfile::kStep * static_cast<double>(k) - joint.middle;
    const double before = blurred_step(outside + joint.half_width, joint.blur);
    const double behind = blurred_step(outside - joint.half_width, joint.blur);
    const Vector3d shares(1.0 - before, behind, before - behind);
    normal += shares * shares.transpose();
    right_side += profile.grey[k] * shares;
    squares += profile.grey[k] * profile.grey[k];
  }
  const Vector3d greys = normal.inverse() * right_side;
  joint.grey = greys.z();
  return {joint, squares - greys.dot(right_side)};
}

LineFit fit_line(const SideProfile& profile, double guess, CeilingJoint joint) {
  std::array<LineFit, 2 * kFarthest + 1> fits;
  std::size_t best = 0;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    joint.middle = guess + kStep * (static_cast<double>(i) - kFarthest);
    fits[i] = fit_at(profile, guess - kReach, joint);
    best = fits[i].misfit < fits[best].misfit ? i : best;
  }
  LineFit line = fits[best];
  if (best > 0 && best + 1 < fits.size()) {
    const double before = fits[best - 1].misfit;
    const double behind = fits[best + 1].misfit;
    line.joint.middle += 0.5 * kStep * (before - behind) / std::max(before - 2.0 * line.misfit + behind, 1e-9);
  }
  return line;
}

using Corners = std::array<SideProfile, 2>;
using CornerFits = std::array<std::optional<LineFit>, 2>;

/// The joint beside the middle of the side, between what both corners' lines show: it may run askew to the side, and
/// the light may change along it.
CeilingJoint beside_middle(const Corners& corners, const CornerFits& fits, double half_length) {
  if (!fits[0] || !fits[1]) {
    return (fits[0] ? fits[0] : fits[1])->joint;
  }
  const auto reach = [&](std::size_t i) {  // [m] of the middle of a corner's lines, for that place it holds
    return half_length + kBeyondCorner + 0.5 * kApart * corners[i].lines;
  };
  const double second = reach(0) / (reach(0) + reach(1));
  CeilingJoint joint = fits[0]->joint;
  joint.middle += second * (fits[1]->joint.middle - joint.middle);
  joint.grey += second * (fits[1]->joint.grey - joint.grey);
  return joint;
}

}  // namespace

double CeilingJoint::share_at(double outside) const {
  return blurred_step(outside - middle + half_width, blur) - blurred_step(outside - middle - half_width, blur);
}

std::optional<CeilingJoint> fit_ceiling_joint(const GreyView& image, const CeilingCamera& camera, const SideLine& side,
                                              double guess, double metres_per_px) {
  Corners corners;
  for (const std::size_t i : {0, 1}) {
    const double corner = i == 0 ? 1.0 : -1.0;
    corners[i] = mean_profile(image, camera, side,
                              {.first = guess - kReach,
                               .steps = kSteps,
                               .from = corner * (side.half_length + kBeyondCorner),
                               .apart = corner * kApart,
                               .count = kMostLines});
  }
  std::optional<CeilingJoint> best;
  double least = 1e18;
  for (const JointShape& shape : kShapes) {
    const CeilingJoint start{.half_width = shape.half_width, .blur = shape.blur_px * metres_per_px};
    CornerFits fits;
    double misfit = 0.0;
    for (const std::size_t i : {0, 1}) {
      if (corners[i].lines >= kLeastLines) {
        fits[i] = fit_line(corners[i], guess, start);
        misfit += corners[i].lines * fits[i]->misfit;
      }
    }
    if ((fits[0] || fits[1]) && misfit < least) {
      least = misfit;
      best = beside_middle(corners, fits, side.half_length);
    }
  }
  return best;
}

}  // namespace luminav
