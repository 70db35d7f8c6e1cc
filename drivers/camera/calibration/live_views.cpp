#include "drivers/camera/calibration/live_views.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <stdexcept>

#include "drivers/camera/sources/v4l2_camera.hpp"
#include "services/common/process/clock.hpp"

namespace luminav {
namespace {

volatile std::sig_atomic_t interrupted = 0;

double mean_distance(const BoardView& a, const BoardView& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += (a[i] - b[i]).norm();
  }
  return sum / static_cast<double>(std::max<std::size_t>(a.size(), 1));
}

}  // namespace

bool ViewCollector::offer(const BoardView& view) {
  constexpr double kStill = 1.0;       // [px] from frame to frame: faster is blurred and sheared by the rolling shutter
  constexpr double kElsewhere = 0.06;  // of the image's width, mean over the corners
  const bool still = last_.size() == view.size() && mean_distance(last_, view) < kStill;
  last_ = view;
  const bool fresh = std::all_of(kept_.begin(), kept_.end(), [&](const BoardView& other) {
    return other.size() == view.size() && mean_distance(other, view) > kElsewhere * width_;
  });
  if (still && fresh) {
    kept_.push_back(view);
  }
  return still && fresh;
}

std::vector<BoardView> collect_live(LiveCamera& camera, const Chessboard& board, std::size_t wanted) {
  constexpr std::int64_t kPatience = 10'000'000;  // [us]
  const HostClock clock;
  V4l2Camera device({.device = camera.device, .width = camera.width, .height = camera.height}, clock);
  fmt::print("{}\nshow the board in all parts of the picture, tilted, near and far; hold it still for each view\n",
             device.description());
  const auto previous = std::signal(SIGINT, [](int) { interrupted = 1; });
  ViewCollector collector(camera.width);
  Frame frame;
  std::int64_t last = clock.utime();
  while (interrupted == 0 && collector.views().size() < wanted) {
    pollfd descriptor{device.descriptor(), POLLIN, 0};
    ::poll(&descriptor, 1, 100);
    if (!device.take(clock.utime(), frame)) {
      if (clock.utime() - last > kPatience) {
        throw std::runtime_error(camera.device + ": no pictures" +
                                 (device.fault().empty() ? std::string() : "; " + device.fault()));
      }
      continue;
    }
    last = clock.utime();
    camera.width = frame.image.width;
    camera.height = frame.image.height;
    const auto view = find_chessboard(frame.image.view(), board);
    if (view && collector.offer(*view)) {
      fmt::print("view {} of {}\n", collector.views().size(), wanted);
      std::fflush(stdout);
    }
  }
  std::signal(SIGINT, previous);
  return collector.views();
}

}  // namespace luminav
