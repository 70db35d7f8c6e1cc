#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "services/common/geometry/camera_model.hpp"
#include "services/common/geometry/pose2.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/outline.hpp"
#include "services/detector/outline_edges.hpp"

namespace luminav {

/// Change of a lit outline's swelling along it [m/m], 1 sigma, where one long side alone is seen.
inline constexpr double kOneSideTaper = 0.005;

struct OutlineFit {
  Pose2 robot_from_outline;
  double swelling = 0.0;                // [m] by which the edges lie outside the outline, on every side
  Eigen::Matrix3d covariance;           // along, across, theta in the outline's frame
  std::array<int, kSides> in_view{};    // edge points whose surroundings are in the image
  std::array<int, kSides> on_edge{};    // of these, how many lie on an edge
  std::array<int, kSides> expected{};   // of the whole outline
  std::array<int, 2> corner_in_view{};  // points of both long sides next to the far, the near end
  std::array<int, 2> corner_on_edge{};
  double visible_from = 0.0;               // [m] x along the outline: what of the long sides is in the image
  double visible_to = 0.0;                 // [m]
  double step = 0.0;                       // [grey] mean height of the edges found
  std::array<double, kSides> side_step{};  // [grey] mean of each side's
  std::array<double, kSides> side_edge{};  // [m] median of each side's edges, outwards of the outline
  double metres_per_px = 0.0;              // there, about
  double residual_px = 0.0;                // [px] RMS distance of the edges found

  [[nodiscard]] double share(int side) const;
  [[nodiscard]] bool end_visible(int side) const;
  /// The long side in view where the other one is not; nothing when both or none are, or when it is round.
  [[nodiscard]] std::optional<Side> only_side() const;
  /// Share of the visible outline that shows an edge.
  [[nodiscard]] double quality() const;
};

/// Moves an outline onto the edges of an image: the outline is projected through the lens model, the image is searched
/// along its normals, and pose and swelling follow by weighted least squares (Harris 1990, "RAPID"). Pixels are never
/// resampled and lines never assumed straight. What the image does not show stays uncertain in the covariance: without
/// an end in view, the position along the outline.
class OutlineFitter {
 public:
  explicit OutlineFitter(const CeilingCamera& camera) : camera_(&camera), edges_(camera) {}

  /// Nothing when too little of the outline is in view or shows edges.
  [[nodiscard]] std::optional<OutlineFit> fit(const GreyView& image, const Outline& outline,
                                              const OutlineFitParams& params, const Pose2& start);

 private:
  const CeilingCamera* camera_;
  OutlineEdges edges_;
};

}  // namespace luminav
