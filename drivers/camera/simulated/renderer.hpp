#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "drivers/camera/simulated/layout.hpp"
#include "drivers/camera/simulated/lighting.hpp"
#include "drivers/camera/simulated/rays.hpp"
#include "drivers/camera/simulated/response.hpp"
#include "drivers/camera/simulated/texture.hpp"
#include "drivers/camera/simulated/truth.hpp"
#include "drivers/camera/simulated/view.hpp"
#include "services/common/image/grey_image.hpp"

namespace luminav::simulated {

/// Pictures of the ceiling from true poses: each pixel's ray meets the ceiling plane, where a repeated tile texture
/// and the analytic outlines of whatever is near are evaluated.
class CeilingRenderer {
 public:
  explicit CeilingRenderer(const CeilingModel& model);
  CeilingRenderer(const CeilingRenderer&) = delete;  // parts of it refer to others
  CeilingRenderer& operator=(const CeilingRenderer&) = delete;

  /// Lamps in the order of the building's file; `moved` fixtures stand beside their drawn place.
  void set_world(double daylight, const std::vector<LampState>& lamps, const std::vector<MovedLamp>& moved);
  /// Renders a frame from one pose per row (rolling shutter) or from one for all rows.
  void render(const Exposure& exposure, std::span<const TruePose> rows, GreyImage& image);

  [[nodiscard]] const CeilingModel& model() const { return model_; }
  [[nodiscard]] int height() const { return rays_.height(); }

 private:
  /// Where in the tiles' texture a picture is looked up.
  struct TextureMap {
    float phase_x;  // [texels] of the frame's origin
    float phase_y;
    float shift_x;  // [m] motion during the exposure: shift + turn x point
    float shift_y;
    float turn;  // [rad]
    int taps;    // that are averaged over the motion
  };

  void light_nodes(const FrameGeometry& frame);
  [[nodiscard]] TextureMap texture_map(const FrameGeometry& frame) const;
  // The steps for one row of pixels.
  void find_points(int row, const View& view, const FrameGeometry& frame);
  void light_row(int row);
  void texture_row(const TextureMap& map);
  void draw_things(int row, const Exposure& exposure, const View& view, const FrameGeometry& frame);
  /// Where in the thing's frame the pixels of a span look.
  void place_in(const VisibleThing& thing, const ColumnSpan& span, const View& view, const FrameGeometry& frame);
  /// Draws what is in `along_` and `across_`; `burning` 0..1 scales the light of lamps.
  void draw_shapes(const VisibleThing& thing, const ColumnSpan& span, float burning);
  void darken_walls(int row);

  CeilingModel model_;
  CeilingCamera camera_;
  RayTable rays_;
  TileTexture texture_;
  SensorResponse response_;
  CeilingLight light_;
  CeilingLayout layout_;
  Eigen::Vector2d grid_origin_;  // [m] world, a crossing of the tiles' grid

  std::vector<float> nodes_;  // light on a coarse grid of pixels
  int node_columns_;
  int node_rows_;
  // Of the row being rendered: points of the ceiling, from the frame's origin [m]; the same in a thing's frame; light
  // that falls there; brightness seen.
  std::vector<float> x_;
  std::vector<float> y_;
  std::vector<float> along_;
  std::vector<float> across_;
  std::vector<float> light_row_;
  std::vector<float> brightness_;
  std::vector<int> texel_;
};

}  // namespace luminav::simulated
