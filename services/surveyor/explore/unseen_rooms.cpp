#include "services/surveyor/explore/unseen_rooms.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace luminav {
namespace {

cv::Mat1b convex_outline(const cv::Mat1b& reached) {
  std::vector<cv::Point> places;
  cv::findNonZero(reached, places);
  cv::Mat1b inside(reached.size(), 0);
  if (!places.empty()) {
    std::vector<cv::Point> outline;
    cv::convexHull(places, outline);
    cv::fillConvexPoly(inside, outline, 1);
  }
  return inside;
}

}  // namespace

std::vector<std::uint8_t> find_unseen_rooms(const ConfigurationSpace& space, const std::vector<std::uint8_t>& reached,
                                            double min_area) {
  const GridGeometry& geometry = space.geometry();
  cv::Mat1b was_reached(geometry.rows, geometry.columns);
  std::copy(reached.begin(), reached.end(), was_reached.begin());
  cv::Mat1b unseen = convex_outline(was_reached);
  for (int row = 0; row < geometry.rows; ++row) {
    for (int column = 0; column < geometry.columns; ++column) {
      if (was_reached(row, column) != 0 || space.is_blocked({column, row})) {
        unseen(row, column) = 0;
      }
    }
  }
  cv::Mat1i labels;
  cv::Mat1i stats;
  cv::Mat1d centroids;
  cv::connectedComponentsWithStats(unseen, labels, stats, centroids);
  const double min_cells = min_area / (geometry.resolution * geometry.resolution);
  std::vector<std::uint8_t> rooms(geometry.size(), 0);
  std::transform(labels.begin(), labels.end(), rooms.begin(),
                 [&](int label) { return label != 0 && stats(label, cv::CC_STAT_AREA) >= min_cells ? 1 : 0; });
  return rooms;
}

}  // namespace luminav
