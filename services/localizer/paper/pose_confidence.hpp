#pragma once

#include <algorithm>
#include <cmath>

namespace luminav {

/// How one image fits a pose.
struct ViewEvidence {
  int fits = 0;     // sightings that a fixture explains
  int misfits = 0;  // sightings that none explains
  int absent = 0;   // fixtures that ought to be wholly in view and were not sighted
  bool is_in_wall = false;
};

/// What a right and a wrong pose make likely. Wrong poses are seldom just anywhere: they are those of rooms that look
/// alike, in which much fits.
struct ConfidenceParams {
  double fit_if_right = 0.95;  // probability that a sighting fits
  double fit_if_wrong = 0.40;
  double seen_if_right = 0.90;  // that a fixture wholly in view is sighted
  double seen_if_wrong = 0.45;
  double wall_if_right = 0.01;  // that the pose lies inside a wall
  double wall_if_wrong = 0.20;
  double independence = 0.33;  // share of an image that is news: the next one shows the same fixture
  double sure = 3.0;           // log ratio at which a pose is trusted; more than this is not kept
  double refuted = -0.5;       // log ratio at which it is given up
};

/// The paper's confidence as Wald's sequential test (1945): the log of how much likelier all that was seen, and not
/// seen, is from this pose than from a wrong one. Capped, so that a pose that was right for an hour is still given up
/// (Page 1954).
class PoseConfidence {
 public:
  explicit PoseConfidence(const ConfidenceParams& params) : params_(params) {}

  void restart() { log_ratio_ = 0.0; }
  void add(const ViewEvidence& view) {
    const ConfidenceParams& p = params_;
    const double news = view.fits * std::log(p.fit_if_right / p.fit_if_wrong) +
                        view.misfits * std::log((1.0 - p.fit_if_right) / (1.0 - p.fit_if_wrong)) +
                        view.absent * std::log((1.0 - p.seen_if_right) / (1.0 - p.seen_if_wrong)) +
                        (view.is_in_wall ? std::log(p.wall_if_right / p.wall_if_wrong) : 0.0);
    log_ratio_ = std::min(p.sure, log_ratio_ + p.independence * news);
  }
  [[nodiscard]] bool is_sure() const { return log_ratio_ >= params_.sure; }
  [[nodiscard]] bool is_refuted() const { return log_ratio_ <= params_.refuted; }
  [[nodiscard]] double log_ratio() const { return log_ratio_; }

 private:
  ConfidenceParams params_;
  double log_ratio_ = 0.0;
};

}  // namespace luminav
