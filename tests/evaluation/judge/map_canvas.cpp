#include "tests/evaluation/judge/map_canvas.hpp"

#include <opencv2/imgproc.hpp>
#include <vector>

#include "services/common/image/picture_file.hpp"

namespace luminav {

MapCanvas::MapCanvas(const PriorMap& map)
    : geometry_(map.geometry), scale_(map.geometry.columns * map.geometry.resolution > 40.0 ? 20 : 40) {
  const int width = static_cast<int>(geometry_.columns * geometry_.resolution * scale_);
  const int height = static_cast<int>(geometry_.rows * geometry_.resolution * scale_);
  cv::Mat cells(geometry_.rows, geometry_.columns, CV_8UC3);
  for (int row = 0; row < geometry_.rows; ++row) {
    for (int column = 0; column < geometry_.columns; ++column) {
      const Prior cell = map.cells[geometry_.index({column, row})];
      const std::uint8_t grey = cell == Prior::kFree ? 255 : cell == Prior::kOccupied ? 40 : 215;
      cells.at<cv::Vec3b>(geometry_.rows - 1 - row, column) = {grey, grey, grey};
    }
  }
  cv::resize(cells, image_, {width, height}, 0, 0, cv::INTER_NEAREST);
}

cv::Point MapCanvas::at(const Eigen::Vector2d& p) const {
  return {static_cast<int>((p.x() - geometry_.origin.x()) * scale_),
          image_.rows - 1 - static_cast<int>((p.y() - geometry_.origin.y()) * scale_)};
}

void MapCanvas::rectangle(const Pose2& world_from_box, double length, double width, const cv::Scalar& colour) {
  std::vector<cv::Point> corners;
  for (const auto& [a, b] : {std::pair{0.5, 0.5}, {-0.5, 0.5}, {-0.5, -0.5}, {0.5, -0.5}}) {
    corners.push_back(at(world_from_box * Eigen::Vector2d(a * length, b * width)));
  }
  cv::fillConvexPoly(image_, corners, colour, cv::LINE_AA);
}

void MapCanvas::line(const Pose2& from, const Pose2& to, const cv::Scalar& colour, int thickness_px) {
  cv::line(image_, at(from.position()), at(to.position()), colour, thickness_px, cv::LINE_AA);
}

void MapCanvas::dot(const Eigen::Vector2d& p, int radius_px, const cv::Scalar& colour, bool filled) {
  cv::circle(image_, at(p), radius_px, colour, filled ? cv::FILLED : 2, cv::LINE_AA);
}

void MapCanvas::arrow(const Pose2& pose, double length, const cv::Scalar& colour) {
  cv::circle(image_, at(pose.position()), 2, colour, cv::FILLED, cv::LINE_AA);
  cv::line(image_, at(pose.position()), at(pose * Eigen::Vector2d(length, 0.0)), colour, 1, cv::LINE_AA);
}

void MapCanvas::text(const Eigen::Vector2d& p, const std::string& words, const cv::Scalar& colour) {
  cv::putText(image_, words, at(p) + cv::Point(8, -8), cv::FONT_HERSHEY_SIMPLEX, 0.6, colour, 2, cv::LINE_AA);
}

void MapCanvas::write(const std::string& png_file) const {
  write_picture(png_file, image_);
}

}  // namespace luminav
