#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "services/common/geometry/camera_model.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/outline/outline.hpp"

namespace luminav {

/// A place on an outline, and the edge that was found near it.
struct EdgePoint {
  Eigen::Vector2d place;   // [m] outline frame, on the nominal outline
  Eigen::Vector2d normal;  // outward
  int side = 0;
  bool in_view = false;
  bool found = false;
  double metres_per_px = 0.0;  // along the normal
  double offset_px = 0.0;      // of the edge along the normal, outwards of where the outline is placed
  double step = 0.0;           // [grey]
};

struct EdgeSearchParams {
  bool inside_brighter = true;
  int search_px = 8;         // to each side of the outline
  int half_filter = 2;       // [px] whose means are compared
  int lines = 1;             // [px] along the outline over which each profile is averaged
  double min_edge = 10.0;    // [grey] step that counts as an edge
  double pixel_noise = 4.0;  // [grey] 1 sigma
  bool is_first = false;     // most guesses are wrong, and half of the points says so
};

/// Looks for the edges of an outline: grey profiles across it, and in each the largest step of the right sign. The
/// outline is projected through the lens model, so pixels are never resampled and lines never assumed straight.
class EdgeSearch {
 public:
  explicit EdgeSearch(const CeilingCamera& camera) : camera_(&camera) {}

  /// Spreads points over the sides. Corners are left out: blur rounds them, and lamps are round at their ends.
  void spread_points(const Outline& outline, double metres_per_px, double spacing_px);
  /// Says where the outline lies; then each side may be measured.
  void start(const OutlinePlacement& placement, double height, const EdgeSearchParams& params);
  /// Finds the edge near each point of a side that is in view.
  void measure(const GreyView& image, const EdgeSearchParams& params, int side);
  /// Takes a side for one that is not in view.
  void leave_out(int side);

  [[nodiscard]] std::span<const EdgePoint> points() const { return points_; }
  [[nodiscard]] std::span<const EdgePoint> points_of(int side) const;

 private:
  static constexpr int kMaxLength = 64;  // [px] of a profile
  using Profile = std::array<float, kMaxLength>;
  struct Step {
    double offset_px;  // from the profile's middle
    double height;     // [grey]
  };
  struct Window {  // [px] of a profile, in which the step is looked for
    int first;
    int last;
  };

  void add_side(int side, const Eigen::Vector2d& middle, const Eigen::Vector2d& along, const Eigen::Vector2d& normal,
                double usable, int count);
  void project(std::size_t first, std::size_t last);
  void sample(const GreyView& image, std::size_t index, const EdgeSearchParams& params);
  [[nodiscard]] std::optional<Step> largest_step(const Profile& profile, const EdgeSearchParams& params,
                                                 const Window& window) const;
  void search_side(int side, const EdgeSearchParams& params);
  [[nodiscard]] std::span<EdgePoint> own_points_of(int side);
  void fill_lines(Profile& profile) const;
  [[nodiscard]] Profile& profile_of(const EdgePoint& point) {
    return profiles_[static_cast<std::size_t>(&point - points_.data())];
  }

  const CeilingCamera* camera_;
  std::vector<EdgePoint> points_;                        // side after side
  std::array<std::size_t, kSides + 1> first_of_side_{};  // of the points
  std::vector<Eigen::Vector2d> ceiling_points_;          // [m] robot frame: each point, and one ahead of it
  std::vector<Eigen::Vector2d> pixels_;                  // of these
  std::vector<Profile> profiles_;                        // of each point, from inside to outside
  OutlinePlacement placement_;
  double height_ = 0.0;  // [m]
  int reach_ = 0;        // [px] of a profile to each side
};

}  // namespace luminav
