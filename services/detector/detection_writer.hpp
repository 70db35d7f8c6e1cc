#pragma once

#include <optional>

#include "services/common/geometry/camera_model.hpp"
#include "services/detector/candidate.hpp"
#include "services/detector/ceiling_catalogue.hpp"
#include "services/detector/detection.hpp"

namespace luminav {

/// Turns accepted candidates into detections: what is in view, which ends, how sure, lit wholly or by half.
class DetectionWriter {
 public:
  DetectionWriter(const CeilingCamera& camera, const CeilingCatalogue& catalogue)
      : camera_(camera), catalogue_(catalogue) {}

  [[nodiscard]] Detection detection_of(const Candidate& candidate, DetectionState state) const;
  /// Decides whether a lit strip is a fixture of one lamp or the burning half of one of two; nothing when the picture
  /// does not say.
  [[nodiscard]] std::optional<Detection> resolve_strip(const CeilingFrame& frame, const Candidate& strip) const;
  /// The side of a lit fixture of two lamps on which the one that does not burn lies; nothing when both burn, or none
  /// of that size has two.
  [[nodiscard]] std::optional<Side> dark_half(const CeilingFrame& frame, const Candidate& candidate) const;

 private:
  /// The kind of fixture that looks like this outline when it is whole; a null pointer when there is none.
  [[nodiscard]] const CeilingKind* kind_of(const Outline& outline) const;

  CeilingCamera camera_;
  CeilingCatalogue catalogue_;
};

}  // namespace luminav
