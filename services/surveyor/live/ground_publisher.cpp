#include "services/surveyor/live/ground_publisher.hpp"

#include <luminav/pose_t.hpp>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr double kLostVariance = 1e6;  // [m^2, rad^2]

}  // namespace

void GroundPublisher::publish(const OdometryReading& reading, LiveGround& ground, bool is_exploring) {
  if (is_exploring) {
    publish_pose(reading, ground);
  }
  if (drawing_ != ground.drawing()) {
    drawing_ = ground.drawing();
    tiles_.emplace(lcm_, TileScheduleParams{}, ground.map().grid().geometry);
    tiles_->header.map_session = reading.utime;
  }
  tiles_->mark_changed(ground.map().mapper().take_touched_tiles());
  tiles_->send_due(ground.map().grid(), reading.utime);
}

void GroundPublisher::publish_pose(const OdometryReading& reading, const LiveGround& ground) {
  pose_t message{};
  message.utime = reading.utime;
  message.session = reading.session;
  message.sequence = sequence_++;
  message.linear = reading.linear;
  message.angular = reading.angular;
  message.covariance[0] = message.covariance[4] = message.covariance[8] = kLostVariance;
  message.reason = "the survey does not know where on its map the robot is";
  if (const auto& here = ground.here()) {
    message.state = pose_t::STATE_TRACKING;
    message.estimator = pose_t::ESTIMATOR_KALMAN_FILTER;
    message.reason = "surveying";
    message.x = here->world_from_robot.x;
    message.y = here->world_from_robot.y;
    message.theta = here->world_from_robot.theta;
    Eigen::Map<Eigen::Matrix3d>(message.covariance) = ground.covariance();  // symmetric: rows are columns
    message.distance_since_fixture = ground.since_estimate();
  }
  lcm_.publish(channels::kPose, &message);
}

}  // namespace luminav
