#pragma once

#include <optional>
#include <vector>

#include "services/common/configuration/robot_file.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/ceiling_catalogue.hpp"
#include "services/detector/contrast_map.hpp"
#include "services/detector/detection.hpp"
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

 private:
  struct Candidate {
    OutlineHypothesis hypothesis;
    OutlineFit fit;
    double score = 0.0;
  };
  void look_for_lit(const GreyView& image, std::vector<Detection>& detections, DetectorTrace* trace);
  void look_for_unlit(const GreyView& image, std::vector<Detection>& detections, DetectorTrace* trace);
  [[nodiscard]] bool is_explained(const Region& region, const std::vector<Detection>& detections) const;
  void cut_out_bright(int level);
  void cut_out_dark();
  [[nodiscard]] OutlineFitParams fit_params(const Region& region, int level) const;
  [[nodiscard]] std::optional<Candidate> best_candidate(const GreyView& image, const Region& region, int shrunk,
                                                        int level, DetectorTrace* trace);
  /// Why a candidate cannot be what it was guessed to be; null when nothing speaks against it.
  [[nodiscard]] const char* objection(const GreyView& image, const Candidate& candidate, int level) const;
  [[nodiscard]] bool may_be_something_else(const GreyView& image, const Candidate& candidate, bool bright) const;
  /// An unlit one is dark just inside of an end in view and no longer just outside.
  [[nodiscard]] bool ends_where_it_says(const Candidate& candidate, int end) const;
  [[nodiscard]] bool is_filled(const Candidate& candidate, int level) const;
  /// True when one half along the outline is clearly brighter than the other.
  [[nodiscard]] bool burns_on_one_side(const Candidate& candidate) const;
  /// Decides whether a lit strip is a fixture of one lamp or the burning half of one of two; nothing when the picture
  /// does not say.
  [[nodiscard]] std::optional<Detection> resolve_strip(const GreyView& image, const Candidate& strip) const;
  [[nodiscard]] std::array<Eigen::Vector2d, 4> corners_of(const OutlineHypothesis& hypothesis) const;
  [[nodiscard]] Detection detection_of(const Candidate& candidate, DetectionState state) const;
  [[nodiscard]] bool overlaps(const Detection& detection, const std::vector<Detection>& others) const;

  ModernDetectorParams params_;
  CeilingCamera camera_;
  CeilingCatalogue catalogue_;
  int factor_;
  CellPlane plane_;
  double metres_per_px_;
  int window_radius_;  // [cells]
  int least_cells_;    // of a region
  int erosion_;        // [cells] of dark regions
  bool ignore_lines_;  // between tiles
  Raster reduced_;
  Raster mask_;
  Raster eroded_;
  Raster scratch_;
  ContrastMap contrast_;
  std::vector<OutlineHypothesis> tried_;  // in this frame
  RegionFinder finder_;
  OutlineProposer proposer_;
  OutlineFitter fitter_;
};

}  // namespace luminav
