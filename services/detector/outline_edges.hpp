#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "services/common/geometry/camera_model.hpp"
#include "services/common/geometry/pose2.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/outline.hpp"
#include "services/detector/profile_lanes.hpp"

namespace luminav {

/// A place on an outline, and the edge that was found near it.
struct OutlinePoint {
  Eigen::Vector2d place;   // [m] outline frame, on the outline
  Eigen::Vector2d normal;  // outward
  int side = 0;
  bool in_view = false;
  bool at_border = false;  // bloom may be as wide as what is in view outwards
  bool found = false;
  double offset = 0.0;  // [m] of the edge along the normal
  double offset_px = 0.0;
  double metres_per_px = 0.0;
  double step = 0.0;  // [grey]

  void take(double edge_offset_px, double edge_step) {
    found = true;
    offset_px = edge_offset_px;
    offset = offset_px * metres_per_px;
    step = edge_step;
  }
};

/// Where an outline is thought to be.
struct OutlinePlacement {
  Pose2 pose;             // robot_from_outline
  double swelling = 0.0;  // [m] by which it looks wider on every side
  double taper = 0.0;     // [m/m] change of that along it
};

/// By how much it was moved, in its own frame.
struct OutlineMove {
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  // [m]
  double turn = 0.0;                                // [rad]
  double swelling = 0.0;                            // [m]
  double taper = 0.0;                               // [m/m]
};

struct EdgeSearch {
  int search_px;      // to each side of the outline
  int half_filter;    // [px] whose means are compared
  int lines;          // [px] along the outline over which each profile is averaged
  double least_edge;  // [grey]
  int first_side = kLeftSide;
  int last_side = kNearEnd;
  std::size_t every = 1;  // so many points is one looked at: the others are as if out of view
};

/// Points of a long side without an edge that refute an outline.
inline constexpr int kLeastToRefute = 5;

/// Looks for the edges of an outline: grey profiles across it, and in each the largest step.
class OutlineEdges {
 public:
  explicit OutlineEdges(const CeilingCamera& camera) : camera_(&camera) {}

  /// Spreads points over the sides. Corners are left out, more of them at the ends of lit fixtures.
  void place(const Outline& outline, double metres_per_px, double spacing_px, bool lit);
  /// Finds the edge near each point of the sides searched that is in view.
  void measure(const GreyView& image, const Outline& outline, const OutlineFitParams& params,
               const OutlinePlacement& placement, const EdgeSearch& search);
  /// Edges as found before, seen from an outline that was moved a little since.
  void follow(const OutlineMove& move);
  [[nodiscard]] std::span<const OutlinePoint> points() const { return points_; }
  [[nodiscard]] std::span<const OutlinePoint> points_of(int side) const {
    return points().subspan(first_of(side), first_of(side + 1) - first_of(side));
  }
  [[nodiscard]] std::ptrdiff_t count_in_view(int side) const;
  /// True when the border may cut off the bloom of a side wherever the side is in view, but for less than
  /// `kLeastToRefute` points.
  [[nodiscard]] bool runs_along_border(int side) const;
  /// Takes a side to be out of view until edges are measured again.
  void leave_out(int side);

 private:
  static constexpr int kLongest = ProfileLanes::kLongest;
  using Profile = std::array<float, kLongest>;
  struct ViewedPoint {
    std::size_t index;  // in points_
    Eigen::Vector2d pixel;
    Eigen::Vector2d normal_px;  // of length 1
    int last;                   // index in a profile of the last pixel that is in view
  };
  struct Step {
    double offset_px;  // from the profile's middle
    double height;     // [grey]
  };
  /// Largest step between two means of `half_filter` pixels, by steepness; `weight` = sign and scale of the profile.
  static std::optional<Step> largest_step(const Profile& profile, int length, int half_filter, float weight, int first,
                                          int last);
  static Step vertex_at(int at, int reach, double before, double height, double behind);
  void look_at(const GreyView& image, const Outline& outline, const OutlinePlacement& placement,
               const EdgeSearch& search, int reach);
  void sample(const GreyView& image, const EdgeSearch& search, int reach, std::size_t first);
  void look_again(const OutlineFitParams& params, const EdgeSearch& search, int reach);
  void take_joints_off(const OutlineFitParams& params, const EdgeSearch& search, int reach);
  [[nodiscard]] std::size_t first_of(int side) const { return first_of_side_[static_cast<std::size_t>(side)]; }
  [[nodiscard]] std::span<OutlinePoint> own_points_of(int side) {
    return {points_.data() + first_of(side), first_of(side + 1) - first_of(side)};
  }

  const CeilingCamera* camera_;
  std::vector<OutlinePoint> points_;                     // side after side
  std::array<std::size_t, kSides + 1> first_of_side_{};  // of the points
  std::vector<Eigen::Vector2d> ceiling_points_;  // [m] robot frame: each point, and one ahead of it along its normal
  std::vector<Eigen::Vector2d> pixels_;          // of these
  std::vector<ViewedPoint> viewed_;
  ProfileLanes lanes_;                         // of eight of these
  std::vector<Profile> profiles_;              // of the points of an unlit outline, from inside to outside
  std::array<Profile, kSides> side_profiles_;  // their sums
};

}  // namespace luminav
