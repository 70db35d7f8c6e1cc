#pragma once

#include <optional>

#include "services/common/geometry/camera_model.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/side_profile.hpp"

namespace luminav {

/// A joint of the ceiling along a side, as it shows beyond the fixture's corners. It is as bright there as beside the
/// fixture; the tiles on both sides of it need not be.
struct CeilingJoint {
  double middle = 0.0;      // [m] outwards of the side
  double half_width = 0.0;  // [m]
  double blur = 0.0;        // [m] of its edges, foot to top
  double grey = 0.0;        // of the joint itself

  /// How much of what is seen `outside` [m] of the side is joint.
  [[nodiscard]] double share_at(double outside) const;
};

/// Fits tile, joint and tile to the mean profiles beyond both corners, near `guess` [m] outwards of the side. A mean of
/// many lines is still noisy: where a fixture hardly differs from the joint that would move it. Nothing when neither
/// corner is in view.
std::optional<CeilingJoint> fit_ceiling_joint(const GreyView& image, const CeilingCamera& camera, const SideLine& side,
                                              double guess, double metres_per_px);

}  // namespace luminav
