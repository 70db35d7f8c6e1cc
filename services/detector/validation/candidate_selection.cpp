#include "services/detector/validation/candidate_selection.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace luminav {

using Eigen::Vector2d;

void CandidateSelection::begin_frame() {
  accepted_.clear();
  detections_.clear();
}

bool CandidateSelection::explains(const Vector2d& place) const {
  const auto covers = [&](const Pose2& pose, double length, double width) {
    const Vector2d inside = PointTransform::inverse_of(pose) * place;
    return std::abs(inside.x()) < 0.5 * length + 0.02 && std::abs(inside.y()) < 0.5 * width + 0.02;
  };
  return std::any_of(accepted_.begin(), accepted_.end(),
                     [&](const Candidate& candidate) {
                       const Outline& outline = candidate.hypothesis.outline;
                       return candidate.is_certain() &&
                              covers(candidate.fit.placement.pose, outline.length, outline.width);
                     }) ||
         std::any_of(detections_.begin(), detections_.end(), [&](const Detection& detection) {
           return covers(detection.robot_from_fixture, detection.length, detection.width);
         });
}

void CandidateSelection::take_best_first(const CeilingFrame& frame) {
  std::sort(accepted_.begin(), accepted_.end(),
            [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  for (const Candidate& candidate : accepted_) {
    const std::optional<Detection> detection = builder_.build(frame, candidate);
    if (detection && !overlaps(*detection)) {
      detections_.push_back(*detection);
    }
  }
  accepted_.clear();
}

bool CandidateSelection::overlaps(const Detection& detection) const {
  return std::any_of(detections_.begin(), detections_.end(), [&](const Detection& other) {
    const Vector2d offset = other.robot_from_fixture.inverse() * detection.robot_from_fixture.position();
    return std::abs(offset.x()) < 0.5 * std::max(other.length, 0.1) + 0.05 &&
           std::abs(offset.y()) < 0.5 * (other.width + detection.width) + 0.03;
  });
}

}  // namespace luminav
