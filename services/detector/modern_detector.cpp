#include "services/detector/modern_detector.hpp"

#include <algorithm>
#include <cmath>

#include "services/detector/bloom_edges.hpp"
#include "services/detector/strip_surroundings.hpp"
#include "services/detector/surface_texture.hpp"

namespace luminav {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;

constexpr double kBlurredEdge = 2.5;  // [px] by which an outline may always miss, however coarse the pixels
constexpr double kLeastDisc = 16.0;   // [px] across: smaller ones must be lit, with an edge nearly all round
constexpr double kSpeckFit = 0.92;
constexpr double kElementFrame = 0.045;  // [m] a vent's frame is as bright as the ceiling: its slats end inside of it
constexpr double kVignetting = 0.30;     // share of the light lost in the image's corners; webcams lose 0.2 to 0.4

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

Matrix3d turned(const Matrix3d& covariance, double theta) {
  Matrix3d rotation = Matrix3d::Identity();
  rotation.topLeftCorner<2, 2>() << std::cos(theta), -std::sin(theta), std::sin(theta), std::cos(theta);
  return rotation * covariance * rotation.transpose();
}

int median_grey(const Raster& image) {
  std::array<int, 256> histogram{};
  for (const std::uint8_t grey : image.cells) {
    ++histogram[grey];
  }
  int level = 0;
  for (int below = histogram[0]; 2 * below < static_cast<int>(image.cells.size()) && level < 255;) {
    below += histogram[static_cast<std::size_t>(++level)];
  }
  return level;
}

/// The fit takes both to the same place.
bool is_nearly_same(const OutlineHypothesis& a, const OutlineHypothesis& b) {
  return std::abs(a.outline.length - b.outline.length) < 1e-3 && std::abs(a.outline.width - b.outline.width) < 1e-3 &&
         std::abs(a.outline.height - b.outline.height) < 1e-3 && a.is_element == b.is_element &&
         distance(a.start, b.start) < 0.03 && std::abs(wrap_axis(a.start.theta - b.start.theta)) < radians(3.0);
}

DetectionShape shape_of(const OutlineHypothesis& hypothesis) {
  if (hypothesis.is_element) {
    return DetectionShape::kElement;
  }
  switch (hypothesis.outline.shape) {
    case FixtureShape::kSquare:
      return DetectionShape::kSquare;
    case FixtureShape::kRound:
      return DetectionShape::kRound;
    case FixtureShape::kRectangle:
      break;
  }
  return DetectionShape::kRectangle;
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
      fitter_(camera_) {
  const double cell = factor_ * metres_per_px_;
  // wider than the widest fixture and its bloom, or its middle would count as surroundings
  window_radius_ = static_cast<int>(std::ceil(0.5 * (1.25 * widest_width(catalogue_) + 0.08) / cell));
  least_cells_ = std::max(6, static_cast<int>(0.5 * least_area(catalogue_, params_.minimum_visible) / (cell * cell)));
  // joints between tiles are thinner than two cells; the narrowest fixture must survive
  erosion_ = narrowest_side(catalogue_) / cell >= 5.0 ? 1 : 0;
  ignore_lines_ = narrowest_side(catalogue_) / cell >= 7.5;
}

OutlineFitParams ModernDetector::fit_params(const Region& region, int level) const {
  const bool bright = level > 0;
  const Raster& contrast = bright ? reduced_ : contrast_.dark();
  double sum = 0.0;
  for (const Run& run : region.runs) {
    for (int x = run.first; x <= run.last; ++x) {
      sum += contrast.row(run.row)[x];
    }
  }
  return {.inside_brighter = bright,
          .least_edge = bright ? params_.lit_edge : params_.unlit_edge,
          .expected_step = sum / std::max(region.cells, 1) - (bright ? median_grey(reduced_) : 0),
          .pixel_noise = std::clamp(contrast_.noise() * factor_, 1.0, 14.0),
          .swelling_sigma = bright ? 0.4 * params_.largest_bloom : 0.4 * params_.largest_misfit,
          .taper_sigma = bright ? 0.5 * params_.largest_bloom : 1e-4,
          .edge_sigma_px = params_.edge_sigma_px,
          .outline_sigma_px = params_.outline_sigma_px,
          .vignetting = kVignetting,
          .first_search_px = 11};
}

void ModernDetector::cut_out_bright(int level) {
  mask_.resize(reduced_.width, reduced_.height);
  const std::size_t count = mask_.cells.size();
  const std::uint8_t* grey = reduced_.cells.data();
  std::uint8_t* out = mask_.cells.data();
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = grey[i] > level ? 1 : 0;
  }
}

void ModernDetector::cut_out_dark() {
  const Raster& dark = contrast_.dark();
  const auto least = static_cast<int>(std::max(params_.unlit_contrast, params_.noise_factor * contrast_.noise()) + 0.5);
  const Raster& peak = contrast_.dark_peak();
  const auto share = static_cast<int>(params_.unlit_level_share * 256.0);
  mask_.resize(dark.width, dark.height);
  const std::size_t count = mask_.cells.size();
  for (std::size_t i = 0; i < count; ++i) {
    mask_.cells[i] = dark.cells[i] > std::max(least, (share * peak.cells[i]) >> 8) ? 1 : 0;
  }
}

void ModernDetector::detect(const GreyView& image, std::vector<Detection>& detections, DetectorTrace* trace) {
  detections.clear();
  if (catalogue_.fixtures.empty()) {
    return;
  }
  reduce(image, factor_, reduced_);
  contrast_.compute(reduced_, window_radius_, ignore_lines_);
  look_for_lit(image, detections, trace);
  look_for_unlit(image, detections, trace);
}

void ModernDetector::look_for_lit(const GreyView& image, std::vector<Detection>& detections, DetectorTrace* trace) {
  tried_.clear();
  // A lit fixture is brighter than all around it, however the light is distributed: at some level it stands alone. The
  // highest comes first, because there bloom adds least.
  const int median = median_grey(reduced_);
  const auto contrast = static_cast<int>(std::max(params_.lit_contrast, params_.noise_factor * contrast_.noise()));
  for (const int level : {248, 225, 200, 175, 150, 125, 100, 80, 60, 45, 35}) {
    if (level < median + contrast) {
      break;
    }
    cut_out_bright(level);
    for (const Region& region : finder_.find(mask_, least_cells_)) {
      if (is_explained(region, detections)) {
        continue;
      }
      std::optional<Candidate> candidate = best_candidate(image, region, 0, level, trace);
      if (!candidate) {
        continue;
      }
      level_bloom(image, camera_, candidate->hypothesis.outline, fit_params(region, level), candidate->fit);
      const bool bar = candidate->hypothesis.outline.shape == FixtureShape::kRectangle;
      const std::optional<Detection> detection = candidate->hypothesis.is_element
                                                     ? detection_of(*candidate, DetectionState::kUnknown)
                                                 : bar ? resolve_strip(image, *candidate)
                                                       : detection_of(*candidate, DetectionState::kLit);
      if (detection && !overlaps(*detection, detections)) {
        detections.push_back(*detection);
      }
    }
  }
}

void ModernDetector::look_for_unlit(const GreyView& image, std::vector<Detection>& detections, DetectorTrace* trace) {
  tried_.clear();
  cut_out_dark();
  if (erosion_ > 0) {
    erode(mask_, erosion_, eroded_, scratch_);
  }
  for (const Region& region : finder_.find(erosion_ > 0 ? eroded_ : mask_, least_cells_)) {
    if (is_explained(region, detections)) {
      continue;
    }
    const std::optional<Candidate> candidate = best_candidate(image, region, erosion_, 0, trace);
    if (!candidate) {
      continue;
    }
    const Detection detection =
        detection_of(*candidate, candidate->hypothesis.is_element ? DetectionState::kUnknown : DetectionState::kUnlit);
    if (!overlaps(detection, detections)) {
      detections.push_back(detection);
    }
  }
}

bool ModernDetector::is_explained(const Region& region, const std::vector<Detection>& detections) const {
  const Run& middle = region.runs[region.runs.size() / 2];
  const Vector2d place = plane_.at((middle.first + middle.last) / 2, middle.row);
  for (const Detection& detection : detections) {
    const Vector2d inside = detection.robot_from_fixture.inverse() * place;
    if (std::abs(inside.x()) < 0.5 * detection.length + 0.02 && std::abs(inside.y()) < 0.5 * detection.width + 0.02) {
      return true;
    }
  }
  return false;
}

std::optional<ModernDetector::Candidate> ModernDetector::best_candidate(const GreyView& image, const Region& region,
                                                                        int shrunk, int level, DetectorTrace* trace) {
  const bool bright = level > 0;
  const SizeTolerance tolerance{.absolute = params_.size_tolerance,
                                .share = params_.size_tolerance_share,
                                .bloom = bright ? 2.0 * params_.largest_bloom : 0.0,
                                .least_visible = 0.7 * params_.minimum_visible};
  const std::vector<OutlineHypothesis>& hypotheses = proposer_.propose(region, shrunk, bright, tolerance);
  if (trace != nullptr) {
    std::vector<Vector2d> contour;
    for (const Eigen::Vector2i& cell : proposer_.hull_cells()) {
      contour.emplace_back(factor_ * (cell.x() + 0.5) - 0.5, factor_ * (cell.y() + 0.5) - 0.5);
    }
    trace->contours.push_back(std::move(contour));
  }
  const OutlineFitParams of_fixture = fit_params(region, level);
  OutlineFitParams of_element = of_fixture;
  of_element.swelling_sigma = 0.5 * kElementFrame;
  std::optional<Candidate> best;
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    const OutlineHypothesis& hypothesis = hypotheses[i];
    if (std::any_of(tried_.begin(), tried_.end(),
                    [&](const OutlineHypothesis& other) { return is_nearly_same(hypothesis, other); })) {
      continue;
    }
    tried_.push_back(hypothesis);
    const std::optional<OutlineFit> fit =
        fitter_.fit(image, hypothesis.outline, hypothesis.is_element ? of_element : of_fixture, hypothesis.start);
    if (!fit) {
      if (trace != nullptr) {
        trace->rectangles.push_back(corners_of(hypothesis));
        trace->verdicts.emplace_back("no edges");
      }
      continue;
    }
    Candidate candidate{hypothesis, *fit, 0.0};
    const char* verdict = objection(image, candidate, level);
    if (trace != nullptr) {
      trace->rectangles.push_back(detection_of(candidate, DetectionState::kUnknown).corners_px);
      trace->verdicts.emplace_back(verdict == nullptr ? "accepted" : verdict);
    }
    if (verdict != nullptr) {
      continue;
    }
    // An end that is seen says more than one that is not; among equals the outline that needs the least swelling.
    const double ends = (fit->end_visible(kFarEnd) ? 0.1 : 0.0) + (fit->end_visible(kNearEnd) ? 0.1 : 0.0);
    candidate.score = fit->quality() + ends - 2.0 * std::abs(fit->swelling);
    if (!best || candidate.score > best->score) {
      best = candidate;
    }
    const bool certain = fit->end_visible(kFarEnd) && fit->end_visible(kNearEnd) && fit->quality() > 0.9;
    if (certain) {
      break;
    }
  }
  return best;
}

const char* ModernDetector::objection(const GreyView& image, const Candidate& candidate, int level) const {
  const bool bright = level > 0;
  const OutlineFit& fit = candidate.fit;
  const Outline& outline = candidate.hypothesis.outline;
  const double of_pixels = kBlurredEdge * fit.metres_per_px;
  const double most = std::max(bright ? params_.largest_bloom : params_.largest_misfit, of_pixels);
  const double least = candidate.hypothesis.is_element ? -kElementFrame
                       : bright                        ? -std::max(0.010, of_pixels)
                                                       : -std::max(params_.largest_misfit, of_pixels);
  if (fit.swelling > most || fit.swelling < least) {
    return "too wide or too narrow";
  }
  if (outline.shape == FixtureShape::kRound) {
    // A disc of a few pixels: any dark speck or bright crumb looks like it.
    const bool speck = outline.length / fit.metres_per_px < kLeastDisc;
    if (speck && (!bright || fit.share(kLeftSide) < kSpeckFit)) {
      return "too small to tell";
    }
    const bool sound = fit.in_view[kLeftSide] >= 12 && 2 * fit.in_view[kLeftSide] >= fit.expected[kLeftSide] &&
                       fit.share(kLeftSide) >= params_.minimum_long_side_fit;
    return !sound ? "no edge all round" : !is_filled(candidate, level) ? "not filled" : nullptr;
  }
  const double seen = fit.visible_to - fit.visible_from;
  if (fit.in_view[kLeftSide] < 3 || fit.in_view[kRightSide] < 3 ||
      fit.in_view[kLeftSide] + fit.in_view[kRightSide] < 10 || seen < params_.minimum_visible * outline.length * 0.8) {
    return "too little in view";
  }
  if (fit.share(kLeftSide) < params_.minimum_long_side_fit || fit.share(kRightSide) < params_.minimum_long_side_fit) {
    return "no edge along a long side";
  }
  // The burning half of a fixture next to its dark half looks like a whole one with one faint side.
  if (bright && std::min(fit.side_step[kLeftSide], fit.side_step[kRightSide]) <
                    0.5 * std::max(fit.side_step[kLeftSide], fit.side_step[kRightSide])) {
    return "sides of different brightness";
  }
  for (const int end : {kFarEnd, kNearEnd}) {
    if (fit.in_view[static_cast<std::size_t>(end)] >= 3 && fit.share(end) < params_.minimum_end_fit) {
      return "no edge at an end";
    }
    // A joint between tiles may look like an end; then the long sides don't reach it.
    const std::size_t corner = end == kFarEnd ? 0 : 1;
    if (fit.end_visible(end) && fit.corner_on_edge[corner] < 0.6 * fit.corner_in_view[corner]) {
      return "long sides end early";
    }
  }
  if (!bright && !(ends_where_it_says(candidate, kFarEnd) && ends_where_it_says(candidate, kNearEnd))) {
    return "goes on beyond its end";
  }
  const int ends = (fit.end_visible(kFarEnd) ? 1 : 0) + (fit.end_visible(kNearEnd) ? 1 : 0);
  if (candidate.hypothesis.is_element && ends < 2) {
    return "an element that is cut";
  }
  if (outline.shape == FixtureShape::kSquare ? ends < 2 : ends < 1 && seen < 0.4 * outline.length) {
    return "too few ends";
  }
  if (!is_filled(candidate, level)) {
    return "not filled";
  }
  return may_be_something_else(image, candidate, bright) ? "may be another element" : nullptr;
}

bool ModernDetector::may_be_something_else(const GreyView& image, const Candidate& candidate, bool bright) const {
  const OutlineFit& fit = candidate.fit;
  if (candidate.hypothesis.is_element || (fit.end_visible(kFarEnd) && fit.end_visible(kNearEnd)) ||
      candidate.hypothesis.outline.shape == FixtureShape::kRound) {
    return false;
  }
  const double seen = fit.visible_to - fit.visible_from;
  const double width = candidate.hypothesis.outline.width;
  for (const CeilingKind& element : catalogue_.elements) {
    if (bright && !element.luminous) {
      continue;
    }
    const double slack = 0.03 + 0.1 * width;
    const bool lengthwise = std::abs(element.width - width) < slack && element.length > seen - 0.03;
    const bool crosswise = std::abs(element.length - width) < slack && element.width > seen - 0.03;
    if ((lengthwise || crosswise) && !(element.slatted && is_surely_smooth(image, camera_, candidate.hypothesis.outline,
                                                                           fit, contrast_.noise() * factor_))) {
      return true;
    }
  }
  return false;
}

bool ModernDetector::ends_where_it_says(const Candidate& candidate, int end) const {
  if (!candidate.fit.end_visible(end)) {
    return true;
  }
  // Between 30 and 75 mm from the end: beyond blur and joints, nearer than anything else.
  constexpr std::array<double, 3> kDistances{0.030, 0.050, 0.075};  // [m]
  const Raster& contrast = contrast_.dark();
  const Outline& outline = candidate.hypothesis.outline;
  const double direction = end == kFarEnd ? 1.0 : -1.0;
  std::array<double, 2> sum{};  // inside, outside
  std::array<int, 2> count{};
  for (const double distance : kDistances) {
    for (const double across : {-0.3, -0.1, 0.1, 0.3}) {
      for (const std::size_t outside : {std::size_t{0}, std::size_t{1}}) {
        const double along = direction * (0.5 * outline.length + (outside == 1 ? distance : -distance));
        const Vector2d place(along, across * outline.width);
        const auto pixel = camera_.pixel_of_ceiling_point(candidate.fit.robot_from_outline * place, outline.height);
        if (pixel && camera_.is_in_image(*pixel, factor_)) {
          const int column = std::clamp(static_cast<int>((pixel->x() + 0.5) / factor_), 0, contrast.width - 1);
          const int row = std::clamp(static_cast<int>((pixel->y() + 0.5) / factor_), 0, contrast.height - 1);
          sum[outside] += contrast.row(row)[column];
          ++count[outside];
        }
      }
    }
  }
  if (count[0] < 3 || count[1] < 3) {
    return true;  // out of view: nothing to say against it
  }
  const double inside = sum[0] / count[0];
  return inside - sum[1] / count[1] > 0.45 * std::max(inside, candidate.fit.step);
}

bool ModernDetector::is_filled(const Candidate& candidate, int region_level) const {
  const bool bright = region_level > 0;
  const Raster& contrast = bright ? reduced_ : contrast_.dark();
  const Outline& outline = candidate.hypothesis.outline;
  const Pose2& pose = candidate.fit.robot_from_outline;
  const double level = bright ? region_level : 0.5 * params_.unlit_contrast;
  int looked = 0;
  int filled = 0;
  for (int i = 0; i < 15; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Vector2d place(outline.length * ((i + 0.5) / 15.0 - 0.5) * 0.9, outline.width * (j - 1) * 0.3);
      const auto pixel = camera_.pixel_of_ceiling_point(pose * place, outline.height);
      if (!pixel || !camera_.is_in_image(*pixel, factor_)) {
        continue;
      }
      const int column = std::clamp(static_cast<int>((pixel->x() + 0.5) / factor_), 0, contrast.width - 1);
      const int row = std::clamp(static_cast<int>((pixel->y() + 0.5) / factor_), 0, contrast.height - 1);
      ++looked;
      filled += contrast.row(row)[column] > level ? 1 : 0;
    }
  }
  return looked >= 5 && filled * 100 >= looked * (bright ? 90 : 75);
}

bool ModernDetector::burns_on_one_side(const Candidate& candidate) const {
  constexpr double kDifference = 25.0;  // [grey] between the halves; two burning tubes both saturate
  const Outline& outline = candidate.hypothesis.outline;
  std::array<double, 2> sum{};
  std::array<int, 2> count{};
  for (int i = 0; i < 24; ++i) {
    for (const std::size_t half : {std::size_t{0}, std::size_t{1}}) {
      const Vector2d place(0.9 * outline.length * ((i + 0.5) / 24.0 - 0.5), outline.width * (half == 0 ? 0.28 : -0.28));
      const auto pixel = camera_.pixel_of_ceiling_point(candidate.fit.robot_from_outline * place, outline.height);
      if (pixel && camera_.is_in_image(*pixel, factor_)) {
        const int column = std::clamp(static_cast<int>((pixel->x() + 0.5) / factor_), 0, reduced_.width - 1);
        const int row = std::clamp(static_cast<int>((pixel->y() + 0.5) / factor_), 0, reduced_.height - 1);
        sum[half] += reduced_.row(row)[column];
        ++count[half];
      }
    }
  }
  return count[0] >= 3 && count[1] >= 3 && std::abs(sum[0] / count[0] - sum[1] / count[1]) > kDifference;
}

std::optional<Detection> ModernDetector::resolve_strip(const GreyView& image, const Candidate& strip) const {
  const double width = strip.hypothesis.outline.width;
  const CeilingKind* pair = nullptr;    // a fixture of two lamps of which this may be one
  const CeilingKind* single = nullptr;  // a fixture that looks like this when it is whole
  for (const CeilingKind& kind : catalogue_.fixtures) {
    if (kind.shape != FixtureShape::kRectangle || std::abs(kind.length - strip.hypothesis.outline.length) > 0.05) {
      continue;
    }
    if (std::abs(kind.width - width) < 0.03) {
      single = &kind;
    } else if (kind.lamps >= 2 && std::abs(0.5 * kind.width - width) < 0.03) {
      pair = &kind;
    }
  }
  if (single != nullptr && single->lamps >= 2 && burns_on_one_side(strip)) {
    Candidate fixture = strip;
    // one side shows bloom and the other none, so the outline is off by up to the swelling
    fixture.fit.covariance(1, 1) += std::pow(std::max(strip.fit.swelling, 0.005), 2);
    return detection_of(fixture, DetectionState::kHalf);
  }
  if (pair == nullptr) {
    return single == nullptr ? std::nullopt : std::optional(detection_of(strip, DetectionState::kLit));
  }
  const StripSurroundings around =
      compare_strip_sides(image, camera_, strip.hypothesis.outline, strip.fit, contrast_.noise() * factor_);
  // a dark half may be as bright as the ceiling over a short stretch
  const bool too_short = strip.fit.visible_to - strip.fit.visible_from < 0.45 * strip.hypothesis.outline.length;
  const bool one_sided = around.valid && around.asymmetry > 0.45;
  if (one_sided && around.side != 0) {
    Candidate fixture = strip;
    fixture.hypothesis.outline = {FixtureShape::kRectangle, pair->length, pair->width, pair->height};
    fixture.fit.robot_from_outline = strip.fit.robot_from_outline * Pose2{0.0, 0.5 * around.side * width, 0.0};
    fixture.fit.covariance(1, 1) += 0.007 * 0.007;  // where the burning half ends in the middle is soft
    return detection_of(fixture, DetectionState::kHalf);
  }
  // Burning halves are rare, and their dark half shows nearly always: without a sign of it the strip is a fixture.
  if (single != nullptr && !(around.valid && around.asymmetry >= 0.2 && !too_short)) {
    return detection_of(strip, DetectionState::kLit);
  }
  return std::nullopt;
}

std::array<Vector2d, 4> ModernDetector::corners_of(const OutlineHypothesis& hypothesis) const {
  const double x = 0.5 * hypothesis.outline.length;
  const double y = 0.5 * hypothesis.outline.width;
  std::array<Vector2d, 4> corners{Vector2d(x, y), Vector2d(-x, y), Vector2d(-x, -y), Vector2d(x, -y)};
  for (Vector2d& corner : corners) {
    corner = camera_.pixel_of_ceiling_point(hypothesis.start * corner, hypothesis.outline.height)
                 .value_or(Vector2d(-1.0, -1.0));
  }
  return corners;
}

Detection ModernDetector::detection_of(const Candidate& candidate, DetectionState state) const {
  const Outline& outline = candidate.hypothesis.outline;
  const OutlineFit& fit = candidate.fit;
  Detection detection;
  detection.shape = shape_of(candidate.hypothesis);
  detection.state = state;
  detection.has_theta = outline.shape != FixtureShape::kRound;
  detection.fit = fit.quality();
  detection.robot_from_fixture = fit.robot_from_outline;
  const double period = symmetry_period(outline.shape);
  Matrix3d covariance = fit.covariance;

  const bool bar = outline.shape == FixtureShape::kRectangle;
  detection.far_end_visible = !bar || fit.end_visible(kFarEnd);
  detection.near_end_visible = !bar || fit.end_visible(kNearEnd);
  double seen_from = -0.5 * outline.length;
  double seen_to = 0.5 * outline.length;
  if (!detection.near_end_visible) {
    seen_from = fit.visible_from;
  }
  if (!detection.far_end_visible) {
    seen_to = fit.visible_to;
  }
  if (!detection.far_end_visible && !detection.near_end_visible) {
    // Only a stretch is seen: the centre lies anywhere within what is left of the length.
    const double middle = 0.5 * (seen_from + seen_to);
    detection.robot_from_fixture = fit.robot_from_outline * Pose2{middle, 0.0, 0.0};
    Matrix3d shift = Matrix3d::Identity();
    shift(1, 2) = middle;
    covariance = shift * covariance * shift.transpose();
    covariance.row(0).setZero();
    covariance.col(0).setZero();
    const double free = std::max(0.0, outline.length - (seen_to - seen_from));
    covariance(0, 0) = free * free / 12.0 + 1e-4;
    seen_from -= middle;
    seen_to -= middle;
  } else if (detection.far_end_visible != detection.near_end_visible) {
    // One end: its bloom does not cancel, and other kinds of this width may be longer or shorter.
    covariance(0, 0) += 0.36 * fit.swelling * fit.swelling;
    double shortest = outline.length;
    double longest = outline.length;
    for (const CeilingKind& kind : catalogue_.fixtures) {
      if (!candidate.hypothesis.is_element && kind.shape == FixtureShape::kRectangle &&
          std::abs(kind.width - outline.width) < 0.02 && kind.length > seen_to - seen_from) {
        shortest = std::min(shortest, kind.length);
        longest = std::max(longest, kind.length);
      }
    }
    if (longest - shortest > 0.005) {
      const double inward = detection.far_end_visible ? -1.0 : 1.0;
      const double shift = 0.5 * inward * (0.5 * (shortest + longest) - outline.length);
      detection.robot_from_fixture = detection.robot_from_fixture * Pose2{shift, 0.0, 0.0};
      seen_from -= shift;
      seen_to -= shift;
      covariance(0, 0) += std::pow(0.25 * (longest - shortest), 2);
    }
  }
  if (outline.shape == FixtureShape::kRound) {
    covariance.row(2).setZero();
    covariance.col(2).setZero();
    covariance(2, 2) = kPi * kPi / 3.0;
  }
  detection.covariance = turned(covariance, detection.robot_from_fixture.theta);
  detection.robot_from_fixture.theta = wrap_modulo(detection.robot_from_fixture.theta, period);

  detection.length = seen_to - seen_from;
  detection.width = outline.width + 2.0 * fit.swelling;
  const Pose2& pose = detection.robot_from_fixture;
  // after wrapping by a quarter or half turn the ends may have changed places
  const double turned_by = std::abs(wrap_angle(pose.theta - fit.robot_from_outline.theta));
  if (turned_by > 0.75 * kPi) {
    std::swap(detection.far_end_visible, detection.near_end_visible);
    const double from = seen_from;
    seen_from = -seen_to;
    seen_to = -from;
  }
  const double half_width = 0.5 * outline.width;
  const std::array<Vector2d, 4> corners{Vector2d(seen_to, half_width), Vector2d(seen_from, half_width),
                                        Vector2d(seen_from, -half_width), Vector2d(seen_to, -half_width)};
  detection.clipped = false;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = camera_.pixel_of_ceiling_point(pose * corners[i], outline.height);
    detection.corners_px[i] = pixel.value_or(Vector2d(-1.0, -1.0));
    detection.clipped = detection.clipped || !pixel || !camera_.is_in_image(*pixel);
  }
  detection.clipped = detection.clipped || !detection.far_end_visible || !detection.near_end_visible;
  detection.centre_px = camera_.pixel_of_ceiling_point(pose.position(), outline.height).value_or(Vector2d(-1.0, -1.0));
  return detection;
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
