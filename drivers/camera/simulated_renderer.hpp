#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "drivers/camera/simulated_index.hpp"
#include "drivers/camera/simulated_lighting.hpp"
#include "drivers/camera/simulated_rays.hpp"
#include "drivers/camera/simulated_response.hpp"
#include "drivers/camera/simulated_shapes.hpp"
#include "drivers/camera/simulated_texture.hpp"
#include "drivers/camera/simulated_truth.hpp"
#include "services/common/building/building.hpp"
#include "services/common/geometry/camera_model.hpp"
#include "services/common/image/grey_image.hpp"

namespace luminav::simulated {

/// The ceiling and the camera as they truly are.
struct CeilingModel {
  Building building;
  CameraIntrinsics intrinsics;
  CameraMounting mounting;
  double grey_noise = 4.0;           // [grey levels] 1-sigma at gain 1
  std::vector<double> unlit_darker;  // [grey levels] per fixture, against a tile at level 100
  std::uint64_t seed = 1;
};

/// How one frame is taken.
struct Exposure {
  std::uint64_t number = 0;   // of the frame: other noise for each
  double utime = 0.0;         // [us] true mid-exposure of the middle row
  double exposure_us = 8000;  // [us]
  double gain = 1.0;
  double row_time_us = 0.0;                            // [us]
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  // [m/s] of the robot, world, for motion blur
  double angular = 0.0;                                // [rad/s]
};

/// Pictures of the ceiling from true poses: each pixel's ray meets the ceiling plane, where a repeated tile texture
/// and the analytic outlines of whatever is near are evaluated. The cost does not grow with the building.
class CeilingRenderer {
 public:
  explicit CeilingRenderer(const CeilingModel& model);
  CeilingRenderer(const CeilingRenderer&) = delete;  // parts of it refer to others
  CeilingRenderer& operator=(const CeilingRenderer&) = delete;

  /// Lamps in the order of the building's file; `moved` fixtures stand beside their drawn place.
  void set_world(double daylight, const std::vector<LampState>& lamps, const std::vector<MovedLamp>& moved);
  /// Renders a frame from one pose per row (or one for all rows).
  void render(const Exposure& exposure, std::span<const TruePose> rows, GreyImage& image);

  [[nodiscard]] const CeilingModel& model() const { return model_; }
  [[nodiscard]] int height() const { return rays_.height(); }

 private:
  /// The camera in space at one instant.
  struct View {
    Eigen::Vector3d lens;              // [m] world
    Eigen::Matrix3d world_from_robot;  // rotation
  };
  struct Span {
    int begin = 0;
    int end = 0;  // [px] columns, excluded
  };
  struct VisibleShape {
    Shape shape;
    int fixture = -1;     // -1 = an element
    double height = 0.0;  // [m] above the floor
    int first_row = 0;
    std::vector<Span> spans;  // from first_row on
  };
  /// Where on the plane the picture is looked up, in texels.
  struct TextureMap {
    float phase_x = 0.0F;
    float phase_y = 0.0F;
    float shift_x = 0.0F;  // [m] motion during the exposure: shift + turn x point
    float shift_y = 0.0F;
    float turn = 0.0F;  // [rad]
    int taps = 1;
  };

  [[nodiscard]] View view_from(const TruePose& pose) const;
  [[nodiscard]] double metres_per_pixel(const View& view, const Eigen::Vector2d& point, double height) const;
  void light_nodes(const View& view);
  void find_shapes(const Exposure& exposure, const View& view, const Eigen::Vector2d& robot);
  void add_fixture(int index, const Exposure& exposure, const View& view);
  void add_element(const CeilingElement& element, const View& view);
  void set_outline(const Pose2& world_from_shape, double length, double width, VisibleShape& visible,
                   const View& view) const;
  void find_spans(double reach, const Pose2& world_from_shape, const View& view, VisibleShape& visible);
  [[nodiscard]] TextureMap texture_map(const Exposure& exposure, const View& view) const;
  void ceiling_points(int row, const View& view);
  void light_row(int row);
  void texture_row(const TextureMap& map);
  void shapes_row(int row, const Exposure& exposure, const View& view);

  CeilingModel model_;
  CeilingCamera camera_;
  RayTable rays_;
  TileTexture texture_;
  SensorResponse response_;
  CeilingLight light_;
  PointIndex fixture_index_;
  PointIndex element_index_;
  std::vector<MovedLamp> moved_;
  std::vector<Pose2> world_from_fixture_;                  // displaced ones where they stand now
  double farthest_moved_ = 0.0;                            // [m]
  Eigen::Vector2d grid_origin_ = Eigen::Vector2d::Zero();  // [m] world, a crossing of the tiles' grid

  // of the frame being rendered
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();  // [m] world, below which x_ and y_ count
  Eigen::Vector2d motion_ = Eigen::Vector2d::Zero();  // [m] of a point at origin_ during the exposure
  double turn_ = 0.0;                                 // [rad] during the exposure
  double slack_ = 0.0;                                // [m] by which the rows' poses differ
  int visible_count_ = 0;
  std::vector<VisibleShape> visible_;
  std::vector<float> nodes_;  // light on a coarse grid of pixels
  int node_columns_ = 0;
  int node_rows_ = 0;
  std::vector<int> found_;
  std::vector<int> texel_;
  std::vector<float> x_, y_, plane_x_, plane_y_, light_row_, brightness_;
};

}  // namespace luminav::simulated
