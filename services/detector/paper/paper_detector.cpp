#include "services/detector/paper/paper_detector.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "services/detector/sampling/raster.hpp"

namespace luminav {
namespace {

Eigen::Vector2d to_eigen(const cv::Point2d& point) {
  return {point.x, point.y};
}

/// True if the point [px] lies in the fixture's rectangle.
bool covers(const Detection& detection, const Eigen::Vector2d& point) {
  std::vector<cv::Point2f> corners;
  for (const Eigen::Vector2d& corner : detection.corners_px) {
    corners.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
  }
  return cv::pointPolygonTest(corners, {static_cast<float>(point.x()), static_cast<float>(point.y())}, false) >= 0.0;
}

}  // namespace

PaperDetector::PaperDetector(const PaperParams& params, const CeilingCamera& camera, const CeilingCatalogue& catalogue)
    : params_(params), camera_(camera), height_(catalogue.ceiling_height) {
  for (const CeilingKind& kind : catalogue.fixtures) {
    if (kind.shape != FixtureShape::kRound) {
      lengths_.add(kind.length);
      widths_.add(kind.width);
    }
  }
}

void PaperDetector::segment(const cv::Mat& image, double median) {
  // Threshold 1 finds lit lamps, threshold 2 unlit fixtures; the masks are combined, but both are kept: for the state,
  // and for lamps that drown in the combination, as under a dark roof that is all below threshold 2.
  const double high = std::min(std::max(params_.high_threshold, median + params_.high_above_median), 254.0);
  const double low = std::min(params_.low_threshold, median - params_.low_below_median);
  cv::threshold(image, lit_, high, 255.0, cv::THRESH_BINARY);
  cv::threshold(image, unlit_, low, 255.0, cv::THRESH_BINARY_INV);
}

void PaperDetector::find_contours(const cv::Mat& mask) {
  mask.copyTo(opened_);
  if (params_.opening_iterations > 0) {
    const cv::Mat kernel = cv::getStructuringElement(cv::MORPH_RECT, {params_.opening_size, params_.opening_size});
    cv::morphologyEx(opened_, opened_, cv::MORPH_OPEN, kernel, {-1, -1}, params_.opening_iterations);
  }
  if (!params_.direct_contours) {
    cv::Canny(opened_, edges_, params_.canny_low, params_.canny_high);
  }
  cv::findContours(params_.direct_contours ? opened_ : edges_, contours_, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
}

void PaperDetector::detect(const GreyView& image, double median, std::vector<Detection>& detections,
                           DetectorTrace* trace) {
  detections.clear();
  if (lengths_.high <= 0.0) {
    return;
  }
  // OpenCV has no constant view; nothing writes to it
  const cv::Mat grey = raster_of(image);
  segment(grey, median);
  cv::bitwise_or(lit_, unlit_, combined_);
  for (const cv::Mat& mask : {combined_, lit_, unlit_}) {
    find_contours(mask);
    add_fixtures(detections, trace);
  }
}

void PaperDetector::add_fixtures(std::vector<Detection>& detections, DetectorTrace* trace) const {
  for (const std::vector<cv::Point>& contour : contours_) {
    if (contour.size() < 8) {
      continue;
    }
    if (trace != nullptr) {
      std::vector<Eigen::Vector2d> line;
      for (const cv::Point& point : contour) {
        line.push_back(to_eigen(point));
      }
      trace->contours.push_back(std::move(line));
    }
    const auto detection = fixture_of(contour);
    const auto is_found = [&](const Detection& other) { return covers(other, detection->centre_px); };
    if (!detection || std::any_of(detections.begin(), detections.end(), is_found)) {
      continue;
    }
    if (trace != nullptr) {
      trace->rectangles.push_back(detection->corners_px);
    }
    detections.push_back(*detection);
  }
}

bool PaperDetector::is_cut(const std::vector<cv::Point>& contour) const {
  const cv::Rect box = cv::boundingRect(contour);
  return box.x <= 1 || box.y <= 1 || box.br().x >= lit_.cols - 1 || box.br().y >= lit_.rows - 1;
}

std::optional<Detection> PaperDetector::fixture_of(const std::vector<cv::Point>& contour) const {
  if (!params_.accept_cut && is_cut(contour)) {
    return std::nullopt;
  }
  const cv::Moments moments = cv::moments(contour);
  // A contour runs through the centres of the border pixels: half a pixel is missing on each side.
  const double contour_area = moments.m00 + 0.5 * static_cast<double>(contour.size()) + 1.0;
  cv::RotatedRect rectangle = cv::minAreaRect(contour);
  rectangle.size += cv::Size2f(1.0F, 1.0F);
  if (moments.m00 <= 0.0) {
    return std::nullopt;
  }
  auto detection = pose_of({moments.m10 / moments.m00, moments.m01 / moments.m00}, rectangle);
  if (!detection) {
    return std::nullopt;
  }
  detection->state = state_of(contour);
  detection->fit = std::min(1.0, contour_area / static_cast<double>(rectangle.size.area()));
  return fits(*detection) ? detection : std::nullopt;
}

/// Area and length as a fixture has them, width between one lamp's and two lamps'. What is lit may look larger by its
/// bloom.
bool PaperDetector::fits(const Detection& detection) const {
  const double bloom = detection.state == DetectionState::kUnlit ? 0.0 : params_.bloom;
  const auto is_within = [](double value, double low, double high, double tolerance) {
    return value >= (1.0 - tolerance) * low && value <= (1.0 + tolerance) * high;
  };
  const double longest = lengths_.high + bloom;
  const double widest = widths_.high + bloom;
  const double area = detection.fit * detection.length * detection.width;
  return is_within(detection.length, lengths_.low, longest, params_.length_tolerance) &&
         is_within(detection.width, widths_.low, widest, params_.width_tolerance) &&
         is_within(area, lengths_.low * widths_.low, longest * widest, params_.area_tolerance) &&
         detection.fit >= params_.minimum_fill;
}

DetectionState PaperDetector::state_of(const std::vector<cv::Point>& contour) const {
  const cv::Rect box = cv::boundingRect(contour) & cv::Rect(0, 0, lit_.cols, lit_.rows);
  cv::Mat filled = cv::Mat::zeros(box.size(), CV_8UC1);
  cv::drawContours(filled, std::vector<std::vector<cv::Point>>{contour}, 0, 255, cv::FILLED, cv::LINE_8, cv::noArray(),
                   0, -box.tl());
  const double all = cv::countNonZero(filled);
  const double lit = cv::countNonZero(lit_(box) & filled);
  if (all <= 0.0) {
    return DetectionState::kUnknown;
  }
  if (lit > params_.half_lit_share * all) {
    return DetectionState::kLit;
  }
  return lit < (1.0 - params_.half_lit_share) * all ? DetectionState::kUnlit : DetectionState::kHalf;
}

std::optional<Detection> PaperDetector::pose_of(const cv::Point2d& centre, const cv::RotatedRect& rectangle) const {
  Detection detection;
  std::array<cv::Point2f, 4> corners;
  rectangle.points(corners.data());
  for (std::size_t i = 0; i < 4; ++i) {
    detection.corners_px[i] = to_eigen(corners[i]);
    detection.clipped = detection.clipped || !camera_.is_in_image(detection.corners_px[i], 1.0);
  }
  const auto side = [&](std::size_t a, std::size_t b) -> std::optional<Eigen::Vector2d> {
    const auto from = camera_.point_on_ceiling(detection.corners_px[a], height_);
    const auto to = camera_.point_on_ceiling(detection.corners_px[b], height_);
    return from && to ? std::optional<Eigen::Vector2d>(*to - *from) : std::nullopt;
  };
  const auto first = side(0, 1);
  const auto second = side(1, 2);
  const auto place = camera_.point_on_ceiling(to_eigen(centre), height_);
  if (!first || !second || !place) {
    return std::nullopt;
  }
  const Eigen::Vector2d along = first->norm() > second->norm() ? *first : *second;
  detection.centre_px = to_eigen(centre);
  detection.robot_from_fixture = {place->x(), place->y(), wrap_axis(std::atan2(along.y(), along.x()))};
  detection.length = along.norm();
  detection.width = std::min(first->norm(), second->norm());
  const double position = params_.position_sigma * params_.position_sigma;
  detection.covariance =
      Eigen::Vector3d(position, position, params_.heading_sigma * params_.heading_sigma).asDiagonal();
  return detection;
}

}  // namespace luminav
