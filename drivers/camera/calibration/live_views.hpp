#pragma once

#include <string>
#include <vector>

#include "drivers/camera/calibration/chessboard_calibration.hpp"

namespace luminav {

/// Decides which of a stream of sightings of a board are worth keeping: those in which it is held still, and somewhere
/// else or in another direction than in all that were kept before.
class ViewCollector {
 public:
  explicit ViewCollector(int width) : width_(width) {}

  /// True when the view was kept.
  bool offer(const BoardView& view);
  [[nodiscard]] const std::vector<BoardView>& views() const { return kept_; }

 private:
  int width_;  // [px] of the image
  BoardView last_;
  std::vector<BoardView> kept_;
};

struct LiveCamera {
  std::string device;  // V4L2
  int width = 640;     // [px] asked for
  int height = 480;    // [px]
};

/// Takes views of the board from a device until there are `wanted` or the user interrupts; says how it goes on standard
/// output. Sets width and height to what the device gives. Throws when no frame comes within ten seconds.
std::vector<BoardView> collect_live(LiveCamera& camera, const Chessboard& board, std::size_t wanted);

}  // namespace luminav
