#include "services/detector/modern_detector.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "services/common/geometry/vector_clones.hpp"
#include "services/detector/bloom_edges.hpp"
#include "services/detector/bloom_symmetry.hpp"
#include "services/detector/coarse_glance.hpp"
#include "services/detector/grey_counts.hpp"
#include "services/detector/unlit_joints.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr double kRaggedEdges = 0.04;   // [m] by which noise and joints may widen an unlit region, in total
constexpr double kWideBloom = 0.03;     // [m]
constexpr double kWidestBloom = 0.065;  // [m]
constexpr double kSlowFall = 0.5;       // of the least step otherwise
constexpr double kDeeperShare = 0.75;   // of the local depth, where an unlit region is cut out a second time
constexpr double kVignetting = 0.30;    // share of the light lost in the image's corners; webcams lose 0.2 to 0.4

double narrowest_side(const CeilingCatalogue& catalogue) {
  double side = 0.3;
  for (const CeilingKind& kind : catalogue.fixtures) {
    side = std::min(side, kind.width);
  }
  return side;
}

double widest_width(const CeilingCatalogue& catalogue) {
  double side = 0.1;
  for (const CeilingKind& kind : catalogue.fixtures) {
    side = std::max(side, kind.width);
  }
  return side;
}

double least_area(const CeilingCatalogue& catalogue, double least_visible) {
  double area = 1e9;
  for (const CeilingKind& kind : catalogue.fixtures) {
    const bool strips = kind.lamps >= 2;  // half of it may burn alone
    area = std::min(area, kind.length * kind.width * (strips ? 0.5 : 1.0));
  }
  return least_visible * area;
}

double metres_per_pixel(const CeilingCamera& camera, const CeilingCatalogue& catalogue) {
  return (catalogue.ceiling_height - camera.mounting().z) / camera.intrinsics().fx;
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
  const double narrowest_px = narrowest_side(catalogue) / coarsest_pixel(camera, catalogue.ceiling_height);
  return narrowest_px >= 20.0 ? 4 : narrowest_px >= 10.0 ? 2 : 1;
}

/// Deeper than `least` and than a share [1/256] of the depth nearby.
LUMINAV_VECTOR_CLONES
void cut_deep(const std::uint8_t* depth, const std::uint8_t* peak, std::size_t count, int least, int share,
              std::uint8_t* mask) {
  // from 255 on nothing is deep enough
  const auto floor = static_cast<std::uint8_t>(std::clamp(least, 0, 255));
  const auto factor = static_cast<std::uint16_t>(std::clamp(share, 0, 257));
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    const auto product = static_cast<std::uint16_t>(factor * peak[i]);
    const auto part = static_cast<std::uint8_t>(product >> 8);
    mask[i] = depth[i] > std::max(floor, part) ? 1 : 0;
  }
}

int median_of(const Raster& image, int guess) {
  const auto size = static_cast<int>(image.cells.size());
  return median_level(guess, [&](int level) {
    return 2 * count_up_to(image.cells.data(), image.cells.size(), static_cast<std::uint8_t>(level)) >= size;
  });
}

bool touches_border(const Region& region, const Raster& mask) {
  return region.left <= 0 || region.top <= 0 || region.right >= mask.width - 1 || region.bottom >= mask.height - 1;
}

/// The fit takes both to the same place.
bool is_nearly_same(const OutlineHypothesis& a, const OutlineHypothesis& b) {
  return std::abs(a.outline.length - b.outline.length) < 1e-3 && std::abs(a.outline.width - b.outline.width) < 1e-3 &&
         std::abs(a.outline.height - b.outline.height) < 1e-3 && a.is_element == b.is_element &&
         (a.start.position() - b.start.position()).squaredNorm() < 0.03 * 0.03 &&
         std::abs(wrap_axis(a.start.theta - b.start.theta)) < radians(3.0);
}

std::array<Vector2d, 4> corners_of(const OutlineHypothesis& hypothesis, const CeilingCamera& camera) {
  const double x = 0.5 * hypothesis.outline.length;
  const double y = 0.5 * hypothesis.outline.width;
  std::array<Vector2d, 4> corners{Vector2d(x, y), Vector2d(-x, y), Vector2d(-x, -y), Vector2d(x, -y)};
  for (Vector2d& corner : corners) {
    corner = camera.pixel_of_ceiling_point(hypothesis.start * corner, hypothesis.outline.height)
                 .value_or(Vector2d(-1.0, -1.0));
  }
  return corners;
}

}  // namespace

ModernDetector::ModernDetector(const ModernDetectorParams& params, const CeilingCamera& camera,
                               const CeilingCatalogue& catalogue)
    : params_(params),
      camera_(camera),
      catalogue_(catalogue),
      factor_(reduction_factor(camera, catalogue)),
      plane_(camera_, factor_, catalogue.ceiling_height),
      metres_per_px_(metres_per_pixel(camera, catalogue)),
      proposer_(plane_, catalogue_),
      fitter_(camera_),
      checks_(params_, camera_, catalogue_),
      writer_(camera_, catalogue_) {
  const double cell = factor_ * metres_per_px_;
  // wider than the widest fixture and its bloom, or its middle would count as surroundings
  window_radius_ = static_cast<int>(std::ceil(0.5 * (1.25 * widest_width(catalogue_) + 0.08) / cell));
  least_cells_ = std::max(6, static_cast<int>(0.5 * least_area(catalogue_, params_.minimum_visible) / (cell * cell)));
  // joints between tiles are thinner than two cells; the narrowest fixture must survive
  is_eroded_ = narrowest_side(catalogue_) / cell >= 5.0;
  ignore_lines_ = narrowest_side(catalogue_) / cell >= 7.5;
}

OutlineFitParams ModernDetector::fit_params(const Region& region, int level) const {
  const bool bright = level > 0;
  const Raster& contrast = bright ? reduced_ : contrast_.dark();
  int sum = 0;
  for (const Run& run : region.runs) {
    const std::uint8_t* row = contrast.row(run.row);
    sum = std::accumulate(row + run.first, row + run.last + 1, sum);
  }
  return {.inside_brighter = bright,
          .least_edge = bright ? params_.lit_edge : params_.unlit_edge,
          .expected_step = static_cast<double>(sum) / std::max(region.cells, 1) - (bright ? median_ : 0),
          .pixel_noise = std::clamp(contrast_.noise() * factor_, 1.0, 14.0),
          .swelling_sigma = bright ? 0.4 * params_.largest_bloom : 0.4 * params_.largest_misfit,
          .taper_sigma = bright ? 0.5 * params_.largest_bloom : 1e-4,
          .edge_sigma_px = params_.edge_sigma_px,
          .outline_sigma_px = params_.outline_sigma_px,
          .vignetting = kVignetting,
          .first_search_px = 11};
}

bool ModernDetector::is_deep_anywhere(double level_share) const {
  return static_cast<int>(level_share * 256.0) * contrast_.deepest() / 256 > least_depth();
}

int ModernDetector::least_depth() const {
  return static_cast<int>(std::max(params_.unlit_contrast, params_.noise_factor * contrast_.noise()) + 0.5);
}

int ModernDetector::cut_out_dark(double level_share) {
  const Raster& dark = contrast_.dark();
  mask_.resize(dark.width, dark.height);
  // Mostly nothing is so deep that a share of it would be more than the least depth.
  const bool is_deep = is_deep_anywhere(level_share);
  const Raster& peak = is_deep ? contrast_.dark_peak() : dark;
  const int share = is_deep ? static_cast<int>(level_share * 256.0) : 0;
  cut_deep(dark.cells.data(), peak.cells.data(), dark.cells.size(), least_depth(), share, mask_.cells.data());
  return static_cast<int>(mask_.cells.size()) - count_up_to(mask_.cells.data(), mask_.cells.size(), 0);
}

void ModernDetector::detect(const GreyView& image, std::vector<Detection>& detections, DetectorTrace* trace) {
  detections.clear();
  reduce(image, factor_, reduced_);
  median_ = median_of(reduced_, median_);
  if (catalogue_.fixtures.empty()) {
    return;
  }
  contrast_.compute(reduced_, window_radius_, ignore_lines_);
  const CeilingFrame frame{image, reduced_, contrast_.dark(), factor_, contrast_.noise() * factor_};
  look_for_lit(frame, detections, trace);
  look_for_unlit(frame, detections, trace);
}

void ModernDetector::look_for_lit(const CeilingFrame& frame, std::vector<Detection>& detections, DetectorTrace* trace) {
  tried_.clear();
  open_.clear();
  row_peaks_.resize(static_cast<std::size_t>(reduced_.height));
  for (int y = 0; y < reduced_.height; ++y) {
    row_peaks_[static_cast<std::size_t>(y)] = largest_of(reduced_.row(y), static_cast<std::size_t>(reduced_.width));
  }
  // A lit fixture is brighter than all around it, however the light is distributed: at some level it stands alone. The
  // highest comes first, because there bloom adds least.
  const auto contrast = static_cast<int>(std::max(params_.lit_contrast, params_.noise_factor * contrast_.noise()));
  for (const int level : {248, 225, 200, 175, 150, 125, 100, 80, 60, 45, 35}) {
    if (level < median_ + contrast) {
      break;
    }
    for (const Region& region : finder_.find(reduced_, least_cells_, {.level = level, .row_peaks = row_peaks_})) {
      if (is_explained(region, detections)) {
        continue;
      }
      std::optional<Candidate> candidate = best_candidate(frame, region, 0, level, trace);
      if (!candidate) {
        continue;
      }
      const OutlineFitParams params = fit_params(region, level);
      const OutlineFit seen = candidate->fit;
      level_bloom(frame.image, camera_, candidate->hypothesis.outline, params, candidate->fit);
      balance_bloom(frame.image, camera_, candidate->hypothesis.outline, params, candidate->fit);
      if (const auto dark_side = writer_.dark_half(frame, *candidate)) {
        place_by_dark_half(frame.image, camera_, candidate->hypothesis.outline, params, seen, *dark_side,
                           candidate->fit);
      }
      const bool bar = candidate->hypothesis.outline.shape == FixtureShape::kRectangle;
      const std::optional<Detection> detection = candidate->hypothesis.is_element
                                                     ? writer_.detection_of(*candidate, DetectionState::kUnknown)
                                                 : bar ? writer_.resolve_strip(frame, *candidate)
                                                       : writer_.detection_of(*candidate, DetectionState::kLit);
      if (detection && !overlaps(*detection, detections)) {
        (candidate->narrower ? open_ : detections).push_back(*detection);
      }
    }
  }
  // At a lower level it may have been told after all which kind it is.
  for (const Detection& detection : open_) {
    if (!overlaps(detection, detections)) {
      detections.push_back(detection);
    }
  }
}

void ModernDetector::look_for_unlit(const CeilingFrame& frame, std::vector<Detection>& detections,
                                    DetectorTrace* trace) {
  tried_.clear();
  // What shading or a neighbour joins to a fixture falls away deeper down; so do parts of it, and only whole ones
  // count.
  int before = 0;  // [cells]
  for (const double level_share : {params_.unlit_level_share, kDeeperShare}) {
    const int cells = cut_out_dark(level_share);
    if (cells != before) {  // or the same regions are cut out again
      look_for_unlit_at(level_share, frame, detections, trace);
    }
    before = cells;
    if (!is_deep_anywhere(std::max(kDeeperShare, params_.unlit_level_share))) {
      break;  // the least depth cuts out the same again
    }
  }
}

void ModernDetector::look_for_unlit_at(double level_share, const CeilingFrame& frame,
                                       std::vector<Detection>& detections, DetectorTrace* trace) {
  const bool deeper = level_share > params_.unlit_level_share;
  for (const Region& region : finder_.find(mask_, least_cells_, {.is_eroded = is_eroded_})) {
    if ((deeper && touches_border(region, mask_)) || is_explained(region, detections)) {
      continue;
    }
    std::optional<Candidate> candidate = best_candidate(frame, region, is_eroded_ ? 1 : 0, 0, trace);
    if (!candidate) {
      continue;
    }
    const bool whole = candidate->fit.end_visible(kFarEnd) && candidate->fit.end_visible(kNearEnd);
    if (deeper && !whole) {
      continue;  // a part of something darker
    }
    if (!candidate->hypothesis.is_element) {
      take_off_joints(frame.image, camera_, candidate->hypothesis.outline, fit_params(region, 0), candidate->fit);
    }
    const Detection detection = writer_.detection_of(
        *candidate, candidate->hypothesis.is_element ? DetectionState::kUnknown : DetectionState::kUnlit);
    if (!overlaps(detection, detections)) {
      detections.push_back(detection);
    }
  }
}

bool ModernDetector::is_explained(const Region& region, const std::vector<Detection>& detections) const {
  const Run& middle = region.runs[region.runs.size() / 2];
  const Vector2d place = plane_.at((middle.first + middle.last) / 2, middle.row);
  for (const Detection& detection : detections) {
    const Vector2d inside = PointTransform::inverse_of(detection.robot_from_fixture) * place;
    if (std::abs(inside.x()) < 0.5 * detection.length + 0.02 && std::abs(inside.y()) < 0.5 * detection.width + 0.02) {
      return true;
    }
  }
  return false;
}

std::optional<Candidate> ModernDetector::best_candidate(const CeilingFrame& frame, const Region& region, int shrunk,
                                                        int level, DetectorTrace* trace) {
  const bool bright = level > 0;
  const SizeTolerance tolerance{.absolute = params_.size_tolerance,
                                .share = params_.size_tolerance_share,
                                .bloom = bright ? 2.0 * params_.largest_bloom : kRaggedEdges,
                                .least_visible = 0.7 * params_.minimum_visible};
  const std::vector<OutlineHypothesis>& hypotheses = proposer_.propose(region, shrunk, bright, tolerance);
  if (trace != nullptr) {
    std::vector<Vector2d> contour;
    for (const Eigen::Vector2i& cell : proposer_.hull_cells()) {
      contour.emplace_back(factor_ * (cell.x() + 0.5) - 0.5, factor_ * (cell.y() + 0.5) - 0.5);
    }
    trace->contours.push_back(std::move(contour));
  }
  OutlineFitParams of_fixture = fit_params(region, level);
  const double expected_step = of_fixture.expected_step;
  OutlineFitParams of_element = of_fixture;
  of_element.swelling_sigma = 0.5 * kElementFrame;
  std::optional<Candidate> best;
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    const OutlineHypothesis& hypothesis = hypotheses[i];
    if (hypothesis.from_edge && best && !best->narrower) {
      break;  // these come last
    }
    if (std::any_of(tried_.begin(), tried_.end(),
                    [&](const OutlineHypothesis& other) { return is_nearly_same(hypothesis, other); })) {
      continue;
    }
    tried_.push_back(hypothesis);
    // A lamp in its bloom may look twice as wide as it is, and its light then falls off slowly.
    const bool wide_bloom = bright && hypothesis.swelling > kWideBloom;
    of_fixture.first_swelling = wide_bloom ? std::min(hypothesis.swelling, kWidestBloom) : 0.0;
    of_fixture.least_edge = bright ? params_.lit_edge * (wide_bloom ? kSlowFall : 1.0) : params_.unlit_edge;
    of_fixture.expected_step = wide_bloom ? 0.7 * params_.lit_edge : expected_step;
    const OutlineFitParams& params = hypothesis.is_element ? of_element : of_fixture;
    const std::optional<OutlineFit> fit = may_be_there(frame, hypothesis, of_fixture)
                                              ? fitter_.fit(frame.image, hypothesis.outline, params, hypothesis.start)
                                              : std::nullopt;
    if (!fit) {
      if (trace != nullptr) {
        trace->rectangles.push_back(corners_of(hypothesis, camera_));
        trace->verdicts.emplace_back("no edges");
      }
      continue;
    }
    Candidate candidate{.hypothesis = hypothesis, .fit = *fit};
    const char* verdict = checks_.objection(frame, candidate, level);
    if (bright && verdict != nullptr && verdict == kMayBeAnother) {
      candidate.narrower = checks_.rare_narrower(frame, candidate);
      verdict = candidate.narrower ? nullptr : verdict;
    }
    if (trace != nullptr) {
      trace->rectangles.push_back(writer_.detection_of(candidate, DetectionState::kUnknown).corners_px);
      trace->verdicts.emplace_back(verdict == nullptr ? "accepted" : verdict);
    }
    if (verdict != nullptr) {
      if (verdict == kNotFilled) {
        tried_.pop_back();
      }
      continue;
    }
    // An end that is seen says more than one that is not; among equals the outline that needs the least swelling.
    const double ends = (fit->end_visible(kFarEnd) ? 0.1 : 0.0) + (fit->end_visible(kNearEnd) ? 0.1 : 0.0);
    candidate.score = fit->quality() + ends - 2.0 * std::abs(fit->swelling);
    const auto rank = [](const Candidate& one) { return std::pair(!one.narrower, one.score); };
    if (!best || rank(candidate) > rank(*best)) {
      best = candidate;
    }
    const bool certain =
        !candidate.narrower && fit->end_visible(kFarEnd) && fit->end_visible(kNearEnd) && fit->quality() > 0.9;
    if (certain) {
      break;
    }
  }
  return best;
}

bool ModernDetector::may_be_there(const CeilingFrame& frame, const OutlineHypothesis& hypothesis,
                                  const OutlineFitParams& params) const {
  Outline outline = hypothesis.outline;
  outline.width += 2.0 * params.first_swelling;
  return may_have_long_sides(frame, camera_, outline, hypothesis.start,
                             params.inside_brighter ? params.least_edge : -params.least_edge);
}

bool ModernDetector::overlaps(const Detection& detection, const std::vector<Detection>& others) const {
  for (const Detection& other : others) {
    const Vector2d offset = other.robot_from_fixture.inverse() * detection.robot_from_fixture.position();
    const double reach_along = 0.5 * std::max(other.length, 0.1) + 0.05;
    // Half of the narrower width apart would be the neighbour half of the same fixture.
    const double reach_across = 0.5 * (other.width + detection.width) + 0.03;
    if (std::abs(offset.x()) < reach_along && std::abs(offset.y()) < reach_across) {
      return true;
    }
  }
  return false;
}

}  // namespace luminav
