#include "tests/evaluation/judge/run_picture.hpp"

#include <luminav/pose_t.hpp>

#include "tests/evaluation/judge/map_canvas.hpp"

namespace luminav {
namespace {

const cv::Scalar kBlue(220, 90, 20);
const cv::Scalar kGreen(60, 170, 40);
const cv::Scalar kMagenta(200, 40, 200);
const cv::Scalar kGrey(150, 150, 150);
const cv::Scalar kLamp(60, 190, 250);
const cv::Scalar kRed(40, 40, 220);
const cv::Scalar kBox(70, 110, 180);

}  // namespace

void draw_run(const std::string& png_file, const WorldTruth& world, const Building& believed,
              const std::vector<TrailPoint>& trail, const std::vector<GoalResult>& goals, const OccupancyGrid* grid) {
  MapCanvas canvas(world.walls);
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
    const bool is_right = goals[i].expect_refused ? goals[i].refused : goals[i].reached;
    canvas.dot(at, 9, is_right ? kGreen : kRed, false);
    canvas.text(at, std::to_string(i + 1), is_right ? kGreen : kRed);
  }
  canvas.write(png_file);
}

}  // namespace luminav
