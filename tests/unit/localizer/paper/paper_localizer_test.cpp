#include "services/localizer/paper/paper_localizer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "services/localizer/localizer_config.hpp"
#include "tests/unit/localizer/synthetic_world.hpp"

namespace luminav {
namespace {

/// A robot in the laboratory, which has no twin rooms to speak of, followed by the paper's method.
class PaperLocalizerTest : public ::testing::Test {
 protected:
  PaperLocalizerTest() {
    const std::string launch = std::string(LUMINAV_SOURCE_DIR) + "/launch";
    config_ = read_localizer_config(launch + "/robots/p3dx.toml", launch + "/buildings/laboratory/building.toml");
    config_.mode = LocalizerMode::kPaper;
    testing::SyntheticOptions options;
    options.seed = 3;
    options.clutter = 0;
    world_ = std::make_unique<testing::SyntheticWorld>(config_.building, config_.walls, config_.robot, options);
    localizer_ = make_localizer(config_);
  }

  /// Drives until `is_enough` says so after an odometry reading, or the seconds are over; false then.
  template <typename Predicate>
  bool drive(double seconds, const Predicate& is_enough) {
    for (int i = 0; i < static_cast<int>(30.0 * seconds); ++i) {
      const auto output = world_->step();
      if (output.frame) {
        localizer_->add_frame(*output.frame);
      }
      if (output.odometry) {
        localizer_->add_odometry(*output.odometry);
        if (is_enough()) {
          return true;
        }
      }
    }
    return false;
  }
  bool is_tracking() const { return localizer_->estimate().state == LocalizerState::kTracking; }
  /// The half-turn twin, which the paper's method may be sure of, comes near the truth at times: its heading tells it.
  bool is_right() const {
    const Pose2 pose = localizer_->estimate().belief.pose;
    return is_tracking() && distance(pose, world_->truth()) < 0.3 &&
           std::abs(wrap_angle(pose.theta - world_->truth().theta)) < radians(15.0);
  }

  LocalizerConfig config_;
  std::unique_ptr<testing::SyntheticWorld> world_;
  std::unique_ptr<Localizer> localizer_;
};

TEST_F(PaperLocalizerTest, HandsOverToTheKalmanFilterAndFollows) {
  ASSERT_TRUE(drive(600.0, [&] { return is_right(); }));
  EXPECT_EQ(localizer_->estimate().estimator, EstimatorKind::kKalmanFilter);
  EXPECT_FALSE(drive(20.0, [&] { return is_tracking() && !is_right(); }));
}

TEST_F(PaperLocalizerTest, GoesBackToTheParticleFilterWhenCarriedAway) {
  ASSERT_TRUE(drive(600.0, [&] { return is_right(); }));
  const Pose2 before = world_->truth();
  Pose2 elsewhere = world_->draw_free_pose();
  while (distance(before, elsewhere) < 4.0) {
    elsewhere = world_->draw_free_pose();
  }
  world_->kidnap(elsewhere);
  const auto searches = [&] { return localizer_->estimate().estimator == EstimatorKind::kParticleFilter; };
  EXPECT_TRUE(drive(30.0, searches));
}

TEST_F(PaperLocalizerTest, TrustsAGivenPoseOnceAFixtureSpeaksForIt) {
  (void)drive(0.5, [] { return false; });
  localizer_->add_guess({world_->truth(), 0.01 * Eigen::Matrix3d::Identity()});
  EXPECT_EQ(localizer_->estimate().estimator, EstimatorKind::kKalmanFilter);
  EXPECT_FALSE(is_tracking());
  EXPECT_TRUE(drive(60.0, [&] { return is_right(); }));
}

TEST_F(PaperLocalizerTest, LeavesAGivenPoseThatIsWrong) {
  (void)drive(0.5, [] { return false; });
  const Pose2 truth = world_->truth();
  localizer_->add_guess({{truth.x + 1.2, truth.y, truth.theta + 0.7}, 0.01 * Eigen::Matrix3d::Identity()});
  EXPECT_TRUE(drive(60.0, [&] { return localizer_->estimate().estimator != EstimatorKind::kKalmanFilter; }));
}

TEST_F(PaperLocalizerTest, WeighsAGuessAlsoWhileTracking) {
  ASSERT_TRUE(drive(600.0, [&] { return is_right(); }));
  const Pose2 truth = world_->truth();
  const Eigen::Matrix3d sharp = 0.01 * Eigen::Matrix3d::Identity();
  localizer_->add_guess({truth, sharp});
  EXPECT_TRUE(is_tracking()) << "a guess that agrees changes nothing";
  localizer_->add_guess({{truth.x + 2.0, truth.y, truth.theta}, sharp});
  EXPECT_FALSE(is_tracking());
  EXPECT_FALSE(localizer_->estimate().reason.empty());
}

}  // namespace
}  // namespace luminav
