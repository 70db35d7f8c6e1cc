#include "tests/evaluation/sensing/fixture_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "drivers/camera/simulated/view.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kEdgeMargin = 6.0;  // [px] an edge nearer to the border is not measured: half of the profile across it
constexpr double kMaxMoved = 1.0;    // [m] by which events displace a fixture

/// Radius [m per m of rise] around the point above the lens that the image's corners see.
double reach_of(const CeilingCamera& camera) {
  double reach = 0.0;
  const auto& lens = camera.intrinsics();
  for (const double x : {0.0, lens.width - 1.0}) {
    for (const double y : {0.0, lens.height - 1.0}) {
      const auto ray_in_camera = camera.ray_in_camera({x, y});
      if (!ray_in_camera) {
        return 1.0 / 0.15;  // as far as anything is looked for
      }
      const Vector3d ray = camera.rotation() * *ray_in_camera;
      reach = std::max(reach, std::hypot(ray.x(), ray.y()) / std::max(0.15, ray.z()));
    }
  }
  return reach;
}

/// True if all corners of a fixture lie so far off one border that nothing between them is in the image, whatever the
/// lens bends.
bool lie_beside_image(const std::array<std::optional<Vector2d>, 4>& corners, const CameraIntrinsics& lens) {
  constexpr double kBend = 40.0;  // [px]
  const auto all = [&](const auto& is_off) {
    return std::all_of(corners.begin(), corners.end(),
                       [&](const std::optional<Vector2d>& corner) { return corner && is_off(*corner); });
  };
  return all([&](const Vector2d& p) { return p.x() < -kBend; }) ||
         all([&](const Vector2d& p) { return p.y() < -kBend; }) ||
         all([&](const Vector2d& p) { return p.x() > lens.width + kBend; }) ||
         all([&](const Vector2d& p) { return p.y() > lens.height + kBend; });
}

}  // namespace

std::optional<FrameMoment> moment_at(const simulated::TruthBuffer& truth, double middle, double frame_time) {
  const auto pose = truth.at(middle);
  const double half = std::max(5'000.0, 0.5 * frame_time);
  const auto before = truth.at(middle - half);
  const auto after = truth.at(middle + half);
  if (!pose || !before || !after) {
    return std::nullopt;
  }
  const double seconds = 2e-6 * half;
  return FrameMoment{*pose, (after->world_from_robot.position() - before->world_from_robot.position()) / seconds,
                     wrap_angle(after->world_from_robot.theta - before->world_from_robot.theta) / seconds};
}

Pose2 FixtureView::robot_from_fixture(bool near_end_visible, bool far_end_visible) const {
  double along = 0.0;
  if (near_end_visible && far_end_visible) {
    along = 0.5 * (near_at + far_at);
  } else if (far_end_visible) {
    along = far_at - 0.5 * length;
  } else if (near_end_visible) {
    along = near_at + 0.5 * length;
  }
  return robot_from_line * Pose2{along, 0.0, 0.0};
}

CeilingViewer::CeilingViewer(const WorldTruth& world, const Building& believed,
                             const CameraDescription& believed_camera)
    : fixtures_(world.building.fixtures),
      believed_(believed.fixtures),
      true_camera_(world.robot.camera.intrinsics, world.robot.camera.mounting),
      believed_camera_(believed_camera.intrinsics, believed_camera.mounting),
      row_time_(world.robot.camera.row_time),
      reach_(0.0) {
  Vector2d min(1e9, 1e9);
  Vector2d max(-1e9, -1e9);
  double highest = 0.0;
  double longest = 0.0;
  for (const Fixture& fixture : fixtures_) {
    min = min.cwiseMin(fixture.world_from_fixture.position());
    max = max.cwiseMax(fixture.world_from_fixture.position());
    highest = std::max(highest, fixture.height);
    longest = std::max(longest, std::hypot(fixture.length, fixture.width));
  }
  const CameraMounting& mounting = true_camera_.mounting();
  reach_ = reach_of(true_camera_) * std::max(0.1, highest - mounting.z) + std::hypot(mounting.x, mounting.y) +
           0.5 * longest + 0.1 + kMaxMoved;
  if (fixtures_.empty()) {
    return;
  }
  corner_ = min;
  columns_ = static_cast<int>((max.x() - min.x()) / cell_) + 1;
  rows_ = static_cast<int>((max.y() - min.y()) / cell_) + 1;
  cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  for (std::size_t i = 0; i < fixtures_.size(); ++i) {
    const Vector2d offset = (fixtures_[i].world_from_fixture.position() - corner_) / cell_;
    cells_[static_cast<std::size_t>(static_cast<int>(offset.y()) * columns_ + static_cast<int>(offset.x()))].push_back(
        i);
  }
}

void CeilingViewer::near(const Vector2d& centre, std::vector<std::size_t>& indices) const {
  indices.clear();
  const auto range = [&](double value, int count) {
    return std::pair{std::max(0, static_cast<int>(std::floor((value - reach_) / cell_))),
                     std::min(count - 1, static_cast<int>(std::floor((value + reach_) / cell_)))};
  };
  const auto [left, right] = range(centre.x() - corner_.x(), columns_);
  const auto [low, high] = range(centre.y() - corner_.y(), rows_);
  for (int row = low; row <= high; ++row) {
    for (int column = left; column <= right; ++column) {
      for (const std::size_t index : cells_[static_cast<std::size_t>(row * columns_ + column)]) {
        if ((fixtures_[index].world_from_fixture.position() - centre).squaredNorm() < reach_ * reach_) {
          indices.push_back(index);
        }
      }
    }
  }
  std::sort(indices.begin(), indices.end());
}

std::optional<Vector2d> CeilingViewer::pixel_of(const Vector2d& in_world, double height) const {
  const double middle_row = 0.5 * (true_camera_.intrinsics().height - 1);
  const Vector2d robot = moment_.pose.world_from_robot.position();
  const auto project = [&](double seconds) {
    // instead of the robot, the ceiling moves the other way
    const double turn = moment_.angular * seconds;
    const Vector2d offset = in_world - robot;
    const Vector2d moved = in_world - seconds * moment_.velocity + turn * Vector2d(offset.y(), -offset.x());
    return true_camera_.pixel_of(camera_from_world_ * (Vector3d(moved.x(), moved.y(), height) - lens_));
  };
  std::optional<Vector2d> pixel = project(0.0);
  const int passes = moment_.angular == 0.0 && moment_.velocity.isZero() ? 0 : 2;
  for (int i = 0; i < passes && pixel; ++i) {  // each one shrinks the change of the row 20-fold or more
    pixel = project((pixel->y() - middle_row) * row_time_);
  }
  return pixel;
}

std::optional<Vector2d> CeilingViewer::as_believed(const Pose2& world_from_fixture, double along,
                                                   std::size_t index) const {
  const auto pixel = pixel_of(world_from_fixture * Vector2d(along, 0.0), fixtures_[index].height);
  return pixel ? believed_camera_.point_on_ceiling(*pixel, believed_[index].height) : std::nullopt;
}

void CeilingViewer::measure_share(const Fixture& fixture, const Pose2& world_from_fixture, FixtureView& result) const {
  constexpr int kAlong = 15;
  constexpr int kAcross = 3;
  const auto in_image = [&](double along, double across, double margin) {
    const auto pixel = pixel_of(world_from_fixture * Vector2d(along, across), fixture.height);
    return pixel && true_camera_.is_in_image(*pixel, margin);
  };
  const double half_length = 0.5 * fixture.length;
  const double half_width = 0.5 * fixture.width;
  std::array<std::optional<Vector2d>, 4> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector2d corner((i < 2 ? 1.0 : -1.0) * half_length, (i % 2 == 0 ? 1.0 : -1.0) * half_width);
    corners[i] = pixel_of(world_from_fixture * corner, fixture.height);
  }
  const bool is_whole = std::all_of(corners.begin(), corners.end(), [&](const std::optional<Vector2d>& corner) {
    return corner && true_camera_.is_in_image(*corner, kEdgeMargin);
  });
  if (is_whole) {
    result.share = 1.0;
    result.near_end = result.far_end = true;
    result.seen_from = -half_length;
    result.seen_to = half_length;
    return;
  }
  if (lie_beside_image(corners, true_camera_.intrinsics())) {
    return;
  }
  int seen = 0;
  for (int i = 0; i < kAlong; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      seen += in_image(((i + 0.5) / kAlong - 0.5) * fixture.length, ((j + 0.5) / kAcross - 0.5) * fixture.width, 0.0)
                  ? 1
                  : 0;
    }
  }
  result.share = static_cast<double>(seen) / (kAlong * kAcross);
  if (seen == 0) {
    return;
  }
  const auto end_in_image = [&](double along) {
    int visible = 0;
    for (const double across : {-0.38, -0.19, 0.0, 0.19, 0.38}) {
      visible += in_image(along, across * fixture.width, kEdgeMargin) ? 1 : 0;
    }
    return visible >= 3;
  };
  result.near_end = end_in_image(-half_length);
  result.far_end = end_in_image(half_length);
  constexpr int kSteps = 30;
  result.seen_from = half_length;
  result.seen_to = -half_length;
  for (int i = 0; i <= kSteps; ++i) {
    const double along = (static_cast<double>(i) / kSteps - 0.5) * fixture.length;
    if (in_image(along, half_width, kEdgeMargin) || in_image(along, -half_width, kEdgeMargin)) {
      result.seen_from = std::min(result.seen_from, along);
      result.seen_to = std::max(result.seen_to, along);
    }
  }
}

bool CeilingViewer::view(std::size_t index, const Pose2& world_from_fixture, double min_share,
                         FixtureView& result) const {
  const Fixture& fixture = fixtures_[index];
  result.index = index;
  result.length = believed_[index].length;
  measure_share(fixture, world_from_fixture, result);
  if (result.share < min_share || result.share <= 0.0) {
    return false;
  }
  if (fixture.shape != FixtureShape::kRectangle || result.seen_to - result.seen_from < 0.1 * fixture.length) {
    result.seen_from = -0.5 * fixture.length;
    result.seen_to = 0.5 * fixture.length;
  }
  constexpr int kPoints = 5;
  const double middle = 0.5 * (result.seen_from + result.seen_to);
  std::array<Vector2d, kPoints> points;
  Vector2d mean = Vector2d::Zero();
  Vector2d direction = Vector2d::Zero();
  for (int i = 0; i < kPoints; ++i) {
    const double offset = (result.seen_to - result.seen_from) * (static_cast<double>(i) / (kPoints - 1) - 0.5);
    const auto point = as_believed(world_from_fixture, middle + offset, index);
    if (!point) {
      return false;
    }
    mean += *point / kPoints;
    direction += offset * *point;
    if (fixture.shape == FixtureShape::kSquare) {  // its sides across have as much say
      const auto beside = as_believed(world_from_fixture * Pose2{0.0, 0.0, 0.5 * kPi}, offset, index);
      if (!beside) {
        return false;
      }
      direction += offset * Vector2d(beside->y(), -beside->x());
    }
  }
  const auto near_end = as_believed(world_from_fixture, -0.5 * fixture.length, index);
  const auto far_end = as_believed(world_from_fixture, 0.5 * fixture.length, index);
  if (direction.norm() < 1e-9 || !near_end || !far_end) {
    return false;
  }
  direction.normalize();
  result.robot_from_line = {mean.x(), mean.y(), std::atan2(direction.y(), direction.x())};
  result.near_at = (*near_end - mean).dot(direction);
  result.far_at = (*far_end - mean).dot(direction);
  return true;
}

void CeilingViewer::look(const FrameMoment& moment, const std::vector<simulated::MovedLamp>& moved, double min_share,
                         std::vector<FixtureView>& views) {
  views.clear();
  moment_ = moment;
  const simulated::View view_in_space = simulated::view_from(true_camera_.mounting(), moment.pose);
  lens_ = view_in_space.lens;
  camera_from_world_ = (view_in_space.world_from_robot * true_camera_.rotation()).transpose();
  near(moment.pose.world_from_robot.position(), found_);
  for (const std::size_t index : found_) {
    Pose2 world_from_fixture = fixtures_[index].world_from_fixture;
    for (const simulated::MovedLamp& lamp : moved) {
      if (static_cast<std::size_t>(lamp.index) == index) {
        world_from_fixture = {world_from_fixture.x + lamp.dx, world_from_fixture.y + lamp.dy,
                              wrap_angle(world_from_fixture.theta + lamp.theta)};
      }
    }
    FixtureView result;
    if (view(index, world_from_fixture, min_share, result)) {
      views.push_back(result);
    }
  }
}

}  // namespace luminav
