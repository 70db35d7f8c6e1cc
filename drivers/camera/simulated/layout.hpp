#pragma once

#include <array>
#include <vector>

#include "drivers/camera/simulated/catalogue/clutter.hpp"
#include "drivers/camera/simulated/catalogue/part.hpp"
#include "drivers/camera/simulated/lighting.hpp"
#include "drivers/camera/simulated/shapes.hpp"
#include "drivers/camera/simulated/view.hpp"

namespace luminav::simulated {

/// Columns [begin, end) of a row of pixels.
struct ColumnSpan {
  int begin = 0;
  int end = 0;
};

/// A thing on the ceiling and the pixels that it may cover.
struct VisibleThing {
  int fixture = -1;     // its index; -1 = no fixture
  double height = 0.0;  // [m] above the floor
  float x = 0.0F;       // [m] middle, from the frame's origin
  float y = 0.0F;
  float cosine = 1.0F;  // of the direction of its long side
  float sine = 0.0F;
  std::vector<Shape> shapes;  // in the order of painting
  int first_row = 0;
  std::vector<ColumnSpan> spans;  // from the first row on
};

/// What of the building a frame may show.
class CeilingLayout {
 public:
  /// Keeps a reference to the model.
  explicit CeilingLayout(const CeilingModel& model);

  /// Fixtures that stand beside their drawn place.
  void set_moved(const std::vector<MovedLamp>& moved);

  /// Finds what the frame may show, in the order of drawing: what is no fixture, unlit fixtures, lit ones, and what
  /// hangs lower than the ceiling and is no fixture.
  void find(const FrameGeometry& frame, const CeilingLight& light);
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] VisibleThing& operator[](std::size_t index) { return visible_[index]; }

 private:
  static constexpr std::size_t kLooks = 3;  // off, on, half
  void add_clutter(const FrameGeometry& frame, const CeilingLight& light, bool low);
  void add_fixture(int index, const FrameGeometry& frame, const CeilingLight& light);
  /// Adds a thing made of these parts, if any pixel may show it; `steady` scales the glow of what no lamp lights.
  void add(const Pose2& world_from_thing, double height, int fixture, const std::vector<Part>& parts, double daylight,
           const FrameGeometry& frame);
  /// Pixels of a rectangle around the thing, [m] from its middle; false when there are none.
  [[nodiscard]] bool find_spans(const Pose2& world_from_thing, const Eigen::Vector2d& half, const FrameGeometry& frame,
                                VisibleThing& visible) const;

  const CeilingModel& model_;
  CeilingCamera camera_;
  std::vector<ClutterItem> clutter_;  // the building's elements and the model's own
  std::vector<std::vector<Part>> clutter_parts_;
  std::vector<std::array<std::vector<Part>, kLooks>> fixture_parts_;
  std::vector<MovedLamp> moved_;
  std::vector<Pose2> world_from_fixture_;  // displaced ones where they stand now, turned as their burning side is drawn
  std::vector<VisibleThing> visible_;      // the first size_ count; the others keep their memory
  std::size_t size_ = 0;
};

}  // namespace luminav::simulated
