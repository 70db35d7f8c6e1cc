#include "tests/evaluation/run_picture.hpp"

#include <luminav/pose_t.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace luminav {
namespace {

const cv::Scalar kBlue(220, 90, 20);
const cv::Scalar kGreen(60, 170, 40);
const cv::Scalar kMagenta(200, 40, 200);
const cv::Scalar kGrey(150, 150, 150);
const cv::Scalar kLamp(60, 190, 250);
const cv::Scalar kRed(40, 40, 220);
const cv::Scalar kBox(70, 110, 180);

class Canvas {
 public:
  explicit Canvas(const PriorMap& map)
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

  cv::Point at(const Eigen::Vector2d& p) const {
    return {static_cast<int>((p.x() - geometry_.origin.x()) * scale_),
            image_.rows - 1 - static_cast<int>((p.y() - geometry_.origin.y()) * scale_)};
  }
  void rectangle(const Pose2& world_from_box, double length, double width, const cv::Scalar& colour) {
    std::vector<cv::Point> corners;
    for (const auto& [a, b] : {std::pair{0.5, 0.5}, {-0.5, 0.5}, {-0.5, -0.5}, {0.5, -0.5}}) {
      corners.push_back(at(world_from_box * Eigen::Vector2d(a * length, b * width)));
    }
    cv::fillConvexPoly(image_, corners, colour, cv::LINE_AA);
  }
  void line(const Pose2& from, const Pose2& to, const cv::Scalar& colour, int thickness) {
    cv::line(image_, at(from.position()), at(to.position()), colour, thickness, cv::LINE_AA);
  }
  void dot(const Eigen::Vector2d& p, int radius, const cv::Scalar& colour, bool filled = true) {
    cv::circle(image_, at(p), radius, colour, filled ? cv::FILLED : 2, cv::LINE_AA);
  }
  void text(const Eigen::Vector2d& p, const std::string& words, const cv::Scalar& colour) {
    cv::putText(image_, words, at(p) + cv::Point(8, -8), cv::FONT_HERSHEY_SIMPLEX, 0.6, colour, 2, cv::LINE_AA);
  }
  cv::Mat& image() { return image_; }

 private:
  GridGeometry geometry_;
  int scale_;  // [px per m]
  cv::Mat image_;
};

}  // namespace

void draw_run(const std::string& png_file, const WorldTruth& world, const Building& believed,
              const std::vector<TrailPoint>& trail, const std::vector<GoalResult>& goals, const OccupancyGrid* grid) {
  Canvas canvas(world.walls);
  if (grid != nullptr) {
    for (int row = 0; row < grid->geometry.rows; ++row) {
      for (int column = 0; column < grid->geometry.columns; ++column) {
        const Cell cell{column, row};
        if (grid->evidence[grid->geometry.index(cell)] >= 17) {
          const Eigen::Vector2d centre = grid->geometry.centre_of(cell);
          canvas.rectangle({centre.x(), centre.y(), 0.0}, grid->geometry.resolution, grid->geometry.resolution,
                           cv::Scalar(170, 200, 120));
        }
      }
    }
  }
  for (const Fixture& fixture : believed.fixtures) {
    canvas.rectangle(fixture.world_from_fixture, fixture.length, fixture.width, kLamp);
  }
  for (const Obstacle& obstacle : world.obstacles) {
    if (obstacle.world_from_obstacle) {
      canvas.rectangle(*obstacle.world_from_obstacle, obstacle.length, obstacle.width, kBox);
    }
  }
  bool localized = false;
  Pose2 world_from_odometry;
  for (std::size_t i = 1; i < trail.size(); ++i) {
    const TrailPoint& a = trail[i - 1];
    const TrailPoint& b = trail[i];
    canvas.line(a.truth, b.truth, kGrey, 5);
    if (!localized && b.state == pose_t::STATE_TRACKING) {
      localized = true;
      world_from_odometry = b.believed * b.odometry.inverse();
    } else if (localized && distance(a.odometry, b.odometry) < 1.0) {
      canvas.line(world_from_odometry * a.odometry, world_from_odometry * b.odometry, kMagenta, 1);
    }
    const bool jumped = distance(a.believed, b.believed) > 1.0;
    if (b.state == pose_t::STATE_TRACKING && !jumped) {
      canvas.line(a.believed, b.believed, kBlue, 2);
    } else if (b.state != pose_t::STATE_TRACKING) {
      canvas.dot(b.believed.position(), 2, kGreen);
    }
  }
  if (!trail.empty()) {
    canvas.dot(trail.front().truth.position(), 8, kGrey);
    canvas.text(trail.front().truth.position(), "start", kGrey);
  }
  for (std::size_t i = 0; i < goals.size(); ++i) {
    const Eigen::Vector2d at(goals[i].x, goals[i].y);
    canvas.dot(at, 9, goals[i].reached ? kGreen : kRed, false);
    canvas.text(at, std::to_string(i + 1), goals[i].reached ? kGreen : kRed);
  }
  if (!cv::imwrite(png_file, canvas.image())) {
    throw std::runtime_error(png_file + ": cannot be written");
  }
}

}  // namespace luminav
