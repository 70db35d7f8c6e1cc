#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "services/detector/hypotheses/outline_proposer.hpp"

namespace luminav {

/// Which guesses were fitted: none twice, and of one frame no more than 400: more are a picture of something else than
/// a ceiling.
class TriedHypotheses {
 public:
  static constexpr int kMaxFits = 400;

  void begin_frame() { fits_left_ = kMaxFits; }
  /// What comes is of other regions.
  void clear() { tried_.clear(); }
  /// False when it is not worth a fit.
  bool add(const OutlineHypothesis& hypothesis) {
    if (contains(hypothesis) || fits_left_ <= 0) {
      return false;
    }
    tried_.push_back(hypothesis);
    --fits_left_;
    return true;
  }
  /// The one added last may be tried again.
  void forget_last() { tried_.pop_back(); }

 private:
  /// The fit takes both to the same place.
  [[nodiscard]] bool contains(const OutlineHypothesis& hypothesis) const {
    return std::any_of(tried_.begin(), tried_.end(), [&](const OutlineHypothesis& other) {
      const Pose2& a = hypothesis.start.pose;
      const Pose2& b = other.start.pose;
      return hypothesis.kind == other.kind && hypothesis.burning == other.burning &&
             (a.position() - b.position()).squaredNorm() < 0.03 * 0.03 &&
             std::abs(wrap_axis(a.theta - b.theta)) < radians(3.0);
    });
  }

  std::vector<OutlineHypothesis> tried_;
  int fits_left_ = 0;  // of this frame
};

}  // namespace luminav
