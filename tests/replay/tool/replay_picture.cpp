#include "tests/replay/tool/replay_picture.hpp"

#include <array>
#include <utility>

#include "tests/evaluation/judge/map_canvas.hpp"

namespace luminav {
namespace {

const cv::Scalar kTruth(170, 170, 170);  // blue, green, red
const cv::Scalar kRecorded(0, 0, 0);
const cv::Scalar kSearching(60, 170, 40);
const cv::Scalar kTracking(220, 90, 20);
const cv::Scalar kOdometry(200, 40, 200);
const cv::Scalar kLamp(60, 190, 250);
const cv::Scalar kEvidence(170, 200, 120);
constexpr std::int8_t kOccupiedEvidence = 17;  // log-odds x 20
constexpr double kLongestLine = 1.0;           // [m] a longer step is a jump and not drawn

void draw_step(MapCanvas& canvas, const Pose2& from, const Pose2& to, const cv::Scalar& colour, int thickness) {
  if (distance(from, to) < kLongestLine) {
    canvas.line(from, to, colour, thickness);
  }
}

void draw_grid(MapCanvas& canvas, const OccupancyGrid& grid) {
  const double side = grid.geometry.resolution;
  for (int row = 0; row < grid.geometry.rows; ++row) {
    for (int column = 0; column < grid.geometry.columns; ++column) {
      if (grid.evidence[grid.geometry.index({column, row})] >= kOccupiedEvidence) {
        const Eigen::Vector2d centre = grid.geometry.centre_of({column, row});
        canvas.rectangle({centre.x(), centre.y(), 0.0}, side, side, kEvidence);
      }
    }
  }
}

void draw_odometry(MapCanvas& canvas, const std::vector<TrailPoint>& trail) {
  std::optional<Pose2> world_from_odom;
  for (std::size_t i = 1; i < trail.size(); ++i) {
    if (world_from_odom) {
      draw_step(canvas, *world_from_odom * trail[i - 1].odometry, *world_from_odom * trail[i].odometry, kOdometry, 1);
    } else if (trail[i].state == pose_t::STATE_TRACKING) {
      world_from_odom = trail[i].believed * trail[i].odometry.inverse();
    }
  }
}

void draw_believed(MapCanvas& canvas, const std::vector<TrailPoint>& trail) {
  for (std::size_t i = 1; i < trail.size(); ++i) {
    const bool kalman = trail[i].estimator == pose_t::ESTIMATOR_KALMAN_FILTER;
    if (trail[i].state == pose_t::STATE_TRACKING) {
      draw_step(canvas, trail[i - 1].believed, trail[i].believed, kalman ? kTracking : kSearching, 2);
    } else if (trail[i].state == pose_t::STATE_AMBIGUOUS) {
      canvas.dot(trail[i].believed.position(), 2, kSearching);
    }
  }
}

void draw_legend(MapCanvas& canvas, const PriorMap& walls, bool has_truth) {
  const std::array<std::pair<const char*, cv::Scalar>, 5> lines = {{{has_truth ? "truth" : "(no truth)", kTruth},
                                                                    {"recorded", kRecorded},
                                                                    {"replayed: searching", kSearching},
                                                                    {"replayed: Kalman filter", kTracking},
                                                                    {"odometry", kOdometry}}};
  double y = walls.geometry.origin.y() + 0.3 + 0.6 * static_cast<double>(lines.size());
  for (const auto& [words, colour] : lines) {
    const double x = walls.geometry.origin.x() + walls.geometry.columns * walls.geometry.resolution - 8.0;
    canvas.line({x, y, 0.0}, {x + 0.8, y, 0.0}, colour, 3);
    canvas.text({x + 0.8, y - 0.3}, words, colour);
    y -= 0.6;
  }
}

}  // namespace

void draw_replay(const std::string& png_file, const PriorMap& walls, const Building& building,
                 const ReplayReport& report) {
  MapCanvas canvas(walls);
  if (report.grid) {
    draw_grid(canvas, *report.grid);
  }
  for (const Fixture& fixture : building.fixtures) {
    canvas.rectangle(fixture.world_from_fixture, fixture.length, fixture.width, kLamp);
  }
  for (std::size_t i = 1; i < report.trail.size() && report.has_truth; ++i) {
    draw_step(canvas, report.trail[i - 1].truth, report.trail[i].truth, kTruth, 6);
  }
  for (std::size_t i = 1; i < report.recorded_trail.size(); ++i) {
    draw_step(canvas, report.recorded_trail[i - 1], report.recorded_trail[i], kRecorded, 4);
  }
  draw_odometry(canvas, report.trail);
  draw_believed(canvas, report.trail);
  draw_legend(canvas, walls, report.has_truth);
  canvas.write(png_file);
}

}  // namespace luminav
