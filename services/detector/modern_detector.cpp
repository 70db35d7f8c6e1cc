#include "services/detector/modern_detector.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "services/detector/sampling/grey_histogram.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr std::array kLitLevels{250, 240, 225, 200, 175, 150, 125, 100, 80, 62, 48, 36, 28};  // [grey]
constexpr std::array kDepths{60, 40, 27, 18, 12, 8, 6, 4};                                    // [grey]
constexpr std::array kShadows{9, 5};  // [grey] beside bare battens
constexpr int kFewCells = 6;          // by which no region changes
constexpr std::size_t kMedianSamples = 5000;
// What is unlit is darker by a share of the ceiling's grey level: a dim image is multiplied first, up to this median.
constexpr int kCeilingGrey = 120;
constexpr int kMaxGain = 3;
constexpr double kMaxNoise = 14.0;       // [grey] of a pixel: what varies more is no noise
constexpr double kRagged = 0.02;         // [m] by which noise and grid lines may change a side of an unlit region
constexpr double kOtherSize = 0.01;      // share by which an unlit region's length must miss to be tried as it is
constexpr double kMinBareVisible = 0.6;  // share of a bare batten: pieces of girders look like shorter ones
constexpr double kMeanBloom = 0.25;      // of the most; what is cut is placed by one side, and bloom would draw it near
constexpr double kBloomSigma = 0.4;      // of the most, 1 sigma
constexpr double kOfRegion = 0.4;        // score of a region's own rectangle, at most: edges say more

std::array<Vector2d, 4> corners_of(const Outline& outline, const OutlinePlacement& placement,
                                   const CeilingCamera& camera) {
  const double x = 0.5 * outline.length + placement.end_outset;
  const double y = 0.5 * outline.width + placement.side_outset;
  std::array<Vector2d, 4> corners{Vector2d(x, y), Vector2d(-x, y), Vector2d(-x, -y), Vector2d(x, -y)};
  for (Vector2d& corner : corners) {
    corner = camera.pixel_of_ceiling_point(placement.pose * corner, outline.height).value_or(Vector2d(-1.0, -1.0));
  }
  return corners;
}

/// A place of a region, robot frame [m].
Vector2d middle_of(const Region& region, const CellPlane& plane) {
  const Run& middle = region.runs[region.runs.size() / 2];
  return plane.at((middle.first + middle.last) / 2, middle.row);
}

void add_contour(const RegionShape& shape, int factor, DetectorTrace* trace) {
  if (trace != nullptr) {
    std::vector<Vector2d> contour;
    for (const Eigen::Vector2i& cell : shape.hull_cells()) {
      contour.emplace_back(factor * (cell.x() + 0.5) - 0.5, factor * (cell.y() + 0.5) - 0.5);
    }
    trace->contours.push_back(std::move(contour));
  }
}

/// What a region's own rectangle says: as sure as its cells are small and its light is even.
OutlineFit fit_of_region(const OutlineHypothesis& hypothesis, double cell) {
  const Outline& outline = hypothesis.outline;
  OutlineFit fit{
      .placement = hypothesis.start, .visible_from = -0.5 * outline.length, .visible_to = 0.5 * outline.length};
  const double along = cell + 0.02 * outline.length;
  const double across = cell + 0.10 * outline.width;
  fit.covariance =
      Eigen::Vector3d(along * along, across * across, std::pow(2.0 * across / outline.length, 2)).asDiagonal();
  return fit;
}

}  // namespace

ModernDetector::ModernDetector(const ModernDetectorParams& params, const CeilingCamera& camera,
                               const CeilingCatalogue& catalogue)
    : params_(params),
      camera_(camera),
      catalogue_(catalogue),
      limits_(params, camera, catalogue),
      plane_(camera_, limits_.factor, catalogue.ceiling_height),
      proposer_(plane_, catalogue_),
      fitter_(camera_),
      checks_(params_, camera_, catalogue_),
      selection_(camera_, catalogue_, params.max_bloom) {}

const std::vector<Detection>& ModernDetector::detect(const GreyView& image, DetectorTrace* trace) {
  selection_.begin_frame();
  tried_.begin_frame();
  reduce(image, limits_.factor, reduced_);
  const GreyHistogram histogram(cells_of(reduced_), 1 + reduced_.total() / kMedianSamples);
  median_ = histogram.median();
  if (catalogue_.fixtures.empty()) {
    return selection_.detections();
  }
  const int gain = std::clamp(kCeilingGrey / std::max(median_, 1), 1, kMaxGain);
  const Raster& unlit_cells = gain > 1 ? brightened_cells_ : reduced_;
  if (gain > 1) {
    reduce(image, limits_.factor, brightened_cells_, gain);
  }
  const double noise = std::clamp(contrast_.noise_of(unlit_cells) * limits_.factor / gain, 1.0, kMaxNoise);
  double brightest = 0.0;
  cv::minMaxLoc(reduced_, nullptr, &brightest);
  const CeilingFrame frame{.image = image,
                           .reduced = reduced_,
                           .dark = contrast_.dark(),
                           .factor = limits_.factor,
                           .pixel_noise = noise,
                           .brightest = static_cast<int>(brightest),
                           .saturated = histogram.share_from(kLitLevels.front())};
  look_for(true, kLitLevels, frame, trace);
  const CeilingFrame unlit_frame{.image = image,
                                 .reduced = unlit_cells,
                                 .dark = contrast_.dark(),
                                 .factor = limits_.factor,
                                 .pixel_noise = noise,
                                 .gain = gain};
  if (!limits_.is_narrow) {
    contrast_.compute(unlit_cells, limits_.window_radius, limits_.ignore_lines);
    look_for(false, kDepths, unlit_frame, trace);
  }
  if (limits_.bare_radius > 0) {
    look_for_bare(unlit_frame, trace);
  }
  return selection_.detections();
}

/// A bare batten that is off is about as bright as the ceiling, and lies between its own shadows: in the negative it is
/// a dark strip between two bright lines.
void ModernDetector::look_for_bare(const CeilingFrame& unlit, DetectorTrace* trace) {
  cv::bitwise_not(raster_of(unlit.image), negative_);
  cv::bitwise_not(unlit.reduced, negative_cells_);
  contrast_.compute_narrow(negative_cells_, limits_.bare_radius, limits_.factor < 4);
  const GreyView negative = view_of(negative_);
  const CeilingFrame frame{.image = negative,
                           .reduced = negative_cells_,
                           .dark = contrast_.dark(),
                           .factor = limits_.factor,
                           .pixel_noise = unlit.pixel_noise,
                           .gain = unlit.gain,
                           .is_negative = true};
  look_for(false, kShadows, frame, trace);
}

/// A fixture is brighter, or darker, than all around it, however the light is distributed: at some level it stands
/// alone.
void ModernDetector::look_for(bool bright, std::span<const int> levels, const CeilingFrame& frame,
                              DetectorTrace* trace) {
  tried_.clear();
  const double least = bright ? median_ + params_.lit_contrast : params_.unlit_contrast;
  const Raster& cells = bright ? frame.reduced : is_eroded(frame) ? contrast_.eroded() : frame.dark;
  int known = 0;  // cells above the level before
  for (const int level : levels) {
    if (level < least) {
      break;
    }
    cv::compare(cells, level, mask_, cv::CMP_GT);
    const int above = cv::countNonZero(mask_);
    if (above < known + kFewCells) {
      continue;  // regions are those of the level before
    }
    known = above;
    for (const Region& region : finder_.find(mask_, limits_.min_cells)) {
      if (limits_.may_be_a_kind(region, plane_) && !selection_.explains(middle_of(region, plane_))) {
        look_at_region(region, {level, bright}, frame, trace);
      }
    }
  }
  selection_.take_best_first(frame);
}

void ModernDetector::look_at_region(const Region& region, const Layer& layer, const CeilingFrame& frame,
                                    DetectorTrace* trace) {
  if (!shape_.take(region, !layer.bright && is_eroded(frame) ? 1 : 0, plane_)) {
    return;
  }
  add_contour(shape_, limits_.factor, trace);
  const SizeTolerance tolerance{
      .share = params_.size_tolerance,
      .ragged = kRagged,
      .bloom = layer.bright ? params_.max_bloom : 0.0,
      .min_visible = frame.is_negative ? kMinBareVisible : 0.7 * params_.min_visible,
      .min_width = layer.bright ? 0.0 : RegionLimits::kMinAcross * shape_.cell_size() / limits_.factor,
      .is_bare = frame.is_negative,
      .is_white = layer.bright && layer.level == kLitLevels.front()};
  const std::vector<OutlineHypothesis>& hypotheses = proposer_.propose(shape_, layer.bright, tolerance);
  if (hypotheses.empty()) {
    return;
  }
  OutlineFitParams params = fit_params(region, layer, frame);
  for (const OutlineHypothesis& hypothesis : hypotheses) {
    if (!tried_.add(hypothesis)) {
      continue;
    }
    params.unseen = hypothesis.drowned;
    Candidate candidate{.hypothesis = hypothesis, .fit = {}, .level = layer.level, .bright = layer.bright};
    const Verdict verdict = judge(frame, params, candidate);
    if (trace != nullptr) {
      trace->rectangles.push_back(corners_of(hypothesis.outline, candidate.fit.placement, camera_));
      trace->verdicts.emplace_back(to_string(verdict));
    }
    if (verdict == Verdict::kAccepted) {
      selection_.add(candidate);
      if (candidate.is_certain()) {
        break;  // the others are of worse size
      }
    } else if (hypothesis.is_whole && layer.bright) {
      tried_.forget_last();  // at a lower level it may be
    }
  }
}

Verdict ModernDetector::judge(const CeilingFrame& frame, const OutlineFitParams& params, Candidate& candidate) {
  const OutlineHypothesis& hypothesis = candidate.hypothesis;
  candidate.fit.placement = hypothesis.start;
  if (candidate.bright) {
    const Verdict verdict = judge_edges(frame, params, hypothesis.start, candidate);
    return verdict == Verdict::kAccepted || !hypothesis.is_whole ? verdict : judge_region(frame, candidate);
  }
  if (frame.is_negative && !checks_.lies_between_shadows(frame, candidate)) {
    return Verdict::kNoContrast;
  }
  // What is dark has no bloom: it is first looked for in its nominal size, then, as the file may be wrong, in that of
  // its region.
  const Verdict verdict = judge_edges(frame, params, {hypothesis.start.pose}, candidate);
  return verdict == Verdict::kAccepted || hypothesis.size_error < kOtherSize
             ? verdict
             : judge_edges(frame, params, hypothesis.start, candidate);
}

Verdict ModernDetector::judge_edges(const CeilingFrame& frame, const OutlineFitParams& params,
                                    const OutlinePlacement& start, Candidate& candidate) {
  const auto fit = fitter_.fit(frame.image, candidate.hypothesis.outline, params, start);
  if (!fit) {
    return Verdict::kNoEdges;
  }
  candidate.fit = *fit;
  if (candidate.bright && !candidate.hypothesis.is_whole) {
    candidate.fit.leave_out_end_below(params_.min_end_support);  // where the file says it ends, it may go on
  }
  candidate.score = fit->quality() + 0.1 * fit->ends_visible() - candidate.hypothesis.size_error;
  return checks_.by_edges(frame, candidate);
}

Verdict ModernDetector::judge_region(const CeilingFrame& frame, Candidate& candidate) {
  candidate.by_edges = false;
  candidate.fit = fit_of_region(candidate.hypothesis, shape_.cell_size());
  candidate.fit.metres_per_px = shape_.cell_size() / limits_.factor;
  candidate.score = kOfRegion * candidate.hypothesis.fill - candidate.hypothesis.size_error;
  return checks_.by_region(frame, candidate);
}

OutlineFitParams ModernDetector::fit_params(const Region& region, const Layer& layer, const CeilingFrame& frame) const {
  const Raster& cells = layer.bright ? frame.reduced : frame.dark;
  int sum = 0;
  for (const Run& run : region.runs) {
    const std::uint8_t* row = cells[run.row];
    sum = std::accumulate(row + run.first, row + run.last + 1, sum);
  }
  const double mean = static_cast<double>(sum) / (std::max(region.cells, 1) * frame.gain);
  return {.inside_brighter = layer.bright,
          .min_edge = layer.bright ? params_.lit_edge : params_.unlit_edge / frame.gain,
          .expected_step = mean - (layer.bright ? median_ : 0),
          .pixel_noise = frame.pixel_noise,
          .side_mean = layer.bright ? kMeanBloom * params_.max_bloom : 0.0,
          .side_sigma = layer.bright ? kBloomSigma * params_.max_bloom : 0.008,
          .edge_sigma_px = params_.edge_sigma_px,
          .outline_sigma_px = params_.outline_sigma_px};
}

}  // namespace luminav
