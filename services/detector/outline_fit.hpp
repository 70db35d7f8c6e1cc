#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/geometry/camera_model.hpp"
#include "services/common/geometry/pose2.hpp"
#include "services/common/image/grey_image.hpp"

namespace luminav {

/// Shape on a horizontal plane whose edges are looked for in the image.
struct Outline {
  FixtureShape shape = FixtureShape::kRectangle;
  double length = 1.2;  // [m] along x of the outline
  double width = 0.3;   // [m] along y
  double height = 2.8;  // [m] above the floor
};

/// Sides of an outline: two long ones, then the ends. A round outline has the first only.
enum Side { kLeftSide, kRightSide, kFarEnd, kNearEnd, kSides };

struct OutlineFitParams {
  bool inside_brighter = true;
  double least_edge = 10.0;        // [grey] step that counts as an edge
  double expected_step = 100.0;    // [grey] about what it should be: fainter ones are averaged over longer stretches
  double pixel_noise = 4.0;        // [grey] 1 sigma
  double swelling_sigma = 0.01;    // [m] how much wider than it is the outline may look, 1 sigma
  double taper_sigma = 0.01;       // [m/m] change of the swelling along the outline: bloom where the light differs
  double edge_sigma_px = 0.15;     // [px] least error of one edge point
  double outline_sigma_px = 0.06;  // [px] error that the points of a side share
  double vignetting = 0.3;         // share of the light that is lost in the image's corners
  int first_search_px = 11;        // [px] to each side of the start
};

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
  double residual_px = 0.0;                // [px] RMS distance of the edges found

  [[nodiscard]] double share(int side) const;
  [[nodiscard]] bool end_visible(int side) const;
  /// Share of the visible outline that shows an edge.
  [[nodiscard]] double quality() const;
};

/// Moves an outline onto the edges of an image: the outline is projected through the lens model, the image is searched
/// along its normals, and pose and swelling follow by weighted least squares (Harris 1990, "RAPID"). Pixels are never
/// resampled and lines never assumed straight. What the image does not show stays uncertain in the covariance: without
/// an end in view, the position along the outline.
class OutlineFitter {
 public:
  explicit OutlineFitter(const CeilingCamera& camera) : camera_(&camera) {}

  /// Nothing when too little of the outline is in view or shows edges.
  [[nodiscard]] std::optional<OutlineFit> fit(const GreyView& image, const Outline& outline,
                                              const OutlineFitParams& params, const Pose2& start);

 private:
  struct Point {
    Eigen::Vector2d place;   // [m] outline frame, on the outline
    Eigen::Vector2d normal;  // outward
    int side = 0;
    bool in_view = false;
    bool found = false;
    double offset = 0.0;  // [m] of the edge along the normal
    double offset_px = 0.0;
    double metres_per_px = 0.0;
    double step = 0.0;  // [grey]
  };
  struct Sampling {
    int search_px;      // to each side of the outline
    int half_filter;    // [px] whose means are compared
    int lines;          // [px] along the outline over which each profile is averaged
    double least_edge;  // [grey]
  };
  void take_joints_off(int reach);
  void place_points(const Outline& outline, double metres_per_px, double spacing_px);
  void measure(const GreyView& image, const Outline& outline, const OutlineFitParams& params, const Pose2& pose,
               double swelling, double taper, const Sampling& sampling);

  const CeilingCamera* camera_;
  std::vector<Point> points_;
  /// Mean of the profiles of each side, from inside to outside.
  std::array<std::array<float, 64>, kSides> side_profiles_{};
};

}  // namespace luminav
