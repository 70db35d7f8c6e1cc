#pragma once

#include "services/common/geometry/camera_model.hpp"
#include "services/detector/outline/ceiling_catalogue.hpp"
#include "services/detector/validation/candidate.hpp"

namespace luminav {

/// What else that is listed may look like a fixture, or a piece of one.
class OtherKinds {
 public:
  /// Light widens a lamp by up to `max_bloom` [m] on each side.
  OtherKinds(const CeilingCamera& camera, const CeilingCatalogue& catalogue, double max_bloom)
      : camera_(camera), catalogue_(catalogue), max_bloom_(max_bloom) {}

  /// True when another listed kind, of which more is hidden, may look like this piece, or a vent like this whole one.
  [[nodiscard]] bool may_be(const CeilingFrame& frame, const Candidate& candidate) const;

 private:
  [[nodiscard]] bool is_as_large_as_a_vent(const Candidate& candidate) const;
  /// True when a kind that hangs higher or lower has the width that this piece shows, rather than its own kind.
  [[nodiscard]] bool is_of_other_height(const Candidate& candidate) const;
  [[nodiscard]] bool is_striped(const CeilingFrame& frame, const Candidate& candidate) const;
  [[nodiscard]] bool reaches_beyond(const CeilingFrame& frame, const Candidate& candidate, Side side,
                                    double width) const;

  CeilingCamera camera_;
  CeilingCatalogue catalogue_;
  double max_bloom_;  // [m]
};

}  // namespace luminav
