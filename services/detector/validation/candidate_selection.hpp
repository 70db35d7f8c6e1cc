#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/common/geometry/camera_model.hpp"
#include "services/detector/model/detection.hpp"
#include "services/detector/outline/ceiling_catalogue.hpp"
#include "services/detector/validation/candidate.hpp"
#include "services/detector/validation/detection_builder.hpp"

namespace luminav {

/// From the candidates of one frame that were accepted to its detections: the best first, what overlaps a better one is
/// left out (non-maximum suppression).
class CandidateSelection {
 public:
  CandidateSelection(const CeilingCamera& camera, const CeilingCatalogue& catalogue, double max_bloom)
      : builder_(camera, catalogue, max_bloom) {}

  void begin_frame();
  void add(const Candidate& candidate) { accepted_.push_back(candidate); }
  /// True when a place, robot frame, is part of something that nothing can be said better of.
  [[nodiscard]] bool explains(const Eigen::Vector2d& place) const;
  /// Turns what was added into detections; what is added later ranks behind it.
  void take_best_first(const CeilingFrame& frame);
  [[nodiscard]] const std::vector<Detection>& detections() const { return detections_; }

 private:
  [[nodiscard]] bool overlaps(const Detection& detection) const;

  DetectionBuilder builder_;
  std::vector<Candidate> accepted_;
  std::vector<Detection> detections_;
};

}  // namespace luminav
