#include "services/detector/modern_detector.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "services/detector/sampling/grey_histogram.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr std::array kLitLevels{250, 240, 225, 200, 175, 150, 125, 100, 80, 62, 48, 36, 28};  // [grey]
constexpr std::array kDepths{60, 40, 27, 18, 12, 8, 6, 4, 3};                                 // [grey]
constexpr std::size_t kMedianSamples = 20000;
constexpr int kMaxFits = 400;        // of a frame: more are a picture of something else than a ceiling
constexpr double kRagged = 0.02;     // [m] by which noise and grid lines may change a side of an unlit region
constexpr double kOtherSize = 0.01;  // share by which an unlit region's length must miss to be tried as it is
constexpr double kMinAcross = 16.0;  // [px] any dark speck looks like a smaller disc, any groove like a narrower piece
constexpr double kSlack = 1.4;       // times its size, and bloom, no region of a kind is larger
constexpr double kCertain = 0.9;     // share of the outline that shows an edge: nothing better is to be expected
constexpr double kOutset = 3.0;      // [1/m] by which an unlit outline is the worse, the less it has its nominal size
constexpr double kOfRegion = 0.4;    // score of a region's own rectangle, at most: edges say more

/// Of all fixtures; of one of two lamps half may burn alone.
struct SizeLimits {
  double min_width = 0.3;  // [m]
  double max_width = 0.1;  // [m]
  double min_area = 1e9;   // [m^2]
};

SizeLimits size_limits(const CeilingCatalogue& catalogue) {
  SizeLimits limits;
  for (const CeilingKind& kind : catalogue.fixtures) {
    limits.min_width = std::min(limits.min_width, kind.width);
    limits.max_width = std::max(limits.max_width, kind.width);
    limits.min_area = std::min(limits.min_area, kind.length * kind.width * (kind.lamps >= 2 ? 0.5 : 1.0));
  }
  return limits;
}

/// The largest pixel on the ceiling [m] within 50 degrees of the zenith: through a fisheye those far out are larger.
double coarsest_pixel(const CeilingCamera& camera, double height) {
  constexpr double kFarthest = 1.19;  // camera-to-ceiling distances
  const double farthest = kFarthest * (height - camera.mounting().z);
  const Vector2d foot(camera.mounting().x, camera.mounting().y);
  double coarsest = (height - camera.mounting().z) / camera.intrinsics().fx;
  for (int row = 0; row < camera.intrinsics().height; row += 16) {
    for (int column = 0; column < camera.intrinsics().width; column += 16) {
      const auto here = camera.point_on_ceiling({column, row}, height);
      const auto right = camera.point_on_ceiling({column + 1.0, static_cast<double>(row)}, height);
      const auto below = camera.point_on_ceiling({static_cast<double>(column), row + 1.0}, height);
      if (here && right && below && (*here - foot).norm() < farthest) {
        coarsest = std::max({coarsest, (*right - *here).norm(), (*below - *here).norm()});
      }
    }
  }
  return coarsest;
}

/// Cells must stay clearly smaller than the narrowest fixture.
int reduction_factor(const CeilingCamera& camera, const CeilingCatalogue& catalogue) {
  const double narrowest_px = size_limits(catalogue).min_width / coarsest_pixel(camera, catalogue.ceiling_height);
  return narrowest_px >= 20.0 ? 4 : narrowest_px >= 6.0 ? 2 : 1;
}

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

bool is_certain(const Candidate& candidate) {
  return candidate.by_edges && candidate.is_whole() && candidate.hypothesis.burning == 0 &&
         candidate.fit.quality() > kCertain;
}

}  // namespace

ModernDetector::ModernDetector(const ModernDetectorParams& params, const CeilingCamera& camera,
                               const CeilingCatalogue& catalogue)
    : params_(params),
      camera_(camera),
      catalogue_(catalogue),
      factor_(reduction_factor(camera, catalogue)),
      plane_(camera_, factor_, catalogue.ceiling_height),
      proposer_(plane_, catalogue_),
      fitter_(camera_),
      checks_(params_, camera_, catalogue_),
      builder_(camera_, catalogue_) {
  const SizeLimits limits = size_limits(catalogue_);
  const double cell = factor_ * (catalogue.ceiling_height - camera.mounting().z) / camera.intrinsics().fx;
  // wider than the widest fixture and its bloom, or its middle would count as surroundings
  window_radius_ = static_cast<int>(std::ceil(0.5 * (1.25 * limits.max_width + 0.08) / cell));
  min_cells_ = std::max(6, static_cast<int>(0.5 * params_.min_visible * limits.min_area / (cell * cell)));
  for (const auto* kinds : {&catalogue_.fixtures, &catalogue_.elements}) {
    for (const CeilingKind& kind : *kinds) {
      const double length = kSlack * kind.length + 2.0 * params_.max_bloom;
      const double width = kSlack * kind.width + 2.0 * params_.max_bloom;
      max_extent_ = std::max(max_extent_, std::hypot(length, width));
      max_area_ = std::max({max_area_, length * width, OutlineProposer::kMaxGlow * length * length});
    }
  }
  // grid lines between tiles are thinner than two cells; the narrowest fixture must survive
  is_eroded_ = limits.min_width / cell >= 5.0;
  ignore_lines_ = limits.min_width / cell >= 7.5;
}

const std::vector<Detection>& ModernDetector::detect(const GreyView& image, DetectorTrace* trace) {
  detections_.clear();
  reduce(image, factor_, reduced_);
  const GreyHistogram histogram(reduced_.cells, 1 + reduced_.cells.size() / kMedianSamples);
  median_ = histogram.median();
  if (catalogue_.fixtures.empty()) {
    return detections_;
  }
  contrast_.compute(reduced_, window_radius_, ignore_lines_);
  const CeilingFrame frame{.image = image,
                           .reduced = reduced_,
                           .dark = contrast_.dark(),
                           .factor = factor_,
                           .pixel_noise = std::clamp(contrast_.noise() * factor_, 1.0, 14.0),
                           .brightest = max_cell(reduced_),
                           .saturated = histogram.share_from(kLitLevels.front())};
  fits_left_ = kMaxFits;
  look_for(true, kLitLevels, frame, trace);
  look_for(false, kDepths, frame, trace);
  return detections_;
}

/// A fixture is brighter, or darker, than all around it, however the light is distributed: at some level it stands
/// alone.
void ModernDetector::look_for(bool bright, std::span<const int> levels, const CeilingFrame& frame,
                              DetectorTrace* trace) {
  tried_.clear();
  accepted_.clear();
  const double contrast = bright ? params_.lit_contrast : params_.unlit_contrast;
  const int least =
      (bright ? median_ : 0) + static_cast<int>(std::max(contrast, params_.noise_factor * contrast_.noise()) + 0.5);
  const Raster& cells = bright ? reduced_ : contrast_.dark();
  const int brightest = max_cell(cells);
  for (const int level : levels) {
    if (level >= brightest || level < least) {
      continue;
    }
    for (const Region& region : finder_.find(cells, min_cells_, {.level = level, .is_eroded = !bright && is_eroded_})) {
      if (may_be_a_kind(region) && !is_explained(region)) {
        look_at_region(region, {level, bright}, frame, trace);
      }
    }
  }
  take_best_first(frame);
}

void ModernDetector::look_at_region(const Region& region, const Layer& layer, const CeilingFrame& frame,
                                    DetectorTrace* trace) {
  if (!shape_.take(region, !layer.bright && is_eroded_ ? 1 : 0, plane_)) {
    return;
  }
  add_contour(shape_, factor_, trace);
  const SizeTolerance tolerance{.share = params_.size_tolerance,
                                .ragged = kRagged,
                                .bloom = layer.bright ? params_.max_bloom : 0.0,
                                .min_visible = 0.7 * params_.min_visible,
                                .min_width = layer.bright ? 0.0 : kMinAcross * shape_.cell_size() / factor_,
                                .may_be_broken = !layer.bright,
                                .is_white = layer.bright && layer.level == kLitLevels.front()};
  const std::vector<OutlineHypothesis>& hypotheses = proposer_.propose(shape_, layer.bright, tolerance);
  if (hypotheses.empty()) {
    return;
  }
  OutlineFitParams params = fit_params(region, layer);
  for (const OutlineHypothesis& hypothesis : hypotheses) {
    if (was_tried(hypothesis) || fits_left_ <= 0) {
      continue;
    }
    tried_.push_back(hypothesis);
    --fits_left_;
    params.unseen = hypothesis.drowned;
    Candidate candidate{.hypothesis = hypothesis, .fit = {}, .level = layer.level, .bright = layer.bright};
    const Verdict verdict = judge(frame, params, candidate);
    if (trace != nullptr) {
      trace->rectangles.push_back(corners_of(hypothesis.outline, candidate.fit.placement, camera_));
      trace->verdicts.emplace_back(to_string(verdict));
    }
    if (verdict == Verdict::kAccepted) {
      accepted_.push_back(candidate);
      if (is_certain(candidate)) {
        break;  // the others are of worse size
      }
    } else if (hypothesis.is_whole && layer.bright) {
      tried_.pop_back();  // at a lower level it may be
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
  candidate.score = fit->quality() + 0.1 * fit->ends_visible() - candidate.hypothesis.size_error;
  if (!candidate.bright) {
    candidate.score -= kOutset * (std::abs(fit->placement.side_outset) + std::abs(fit->placement.end_outset));
  }
  return checks_.by_edges(frame, candidate);
}

Verdict ModernDetector::judge_region(const CeilingFrame& frame, Candidate& candidate) {
  candidate.by_edges = false;
  candidate.fit = fit_of_region(candidate.hypothesis, shape_.cell_size());
  candidate.fit.metres_per_px = shape_.cell_size() / factor_;
  candidate.score = kOfRegion * candidate.hypothesis.fill - candidate.hypothesis.size_error;
  return checks_.by_region(frame, candidate);
}

void ModernDetector::take_best_first(const CeilingFrame& frame) {
  std::sort(accepted_.begin(), accepted_.end(),
            [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  for (const Candidate& candidate : accepted_) {
    const std::optional<Detection> detection = builder_.build(frame, candidate);
    const bool wanted = params_.report_elements || !candidate.hypothesis.is_element;
    if (detection && wanted && !overlaps(*detection)) {
      detections_.push_back(*detection);
    }
  }
}

OutlineFitParams ModernDetector::fit_params(const Region& region, const Layer& layer) const {
  const Raster& cells = layer.bright ? reduced_ : contrast_.dark();
  int sum = 0;
  for (const Run& run : region.runs) {
    const std::uint8_t* row = cells.row(run.row);
    sum = std::accumulate(row + run.first, row + run.last + 1, sum);
  }
  const double mean = static_cast<double>(sum) / std::max(region.cells, 1);
  return {.inside_brighter = layer.bright,
          .min_edge = layer.bright ? params_.lit_edge : params_.unlit_edge,
          .expected_step = mean - (layer.bright ? median_ : 0),
          .pixel_noise = std::clamp(contrast_.noise() * factor_, 1.0, 14.0),
          .side_sigma = layer.bright ? 0.4 * params_.max_bloom : 0.008,
          .edge_sigma_px = params_.edge_sigma_px,
          .outline_sigma_px = params_.outline_sigma_px};
}

/// The fit takes both to the same place.
bool ModernDetector::was_tried(const OutlineHypothesis& hypothesis) const {
  return std::any_of(tried_.begin(), tried_.end(), [&](const OutlineHypothesis& other) {
    const Pose2& a = hypothesis.start.pose;
    const Pose2& b = other.start.pose;
    return hypothesis.kind == other.kind && hypothesis.is_element == other.is_element &&
           hypothesis.burning == other.burning && (a.position() - b.position()).squaredNorm() < 0.03 * 0.03 &&
           std::abs(wrap_axis(a.theta - b.theta)) < radians(3.0);
  });
}

/// False when it is larger than everything that hangs here.
bool ModernDetector::may_be_a_kind(const Region& region) const {
  const int column = (region.left + region.right) / 2;
  const int row = (region.top + region.bottom) / 2;
  const double area = plane_.cell_area(column, row);
  const double shorter = area / plane_.cell_size(column, row);  // side of a cell, which tilt and lens stretch
  return !(shorter * std::hypot(region.right - region.left, region.bottom - region.top) > max_extent_) &&
         !(area * region.cells > max_area_);  // no number says nothing
}

/// True when it is part of something that nothing can be said better of.
bool ModernDetector::is_explained(const Region& region) const {
  const Run& middle = region.runs[region.runs.size() / 2];
  const Vector2d place = plane_.at((middle.first + middle.last) / 2, middle.row);
  const auto covers = [&](const Pose2& pose, double length, double width) {
    const Vector2d inside = PointTransform::inverse_of(pose) * place;
    return std::abs(inside.x()) < 0.5 * length + 0.02 && std::abs(inside.y()) < 0.5 * width + 0.02;
  };
  return std::any_of(accepted_.begin(), accepted_.end(),
                     [&](const Candidate& candidate) {
                       const Outline& outline = candidate.hypothesis.outline;
                       return is_certain(candidate) &&
                              covers(candidate.fit.placement.pose, outline.length, outline.width);
                     }) ||
         std::any_of(detections_.begin(), detections_.end(), [&](const Detection& detection) {
           return covers(detection.robot_from_fixture, detection.length, detection.width);
         });
}

bool ModernDetector::overlaps(const Detection& detection) const {
  return std::any_of(detections_.begin(), detections_.end(), [&](const Detection& other) {
    const Vector2d offset = other.robot_from_fixture.inverse() * detection.robot_from_fixture.position();
    return std::abs(offset.x()) < 0.5 * std::max(other.length, 0.1) + 0.05 &&
           std::abs(offset.y()) < 0.5 * (other.width + detection.width) + 0.03;
  });
}

}  // namespace luminav
