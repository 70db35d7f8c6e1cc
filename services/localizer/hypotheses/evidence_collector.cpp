#include "services/localizer/hypotheses/evidence_collector.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "services/localizer/model/pose_kalman.hpp"

namespace luminav {

void EvidenceCollector::clear() {
  motion_ = {};
  echoes_.clear();
  forgotten_.clear();
}

void EvidenceCollector::advance(const Pose2& delta) {
  motion_.has_moved = true;
  predict(motion_.step, delta, odometry_noise_with_systematics(delta, model_.wheel_base, model_.errors));
  const double distance = std::hypot(delta.x, delta.y);
  motion_.distance += distance;
  distance_since_correction_ += distance + 0.5 * std::abs(delta.theta);
}

void EvidenceCollector::bridge(const Pose2& step, const Eigen::Matrix3d& noise) {
  motion_.has_moved = true;
  motion_.settles = true;
  predict(motion_.step, step, noise);
  distance_since_correction_ += decorrelation_distance_;
}

void EvidenceCollector::add_image(const std::vector<ObjectTrack>& forgotten) {
  ++images_;
  forgotten_.insert(forgotten_.end(), forgotten.begin(), forgotten.end());
}

void EvidenceCollector::hand_over(EvidenceRound& round) {
  round.echoes = std::exchange(echoes_, {});
  round.motion = std::exchange(motion_, {});
  if (round.has_image) {
    round.images = std::min(std::exchange(images_, 0), EvidenceRound::kMaxImages);
    round.forgotten = std::exchange(forgotten_, {});
    // Constant errors are drawn anew only every `decorrelation_distance`: between, an image counts for its share of it.
    round.share = std::clamp(distance_since_correction_ / decorrelation_distance_, 0.02, 1.0);
    distance_since_correction_ = 0.0;
  }
}

}  // namespace luminav
