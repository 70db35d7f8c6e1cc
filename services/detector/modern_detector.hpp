#pragma once

#include <optional>
#include <vector>

#include "services/common/configuration/robot_file.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/candidate.hpp"
#include "services/detector/candidate_checks.hpp"
#include "services/detector/ceiling_catalogue.hpp"
#include "services/detector/contrast_map.hpp"
#include "services/detector/detection.hpp"
#include "services/detector/detection_writer.hpp"
#include "services/detector/detector_params.hpp"
#include "services/detector/detector_trace.hpp"
#include "services/detector/outline_fit.hpp"
#include "services/detector/region_outline.hpp"
#include "services/detector/regions.hpp"

namespace luminav {

/// Regions that stand out from their surroundings -> guesses of known size -> edges to sub-pixel -> accepted only when
/// the outline shows its edges nearly all along. Whatever has no known size, or may as well be something else, is left
/// out: a false fixture costs more than a missed one.
class ModernDetector {
 public:
  ModernDetector(const ModernDetectorParams& params, const CeilingCamera& camera, const CeilingCatalogue& catalogue);
  ModernDetector(const ModernDetector&) = delete;
  ModernDetector& operator=(const ModernDetector&) = delete;

  /// The image has the camera model's size. `trace` may be null.
  void detect(const GreyView& image, std::vector<Detection>& detections, DetectorTrace* trace);
  /// Of the image seen last, over its cells of several pixels.
  [[nodiscard]] int median_grey() const { return median_; }

 private:
  void look_for_lit(const CeilingFrame& frame, std::vector<Detection>& detections, DetectorTrace* trace);
  void look_for_unlit(const CeilingFrame& frame, std::vector<Detection>& detections, DetectorTrace* trace);
  [[nodiscard]] bool is_explained(const Region& region, const std::vector<Detection>& detections) const;
  void look_for_unlit_at(double level_share, const CeilingFrame& frame, std::vector<Detection>& detections,
                         DetectorTrace* trace);
  [[nodiscard]] int least_depth() const;  // [grey]
  /// False when that share of the local depth is nowhere more than the least.
  [[nodiscard]] bool is_deep_anywhere(double level_share) const;
  /// Into the mask; returns how many cells.
  int cut_out_dark(double level_share);
  [[nodiscard]] OutlineFitParams fit_params(const Region& region, int level) const;
  [[nodiscard]] std::optional<Candidate> best_candidate(const CeilingFrame& frame, const Region& region, int shrunk,
                                                        int level, DetectorTrace* trace);
  /// False when the fit needs not be tried.
  [[nodiscard]] bool may_be_there(const CeilingFrame& frame, const OutlineHypothesis& hypothesis,
                                  const OutlineFitParams& params) const;
  [[nodiscard]] bool overlaps(const Detection& detection, const std::vector<Detection>& others) const;

  ModernDetectorParams params_;
  CeilingCamera camera_;
  CeilingCatalogue catalogue_;
  int factor_;
  CellPlane plane_;
  double metres_per_px_;
  int window_radius_;  // [cells]
  int least_cells_;    // of a region
  int median_ = 0;     // [grey] of the reduced image
  bool is_eroded_;     // of dark regions, by a cell
  bool ignore_lines_;  // between tiles
  Raster reduced_;
  std::vector<std::uint8_t> row_peaks_;  // of the reduced image
  Raster mask_;
  ContrastMap contrast_;
  std::vector<OutlineHypothesis> tried_;  // in this frame
  std::vector<Detection> open_;           // lit ones that may be narrower ones as well
  RegionFinder finder_;
  OutlineProposer proposer_;
  OutlineFitter fitter_;
  CandidateChecks checks_;
  DetectionWriter writer_;
};

}  // namespace luminav
