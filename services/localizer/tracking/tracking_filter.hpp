#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>

#include "services/common/ceiling/fixture_map.hpp"
#include "services/localizer/model/error_model.hpp"
#include "services/localizer/model/pose_belief.hpp"
#include "services/localizer/model/sighting_model.hpp"

namespace luminav {

/// How far a fixture hangs from where the building's file has it, along the world's axes and turned. [m, m, rad]
struct FixtureOffset {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// Extended Kalman filter of the robot's pose together with what is wrong with robot, camera and the fixtures seen
/// lately. Because the errors that do not average away are states with a known prior, looking at one fixture for long
/// does not make the pose surer than fixture and camera are; and what driving reveals of them is put to use.
/// Martinelli et al. 2007 for the wheels' part.
class TrackingFilter {
 public:
  TrackingFilter(double height_above_camera, const Eigen::Vector2d& robot_from_camera, double wheel_base,
                 const ErrorParams& errors);

  /// Starts at a pose. Its covariance must be wide enough for the constant errors of camera and fixtures; the first
  /// corrections then tie the pose to them.
  void start(const PoseBelief& belief);
  /// Moves on by an odometry step.
  void predict(const Pose2& delta);
  /// Innovation of a sighting taken as that fixture; twist in the robot frame at the image's time.
  [[nodiscard]] Innovation innovate(const FixtureSighting& sighting, int index, const Fixture& fixture, double linear,
                                    double angular) const;
  /// Corrects by a sighting taken as that fixture, whatever its innovation; returns its normalised innovation squared.
  double correct(const FixtureSighting& sighting, int index, const Fixture& fixture, double linear, double angular,
                 double odometer);

  /// Admits that the pose is less sure than thought.
  void widen(const Eigen::Vector3d& variances) { covariance_.topLeftCorner<3, 3>().diagonal() += variances; }
  /// Admits with a probability that another one is right, which looked at the same fixtures since they were one: mean
  /// and covariance become those of both together.
  void mix_in(const TrackingFilter& other, double probability);
  /// Returns whether a fixture was seen less than 0.5 m ago: if it is seen elsewhere now, the robot moved.
  [[nodiscard]] bool has_in_view(int fixture, double odometer) const;
  /// Admits that the place of a fixture is less sure than thought; where it is seen is remembered from then on.
  void widen_place(int fixture, const Eigen::Vector3d& variances);
  /// Takes it that a fixture may hang elsewhere than the file says: from then on it tells less of the pose, and the
  /// pose, known by others, tells where it hangs.
  void doubt(int fixture);
  /// Returns how far a fixture hangs from its place in the file, by what was seen of it lately or, if its place is not
  /// sure, ever.
  [[nodiscard]] FixtureOffset offset_of(int fixture) const;
  /// Moves on by a step that no odometry measured; its covariance in the frame at its beginning.
  void bridge(const Pose2& step, const Eigen::Matrix3d& noise);

  [[nodiscard]] PoseBelief belief() const;
  /// Where an odometry step would lead, this filter left as it is.
  [[nodiscard]] PoseBelief belief_after(const Pose2& delta) const;

  // Layout of the state. Wheels: ground covered per odometry metre - 1, drift of the heading [rad/m], turn per odometry
  // turn - 1. Camera: tilt as shift of the ceiling along x and y [rad], yaw [rad], scale - 1, time offset [s]. Floor:
  // tilt likewise. Lens: k1 left over. Then x, y, theta [m, rad] of each fixture in its slot, world
  // axes.
  static constexpr int kScale = 3, kDrift = 4, kTurn = 5, kTilt = 6, kYaw = 8, kCameraScale = 9, kTime = 10,
                       kFloor = 11, kLens = 13;
  static constexpr int kFixtures = 14;
  static constexpr int kSlots = 5;
  static constexpr int kSize = kFixtures + 3 * kSlots;
  using State = Eigen::Matrix<double, kSize, 1>;
  using Covariance = Eigen::Matrix<double, kSize, kSize>;
  [[nodiscard]] const State& state() const { return state_; }
  [[nodiscard]] const Covariance& covariance() const { return covariance_; }

 private:
  using Jacobian = Eigen::Matrix<double, 3, kSize>;
  struct Expectation {
    Eigen::Vector3d residual;
    Jacobian jacobian;
    Eigen::Matrix3d noise;
  };
  struct Slot {
    int fixture = -1;
    double odometer = 0.0;            // [m] when last used
    std::optional<Pose2> linearised;  // world_from_fixture about which it is linearised
  };
  [[nodiscard]] Expectation expect(const FixtureSighting& sighting, int index, const Fixture& fixture, int slot,
                                   double linear, double angular) const;
  [[nodiscard]] int slot_of(int fixture) const;
  int take_slot(int fixture, double odometer);
  [[nodiscard]] Pose2 corrected(const Pose2& delta) const;

  double height_above_camera_;         // [m]
  Eigen::Vector2d robot_from_camera_;  // [m]
  double wheel_base_;                  // [m]
  ErrorParams errors_;
  State state_ = State::Zero();
  Covariance covariance_ = Covariance::Identity();
  // About one estimate of each pose and each unsure fixture: with a second one after a correction the two together
  // would tell a heading that nothing shows (Huang, Mourikis and Roumeliotis 2010).
  Pose2 linearised_;
  std::array<Slot, kSlots> slots_;
  std::map<int, FixtureOffset> unsure_;  // places that are: where they were when seen last
  std::set<int> doubted_;
};

}  // namespace luminav
