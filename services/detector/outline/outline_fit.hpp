#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "services/common/geometry/camera_model.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/outline/edge_search.hpp"
#include "services/detector/outline/outline.hpp"

namespace luminav {

struct OutlineFitParams {
  bool inside_brighter = true;
  double min_edge = 10.0;          // [grey] step that counts as an edge
  double expected_step = 100.0;    // [grey] about what it should be: fainter ones are averaged over longer stretches
  double pixel_noise = 4.0;        // [grey] 1 sigma
  double side_mean = 0.0;          // [m] by how much wider than its nominal size the outline looks on each side
  double side_sigma = 0.01;        // [m] 1 sigma of that
  double end_sigma = 0.008;        // [m] by how much more it may look longer on each end, 1 sigma
  double edge_sigma_px = 0.15;     // [px] least error of one edge point
  double outline_sigma_px = 0.06;  // [px] error that the points of a side share
  std::optional<Side> unseen{};    // long side that isn't looked at
};

/// What one side of a fitted outline shows.
struct SideEdges {
  int expected = 0;   // edge points of the whole outline
  int in_view = 0;    // of these, whose surroundings are in the image
  int on_edge = 0;    // of these, that lie on an edge
  double step = 0.0;  // [grey] mean height of the edges

  [[nodiscard]] double share() const { return in_view == 0 ? 0.0 : static_cast<double>(on_edge) / in_view; }
};

struct OutlineFit {
  OutlinePlacement placement;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  // along, across, theta in the outline's frame
  std::array<SideEdges, kSides> sides{};
  double visible_from = 0.0;   // [m] x along the outline: what of the long sides is in the image
  double visible_to = 0.0;     // [m]
  double metres_per_px = 0.0;  // there, about
  double residual_px = 0.0;    // [px] RMS distance of the edges found

  [[nodiscard]] double share(int side) const { return sides[static_cast<std::size_t>(side)].share(); }
  [[nodiscard]] double step() const;  // [grey] mean over all sides
  [[nodiscard]] bool end_visible(int side) const;
  /// Of two ends in view, takes the worse one for not in view when a smaller share of it shows an edge.
  void leave_out_end_below(double share_of_end);
  [[nodiscard]] int ends_visible() const { return (end_visible(kFarEnd) ? 1 : 0) + (end_visible(kNearEnd) ? 1 : 0); }
  /// The long side in view where the other one is not; nothing when both or none are, or when it is round.
  [[nodiscard]] std::optional<Side> only_side() const;
  /// Share of the visible outline that shows an edge.
  [[nodiscard]] double quality() const;
};

/// Moves an outline onto the edges of an image: pose, and how much wider and longer it looks, by weighted least squares
/// on edge points along its normals (Harris 1990, "RAPID"). What the image does not show stays uncertain in the
/// covariance: without an end in view, the position along the outline.
class OutlineFitter {
 public:
  explicit OutlineFitter(const CeilingCamera& camera) : camera_(&camera), edges_(camera) {}

  /// Nothing when too little of the outline is in view or shows edges.
  [[nodiscard]] std::optional<OutlineFit> fit(const GreyView& image, const Outline& outline,
                                              const OutlineFitParams& params, const OutlinePlacement& start);

 private:
  using Matrix5d = Eigen::Matrix<double, 5, 5>;
  using Vector5d = Eigen::Matrix<double, 5, 1>;
  /// Normal equations of along, across, theta, side outset, end outset; in edge sigmas squared.
  struct Equations {
    Matrix5d information = Matrix5d::Zero();
    Vector5d right_side = Vector5d::Zero();
    int used = 0;
  };

  /// False when a long side in view shows no edge.
  [[nodiscard]] bool measure(const GreyView& image, const EdgeSearchParams& search, std::optional<Side> unseen,
                             double cutoff_px);
  [[nodiscard]] Equations prior(const Outline& outline, const OutlineFitParams& params,
                                const OutlinePlacement& placement) const;
  void add_edges(double cutoff_px, Equations& equations) const;
  void describe_edges(const Outline& outline, double cutoff_px, OutlineFit& fit) const;
  [[nodiscard]] Eigen::Matrix3d covariance_of(const Outline& outline, const OutlineFitParams& params,
                                              const OutlineFit& fit, const Equations& prior,
                                              const Equations& equations) const;

  const CeilingCamera* camera_;
  EdgeSearch edges_;
  std::array<double, kSides> centre_px_{};  // median offset of each side's edges
  double metres_per_px_ = 0.005;
};

}  // namespace luminav
