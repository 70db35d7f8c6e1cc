#pragma once

#include <vector>

#include "drivers/camera/simulated/index.hpp"
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
struct VisibleShape {
  Shape shape;
  int fixture = -1;     // its index; -1 = no fixture
  double height = 0.0;  // [m] above the floor
  int first_row = 0;
  std::vector<ColumnSpan> spans;  // from the first row on
};

/// What of the building a frame may show. A spatial index makes the search independent of the building's size.
class CeilingLayout {
 public:
  /// Keeps a reference to the model.
  explicit CeilingLayout(const CeilingModel& model);

  /// Fixtures that stand beside their drawn place.
  void set_moved(const std::vector<MovedLamp>& moved);

  /// Finds what the frame may show, in the order of drawing: elements, unlit fixtures, lit ones.
  void find(const FrameGeometry& frame, const CeilingLight& light, double utime);
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] VisibleShape& operator[](std::size_t index) { return visible_[index]; }

 private:
  void add_fixture(int index, const FrameGeometry& frame, const CeilingLight& light, double utime);
  void add_element(const CeilingElement& element, const FrameGeometry& frame);
  VisibleShape& next();
  /// Pixels of a rectangle around the shape, `margin` [m] larger on each side; keeps the shape if there are any.
  void keep_if_visible(const Pose2& world_from_shape, double margin, const FrameGeometry& frame);
  void set_outline(const Pose2& world_from_shape, double length, double width, const FrameGeometry& frame,
                   VisibleShape& visible) const;

  const CeilingModel& model_;
  CeilingCamera camera_;
  PointIndex fixture_index_;
  PointIndex element_index_;
  std::vector<MovedLamp> moved_;
  std::vector<Pose2> world_from_fixture_;  // displaced ones where they stand now
  double farthest_moved_ = 0.0;            // [m]
  std::vector<VisibleShape> visible_;      // the first size_ count; the others keep their memory
  std::size_t size_ = 0;
  std::vector<int> found_;
};

}  // namespace luminav::simulated
