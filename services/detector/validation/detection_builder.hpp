#pragma once

#include <optional>

#include "services/common/geometry/camera_model.hpp"
#include "services/detector/model/detection.hpp"
#include "services/detector/outline/ceiling_catalogue.hpp"
#include "services/detector/validation/candidate.hpp"

namespace luminav {

/// Turns accepted candidates into detections: what is in view, which ends, how sure, lit wholly or by half.
class DetectionBuilder {
 public:
  /// Light widens a lamp by up to `max_bloom` [m] on each side.
  DetectionBuilder(const CeilingCamera& camera, const CeilingCatalogue& catalogue, double max_bloom)
      : camera_(camera), catalogue_(catalogue), max_bloom_(max_bloom) {}

  /// Nothing for a lit strip of which the image does not say whether it is a fixture of one lamp or the burning half of
  /// one of two.
  [[nodiscard]] std::optional<Detection> build(const CeilingFrame& frame, const Candidate& candidate) const;

 private:
  struct Extent {  // [m] along the outline
    double from;
    double to;
  };
  [[nodiscard]] Detection detection_of(const Candidate& candidate, DetectionState state) const;
  [[nodiscard]] std::optional<Detection> resolve_strip(const CeilingFrame& frame, const Candidate& strip) const;
  /// The kind of fixture that looks like this outline when it is whole; a null pointer when there is none.
  [[nodiscard]] const CeilingKind* kind_of(const Outline& outline) const;
  [[nodiscard]] bool ends_at_dark_lamps(const CeilingFrame& frame, const Candidate& square) const;
  [[nodiscard]] const CeilingKind* kind_of_part(const OutlineHypothesis& strip) const;
  /// Lengths of the kinds that a piece may belong to, of which so much is seen [m].
  [[nodiscard]] Extent lengths_of(const Candidate& candidate, double seen) const;
  static void place_stretch(const Candidate& candidate, double length, Extent& extent, Detection& detection);
  void draw_corners(const Candidate& candidate, const Extent& extent, Detection& detection) const;

  CeilingCamera camera_;
  CeilingCatalogue catalogue_;
  double max_bloom_;  // [m]
};

}  // namespace luminav
