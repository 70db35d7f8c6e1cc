#pragma once

#include <span>
#include <vector>

#include "services/common/image/grey_image.hpp"
#include "services/detector/hypotheses/cell_plane.hpp"
#include "services/detector/hypotheses/outline_proposer.hpp"
#include "services/detector/hypotheses/region_limits.hpp"
#include "services/detector/hypotheses/region_shape.hpp"
#include "services/detector/hypotheses/tried_hypotheses.hpp"
#include "services/detector/model/detection.hpp"
#include "services/detector/model/detector_params.hpp"
#include "services/detector/model/detector_trace.hpp"
#include "services/detector/outline/ceiling_catalogue.hpp"
#include "services/detector/outline/outline_fit.hpp"
#include "services/detector/segmentation/contrast_map.hpp"
#include "services/detector/segmentation/regions.hpp"
#include "services/detector/validation/candidate_checks.hpp"
#include "services/detector/validation/candidate_selection.hpp"

namespace luminav {

/// Segment, propose, fit, validate, describe: regions that stand out from their surroundings at some level -> guesses
/// of known size in metres -> edges to sub-pixel -> accepted by its edges or, of a lamp, by standing alone -> poses.
/// Whatever has no known size, or may as well be something else, is left out: a false fixture costs more than a missed
/// one.
class ModernDetector {
 public:
  ModernDetector(const ModernDetectorParams& params, const CeilingCamera& camera, const CeilingCatalogue& catalogue);
  ModernDetector(const ModernDetector&) = delete;
  ModernDetector& operator=(const ModernDetector&) = delete;

  /// The image has the camera model's size. Valid until the next call. `trace` may be null.
  const std::vector<Detection>& detect(const GreyView& image, DetectorTrace* trace);
  /// Of the image seen last, over its cells of several pixels.
  [[nodiscard]] int median_grey() const { return median_; }

 private:
  /// Regions of one level of brightness, or of depth.
  struct Layer {
    int level;  // [grey]
    bool bright;
  };
  void look_for(bool bright, std::span<const int> levels, const CeilingFrame& frame, DetectorTrace* trace);
  void look_for_bare(const CeilingFrame& unlit, DetectorTrace* trace);
  /// By a cell: what is dark, unless it is narrow.
  [[nodiscard]] bool is_eroded(const CeilingFrame& frame) const { return limits_.is_eroded && !frame.is_negative; }
  void look_at_region(const Region& region, const Layer& layer, const CeilingFrame& frame, DetectorTrace* trace);
  [[nodiscard]] Verdict judge(const CeilingFrame& frame, const OutlineFitParams& params, Candidate& candidate);
  [[nodiscard]] Verdict judge_edges(const CeilingFrame& frame, const OutlineFitParams& params,
                                    const OutlinePlacement& start, Candidate& candidate);
  [[nodiscard]] Verdict judge_region(const CeilingFrame& frame, Candidate& candidate);
  [[nodiscard]] OutlineFitParams fit_params(const Region& region, const Layer& layer, const CeilingFrame& frame) const;

  ModernDetectorParams params_;
  CeilingCamera camera_;
  CeilingCatalogue catalogue_;
  RegionLimits limits_;
  CellPlane plane_;
  int median_ = 0;  // [grey] of the reduced image
  Raster reduced_;
  Raster brightened_cells_;  // of a dim image
  Raster mask_;              // of what is above a level
  Raster negative_;          // of an image in which bare battens are looked for
  Raster negative_cells_;
  ContrastMap contrast_;
  RegionFinder finder_;
  RegionShape shape_;
  OutlineProposer proposer_;
  OutlineFitter fitter_;
  CandidateChecks checks_;
  TriedHypotheses tried_;
  CandidateSelection selection_;
};

}  // namespace luminav
