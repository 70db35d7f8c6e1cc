#pragma once

#include <optional>

#include "services/common/geometry/camera_model.hpp"
#include "services/detector/model/detector_params.hpp"
#include "services/detector/outline/ceiling_catalogue.hpp"
#include "services/detector/validation/candidate.hpp"
#include "services/detector/validation/other_kinds.hpp"
#include "services/detector/validation/verdict.hpp"

namespace luminav {

/// What speaks against a candidate. There are two ways to be accepted: the outline shows its edges nearly all along,
/// or, of a lamp that is whole in view, the region has the kind's size and shape and stands alone. What is inside
/// (tubes, louvres, reflectors), and how the glow falls off outside, is no reason to refuse.
class CandidateChecks {
 public:
  CandidateChecks(const ModernDetectorParams& params, const CeilingCamera& camera, const CeilingCatalogue& catalogue)
      : params_(params), camera_(camera), other_kinds_(camera, catalogue, params.max_bloom) {}

  [[nodiscard]] Verdict by_edges(const CeilingFrame& frame, const Candidate& candidate) const;
  /// Of a bare batten, before it is fitted: shadows are narrow, the ceiling beyond them is as bright as the batten.
  [[nodiscard]] bool lies_between_shadows(const CeilingFrame& frame, const Candidate& candidate) const;
  /// Of a lamp that is whole in view.
  [[nodiscard]] Verdict by_region(const CeilingFrame& frame, const Candidate& candidate) const;

 private:
  /// What lies beside an outline.
  struct Surroundings {
    double inside = 0.0;        // [grey] mean
    double ring = 0.0;          // [grey] mean of what is in view around it
    double bright_share = 0.0;  // share of the ring above the level at which the region was cut out
    int in_view = 0;            // places of the ring
  };
  [[nodiscard]] Verdict sides(const Candidate& candidate) const;
  [[nodiscard]] Verdict ends(const Candidate& candidate) const;
  [[nodiscard]] Verdict disc(const Candidate& candidate) const;
  [[nodiscard]] Verdict piece(const Candidate& candidate) const;
  [[nodiscard]] bool is_sunk(const CeilingFrame& frame, const Candidate& candidate) const;
  [[nodiscard]] bool has_right_size(const Candidate& candidate) const;
  [[nodiscard]] Verdict contrast(const CeilingFrame& frame, const Candidate& candidate) const;
  [[nodiscard]] std::optional<int> level_across(const CeilingFrame& frame, const Candidate& candidate,
                                                const PointTransform& pose, double along) const;
  [[nodiscard]] Surroundings surroundings(const CeilingFrame& frame, const Candidate& candidate) const;

  ModernDetectorParams params_;
  CeilingCamera camera_;
  OtherKinds other_kinds_;
};

}  // namespace luminav
