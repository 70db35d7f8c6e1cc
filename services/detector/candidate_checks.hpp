#pragma once

#include <string_view>

#include "services/common/geometry/camera_model.hpp"
#include "services/detector/candidate.hpp"
#include "services/detector/ceiling_catalogue.hpp"
#include "services/detector/detector_params.hpp"

namespace luminav {

/// The objection that a region cut out at a lower level may overcome.
inline constexpr std::string_view kNotFilled = "not filled";
/// The objection that a kind may overcome of which the building has far more than of the other.
inline constexpr std::string_view kMayBeAnother = "may be another kind";

/// What speaks against a candidate: its size, sides and ends without edges, an inside that is not filled, or something
/// else that is listed and may look the same.
class CandidateChecks {
 public:
  CandidateChecks(const ModernDetectorParams& params, const CeilingCamera& camera, const CeilingCatalogue& catalogue)
      : params_(params), camera_(camera), catalogue_(catalogue) {}

  /// Why a candidate cannot be what it was guessed to be; null when nothing speaks against it. `level` [grey] at which
  /// its lit region was cut out, 0 = unlit.
  [[nodiscard]] const char* objection(const CeilingFrame& frame, const Candidate& candidate, int level) const;

  /// Of a lit candidate that `kMayBeAnother` objects to: what else it may be, when it is likely all the same.
  [[nodiscard]] std::optional<NarrowerReading> rare_narrower(const CeilingFrame& frame,
                                                             const Candidate& candidate) const;

 private:
  [[nodiscard]] const char* objection_to_disc(const CeilingFrame& frame, const Candidate& candidate, int level) const;
  [[nodiscard]] const char* objection_to_edges(const Candidate& candidate, int level) const;
  /// Of a candidate whose other long side is beyond the image border.
  [[nodiscard]] const char* objection_to_one_side(const Candidate& candidate, Side side, bool bright) const;
  [[nodiscard]] const char* objection_to_ends(const OutlineFit& fit, bool bright) const;
  [[nodiscard]] bool may_be_something_else(const CeilingFrame& frame, const Candidate& candidate, bool bright) const;
  /// An unlit one is dark just inside of an end in view and no longer just outside.
  [[nodiscard]] bool ends_where_it_says(const CeilingFrame& frame, const Candidate& candidate, int end) const;
  /// An unlit one without an end in view is as dark where it leaves the view as elsewhere.
  [[nodiscard]] bool goes_on_to_the_border(const CeilingFrame& frame, const Candidate& candidate) const;
  [[nodiscard]] bool is_filled(const CeilingFrame& frame, const Candidate& candidate, int level) const;

  ModernDetectorParams params_;
  CeilingCamera camera_;
  CeilingCatalogue catalogue_;
};

}  // namespace luminav
