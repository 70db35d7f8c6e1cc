#pragma once

#include <optional>

#include "services/common/geometry/camera_model.hpp"
#include "services/detector/candidate.hpp"
#include "services/detector/ceiling_catalogue.hpp"

namespace luminav {

/// Which listed kinds a piece may belong to of which one long side is seen: how deep it is says only that it is at
/// least that wide.
class PieceFromOneSide {
 public:
  PieceFromOneSide(const CeilingFrame& frame, const CeilingCamera& camera, const Candidate& candidate, Side side,
                   bool bright)
      : frame_(frame), camera_(camera), candidate_(candidate), side_(side), bright_(bright) {}

  /// True when it differs from what lies beyond the side and the ends in view, farther off than a joint is wide: the
  /// edge of a joint of the ceiling is none of a fixture's.
  [[nodiscard]] bool stands_out() const;
  /// True when the piece may as well be another of the kinds.
  [[nodiscard]] bool may_be_another(const CeilingCatalogue& catalogue) const;
  /// The narrower kind of fixture that it may be as well, when all that is open is which of these two it is, and far
  /// more of the wider kind hang in the building. Half of a fixture of its own kind is no reading: few burn by half.
  [[nodiscard]] std::optional<NarrowerReading> rare_narrower(const CeilingCatalogue& catalogue) const;

 private:
  /// `length` [m] of the side in view, `width` away from it.
  [[nodiscard]] bool may_be(double length, double width) const;
  /// Grey level, or depth below the surroundings, at a place of the outline; nothing out of view.
  [[nodiscard]] std::optional<double> level_at(const Eigen::Vector2d& place) const;
  /// Mean over the side at a distance [m] from it, inwards.
  [[nodiscard]] double mean_level(double inwards) const;
  /// True when something dark ends at the side and is as dark farther in: a head that leans in has a soft edge and
  /// grows darker.
  [[nodiscard]] bool is_evenly_dark() const;
  /// Mean difference between places inside of an edge and places beyond it.
  [[nodiscard]] std::optional<double> difference(Side side) const;
  struct Places {
    int like_inside = 0;
    int unlike = 0;
  };
  /// Of those along the side that are in view so far from it [m], inwards; the inside is that of a thing of a `width`.
  [[nodiscard]] Places look_at(double distance, double width) const;
  /// [m] by which the far side of a thing may look farther off than it is.
  [[nodiscard]] double blurred_reach() const;
  /// True when it goes on beyond the far side of a narrower thing.
  [[nodiscard]] bool goes_on_beyond(double width) const;
  [[nodiscard]] bool is_rather(const CeilingKind& kind) const;
  [[nodiscard]] bool may_be_it_or_half_of(const CeilingKind& kind) const;
  [[nodiscard]] bool may_be_an_element(const CeilingCatalogue& catalogue) const;

  const CeilingFrame& frame_;
  const CeilingCamera& camera_;
  const Candidate& candidate_;
  Side side_;
  bool bright_;
};

}  // namespace luminav
