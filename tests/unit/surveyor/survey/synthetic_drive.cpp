#include "tests/unit/surveyor/survey/synthetic_drive.hpp"

#include <Eigen/Dense>
#include <Eigen/SVD>
#include <cmath>
#include <random>

#include "services/common/ceiling/ceiling_view.hpp"
#include "services/common/configuration/robot_file.hpp"

namespace luminav {
namespace {

constexpr double kSpeed = 0.4;              // [m/s]
constexpr double kTurnRate = 0.5;           // [rad/s]
constexpr double kStep = 0.1;               // [s] between odometry readings, and between images half a step beside them
constexpr std::int64_t kStart = 1'000'000;  // [us]

class Driver {
 public:
  Driver(const std::vector<Fixture>& fixtures, const SurveyModel& model, const SyntheticErrors& errors)
      : fixtures_(fixtures), model_(model), errors_(errors), view_(model.robot.camera), random_(errors.seed) {}

  void begin(const Pose2& pose) {
    pose_ = pose;
    read_wheels(0.0, 0.0);
  }

  /// Moves on for one step; the picture is taken in the middle of it.
  void move(double linear, double angular) {
    const double distance = linear * kStep;
    const double turn = angular * kStep;
    const Pose2 half{0.5 * distance * std::cos(0.25 * turn), 0.5 * distance * std::sin(0.25 * turn), 0.5 * turn};
    take_picture(pose_ * half);
    pose_ = pose_ * half * half;
    count(distance, turn);
    utime_ += static_cast<std::int64_t>(1e6 * kStep);
    read_wheels(linear, angular);
  }

  [[nodiscard]] const Pose2& pose() const { return pose_; }
  SyntheticDrive take() { return std::move(result_); }

 private:
  double noise(double sigma) { return sigma > 0.0 ? sigma * normal_(random_) : 0.0; }

  /// What wheels that are wrong tell of a step: the inverse of their correction.
  void count(double distance, double turn) {
    const double way = std::sqrt(std::abs(distance) + 0.5 * model_.robot.wheel_base * std::abs(turn));
    distance += noise(errors_.odometry_position * way);
    turn += noise(errors_.odometry_heading * way);
    const WheelCorrection& wheels = errors_.wheels;
    const double base = model_.robot.wheel_base;
    const double apart = turn * base * (1.0 + wheels.base);
    const double left = (distance - 0.5 * apart) / ((1.0 + wheels.scale) * (1.0 - 0.5 * wheels.ratio));
    const double right = (distance + 0.5 * apart) / ((1.0 + wheels.scale) * (1.0 + 0.5 * wheels.ratio));
    const double told = 0.5 * (left + right);
    const double told_turn = (right - left) / base;
    odom_ = odom_ * Pose2{told * std::cos(0.5 * told_turn), told * std::sin(0.5 * told_turn), told_turn};
  }

  void read_wheels(double linear, double angular) {
    result_.drive.odometry.push_back({utime_, 1, odom_, linear, angular});
  }

  void take_picture(const Pose2& world_from_robot) {
    SightingFrame frame;
    frame.utime = utime_ + static_cast<std::int64_t>(0.5e6 * kStep);
    for (const Fixture& fixture : fixtures_) {
      const Pose2 seen = world_from_robot.inverse() * fixture.world_from_fixture;
      if (view_.is_wholly_visible(seen, fixture, 0.05)) {
        frame.sightings.push_back(sighting_of(seen, fixture));
      } else if (errors_.bloom >= 0.0 && shows_end(seen, fixture, 1.0) != shows_end(seen, fixture, -1.0)) {
        frame.sightings.push_back(cut_sighting_of(seen, fixture));
      }
    }
    if (std::uniform_real_distribution<double>(0.0, 1.0)(random_) < errors_.false_share) {
      std::uniform_real_distribution<double> anywhere(-0.6, 0.6);
      frame.sightings.push_back(sighting_of({anywhere(random_), anywhere(random_), anywhere(random_)}, fixtures_[0]));
    }
    result_.drive.frames.push_back(frame);
    result_.truth.push_back(world_from_robot);
  }

  FixtureSighting sighting_of(const Pose2& seen, const Fixture& fixture) {
    FixtureSighting sighting;
    const double larger = 1.0 + errors_.camera_scale;
    sighting.robot_from_fixture = {larger * seen.x + noise(errors_.sighting_position),
                                   larger * seen.y + noise(errors_.sighting_position),
                                   wrap_axis(seen.theta + noise(errors_.sighting_heading))};
    sighting.covariance = Eigen::Vector3d(1e-6, 1e-6, 1e-6).asDiagonal();
    sighting.length = larger * fixture.length;
    sighting.width = larger * fixture.width;
    sighting.state = SightingState::kLit;
    return sighting;
  }

  /// Whether the end towards +theta (`side` 1) or -theta (-1) is in view.
  [[nodiscard]] bool shows_end(const Pose2& seen, const Fixture& fixture, double side) const {
    Fixture tip = fixture;
    tip.length = tip.width = 0.05;
    return view_.is_wholly_visible(seen * Pose2{side * 0.5 * fixture.length, 0.0, 0.0}, tip, 0.05);
  }

  /// The middle is told from the end in view, which bloom lets look farther out.
  FixtureSighting cut_sighting_of(const Pose2& seen, const Fixture& fixture) {
    const bool is_far = shows_end(seen, fixture, 1.0);
    FixtureSighting sighting = sighting_of(seen * Pose2{is_far ? errors_.bloom : -errors_.bloom, 0.0, 0.0}, fixture);
    sighting.clipped = true;
    sighting.near_end_visible = !is_far;
    sighting.far_end_visible = is_far;
    return sighting;
  }

  const std::vector<Fixture>& fixtures_;
  const SurveyModel& model_;
  SyntheticErrors errors_;
  CeilingView view_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  Pose2 pose_;
  Pose2 odom_;
  std::int64_t utime_ = kStart;
  SyntheticDrive result_;
};

}  // namespace

SyntheticDrive drive_along(const std::vector<Eigen::Vector2d>& corners, const std::vector<Fixture>& fixtures,
                           const SurveyModel& model, const SyntheticErrors& errors) {
  Driver driver(fixtures, model, errors);
  const auto heading = [](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    return std::atan2(to.y() - from.y(), to.x() - from.x());
  };
  driver.begin({corners[0].x(), corners[0].y(), heading(corners[0], corners[1])});
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const double turn = wrap_angle(heading(driver.pose().position(), corners[i]) - driver.pose().theta);
    const int turns = static_cast<int>(std::ceil(std::abs(turn) / (kTurnRate * kStep)));
    for (int k = 0; k < turns; ++k) {
      driver.move(0.0, turn / (turns * kStep));
    }
    const double way = (corners[i] - driver.pose().position()).norm();
    const int steps = static_cast<int>(std::ceil(way / (kSpeed * kStep)));
    for (int k = 0; k < steps; ++k) {
      driver.move(way / (steps * kStep), 0.0);
    }
  }
  SyntheticDrive result = driver.take();
  result.drive.has_lengths = true;
  return result;
}

SurveyModel synthetic_model() {
  SurveyModel model;
  model.robot = read_robot(LUMINAV_SOURCE_DIR "/launch/robots/p3dx.toml");
  model.robot.camera.row_time = 0.0;
  model.kinds.ceiling_height = 2.8;
  model.kinds.kinds.push_back(fixture_at(1, 0.0, 0.0, 0.0));
  return model;
}

Fixture fixture_at(int id, double x, double y, double theta) {
  Fixture fixture;
  fixture.id = id;
  fixture.world_from_fixture = {x, y, theta};
  return fixture;
}

double rms_after_alignment(const std::vector<Fixture>& truth, const SurveyEstimate& estimate, const Pose2& start) {
  const Pose2 rough = start * estimate.poses.front().inverse();
  Eigen::Matrix2Xd to(2, static_cast<Eigen::Index>(truth.size()));
  Eigen::Matrix2Xd from = to;
  for (Eigen::Index i = 0; i < to.cols(); ++i) {
    to.col(i) = truth[static_cast<std::size_t>(i)].world_from_fixture.position();
    double nearest = 1e9;
    for (const SurveyedFixture& fixture : estimate.fixtures) {
      const Eigen::Vector2d placed = rough * fixture.world_from_fixture.position();
      if ((placed - to.col(i)).norm() < nearest) {
        nearest = (placed - to.col(i)).norm();
        from.col(i) = placed;
      }
    }
  }
  const Eigen::Vector2d to_mean = to.rowwise().mean();
  const Eigen::Vector2d from_mean = from.rowwise().mean();
  const Eigen::Matrix2d spread = (to.colwise() - to_mean) * (from.colwise() - from_mean).transpose();
  const double turn = std::atan2(spread(1, 0) - spread(0, 1), spread(0, 0) + spread(1, 1));
  const Eigen::Matrix2d rotation = Eigen::Rotation2Dd(turn).toRotationMatrix();
  const Eigen::Matrix2Xd error = (rotation * (from.colwise() - from_mean)).colwise() + to_mean - to;
  return std::sqrt(error.squaredNorm() / static_cast<double>(truth.size()));
}

}  // namespace luminav
