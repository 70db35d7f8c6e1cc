#include "drivers/camera/calibration/chessboard_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace luminav {
namespace {

using Corners = std::vector<cv::Point2f>;

std::vector<cv::Point3f> corners_on(const Chessboard& board) {
  std::vector<cv::Point3f> corners;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      corners.emplace_back(static_cast<float>(column * board.square), static_cast<float>(row * board.square), 0.0F);
    }
  }
  return corners;
}

/// Of the views that show a board at all, those that show it where no other before has: what the camera can be learnt
/// from. Some releases of OpenCV calibrate from less without complaint.
std::size_t count_different(const std::vector<Corners>& views, const Chessboard& board) {
  constexpr double kSamePlace = 1.0;       // [px] RMS; the same picture twice, or a board on a stand
  constexpr double kSmallestSquare = 4.0;  // [px^2] seen; below it corners run into each other
  const double smallest_board = kSmallestSquare * (board.rows - 1) * (board.columns - 1);
  std::vector<Corners> different;
  for (const Corners& view : views) {
    Corners hull;
    cv::convexHull(view, hull);
    const double same = kSamePlace * std::sqrt(static_cast<double>(view.size()));
    if (cv::contourArea(hull) >= smallest_board &&
        std::none_of(different.begin(), different.end(),
                     [&](const Corners& other) { return cv::norm(view, other, cv::NORM_L2) < same; })) {
      different.push_back(view);
    }
  }
  return different.size();
}

/// What the solvers of both lens models give.
struct Solution {
  cv::Mat matrix;
  cv::Mat distortion;
  std::vector<cv::Mat> rotations;
  std::vector<cv::Mat> translations;
};

Solution solve_pinhole(const std::vector<std::vector<cv::Point3f>>& board, const std::vector<Corners>& seen,
                       const cv::Size& size, LensCalibration& result) {
  Solution solution;
  cv::Mat sigmas;
  cv::calibrateCamera(board, seen, size, solution.matrix, solution.distortion, solution.rotations,
                      solution.translations, sigmas, cv::noArray(), cv::noArray());
  result.focal_sigma_px = std::max(sigmas.at<double>(0), sigmas.at<double>(1));
  result.centre_sigma_px = std::max(sigmas.at<double>(2), sigmas.at<double>(3));
  return solution;
}

Solution solve_fisheye(const std::vector<std::vector<cv::Point3f>>& board, const std::vector<Corners>& seen,
                       const cv::Size& size) {
  Solution solution;
  cv::fisheye::calibrate(board, seen, size, solution.matrix, solution.distortion, solution.rotations,
                         solution.translations, cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC | cv::fisheye::CALIB_FIX_SKEW);
  return solution;
}

void measure_residuals(const Solution& solution, LensModel model, const std::vector<cv::Point3f>& board,
                       const std::vector<Corners>& seen, LensCalibration& result) {
  double all = 0.0;
  std::size_t count = 0;
  for (std::size_t view = 0; view < seen.size(); ++view) {
    Corners predicted;
    if (model == LensModel::kFisheye) {
      cv::fisheye::projectPoints(board, predicted, solution.rotations[view], solution.translations[view],
                                 solution.matrix, solution.distortion);
    } else {
      cv::projectPoints(board, solution.rotations[view], solution.translations[view], solution.matrix,
                        solution.distortion, predicted);
    }
    std::vector<Eigen::Vector2d> residuals;
    double squares = 0.0;
    for (std::size_t i = 0; i < predicted.size(); ++i) {
      residuals.emplace_back(seen[view][i].x - predicted[i].x, seen[view][i].y - predicted[i].y);
      squares += residuals.back().squaredNorm();
    }
    result.view_rms_px.push_back(std::sqrt(squares / static_cast<double>(predicted.size())));
    result.residual_px.push_back(std::move(residuals));
    all += squares;
    count += predicted.size();
  }
  result.rms_px = std::sqrt(all / static_cast<double>(count));
}

}  // namespace

std::optional<BoardView> find_chessboard(const GreyView& image, const Chessboard& board) {
  const cv::Mat grey(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data()));
  Corners corners;
  if (!cv::findChessboardCorners(
          grey, {board.columns, board.rows}, corners,
          cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_FAST_CHECK)) {
    return std::nullopt;
  }
  // A window that reaches the neighbouring corners would be drawn to them.
  double nearest = 1e9;
  for (std::size_t i = 1; i < corners.size(); ++i) {
    nearest = std::min(nearest, cv::norm(corners[i] - corners[i - 1]));
  }
  const int half = std::clamp(static_cast<int>(0.6 * nearest), 2, board.window_px);
  cv::cornerSubPix(grey, corners, {half, half}, {-1, -1}, {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 40, 0.005});
  BoardView view;
  for (const cv::Point2f& corner : corners) {
    view.emplace_back(corner.x, corner.y);
  }
  return view;
}

LensCalibration calibrate_lens(const std::vector<BoardView>& views, const Chessboard& board, LensModel model, int width,
                               int height) {
  const std::vector<cv::Point3f> flat = corners_on(board);
  const std::vector<std::vector<cv::Point3f>> boards(views.size(), flat);
  std::vector<Corners> seen;
  for (const BoardView& view : views) {
    Corners& corners = seen.emplace_back();
    for (const Eigen::Vector2d& corner : view) {
      corners.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
    }
  }
  if (const std::size_t different = count_different(seen, board); different < kFewestViews) {
    throw std::runtime_error("of " + std::to_string(views.size()) + " views of the board " + std::to_string(different) +
                             " differ, at least " + std::to_string(kFewestViews) +
                             " are needed, in different directions and places");
  }
  LensCalibration result;
  Solution solution;
  try {
    solution = model == LensModel::kFisheye ? solve_fisheye(boards, seen, {width, height})
                                            : solve_pinhole(boards, seen, {width, height}, result);
  } catch (const cv::Exception& error) {
    throw std::runtime_error("the views determine no camera (" + std::string(error.err) +
                             "): show the board in more directions");
  }
  CameraIntrinsics& lens = result.intrinsics;
  lens = {.model = model,
          .width = width,
          .height = height,
          .fx = solution.matrix.at<double>(0, 0),
          .fy = solution.matrix.at<double>(1, 1),
          .cx = solution.matrix.at<double>(0, 2),
          .cy = solution.matrix.at<double>(1, 2),
          .distortion = {}};
  for (std::size_t i = 0; i < std::min(lens.distortion.size(), solution.distortion.total()); ++i) {
    lens.distortion[i] = solution.distortion.at<double>(static_cast<int>(i));
  }
  if (!std::isfinite(lens.fx) || !std::isfinite(lens.fy) || lens.fx <= 0.0 || lens.fy <= 0.0) {
    throw std::runtime_error("the views determine no camera: show the board in more directions");
  }
  measure_residuals(solution, model, flat, seen, result);
  return result;
}

std::vector<std::array<std::uint8_t, 3>> draw_residuals(const LensCalibration& calibration,
                                                        const std::vector<BoardView>& views, double scale) {
  const CameraIntrinsics& lens = calibration.intrinsics;
  cv::Mat picture(lens.height, lens.width, CV_8UC3, cv::Scalar(255, 255, 255));
  const auto to_point = [](const Eigen::Vector2d& pixel) {
    constexpr double kSubPixel = 16.0;  // the drawing functions' fixed point
    return cv::Point(static_cast<int>(std::lround(kSubPixel * std::clamp(pixel.x(), -500.0, 1e4))),
                     static_cast<int>(std::lround(kSubPixel * std::clamp(pixel.y(), -500.0, 1e4))));
  };
  constexpr int kShift = 4;
  for (std::size_t view = 0; view < views.size(); ++view) {
    cv::Mat hue(1, 1, CV_8UC3, cv::Scalar(static_cast<double>(180 * view / views.size()), 230, 170));
    cv::cvtColor(hue, hue, cv::COLOR_HSV2RGB);
    const auto rgb = hue.at<cv::Vec3b>(0);
    const cv::Scalar colour(rgb[0], rgb[1], rgb[2]);
    for (std::size_t i = 0; i < views[view].size(); ++i) {
      const Eigen::Vector2d& corner = views[view][i];
      const Eigen::Vector2d tip = corner + scale * calibration.residual_px[view][i];
      cv::circle(picture, to_point(corner), 24, colour, cv::FILLED, cv::LINE_AA, kShift);
      cv::line(picture, to_point(corner), to_point(tip), colour, 1, cv::LINE_AA, kShift);
    }
  }
  // a residual of one pixel, for comparison
  const cv::Scalar black(0, 0, 0);
  cv::line(picture, {12, lens.height - 12}, {12 + static_cast<int>(scale), lens.height - 12}, black, 2, cv::LINE_AA);
  cv::putText(picture, cv::format("1 px; RMS %.3f px", calibration.rms_px),
              {20 + static_cast<int>(scale), lens.height - 8}, cv::FONT_HERSHEY_SIMPLEX, 0.45, black, 1, cv::LINE_AA);
  std::vector<std::array<std::uint8_t, 3>> pixels;
  pixels.reserve(picture.total());
  for (const auto& pixel : cv::Mat_<cv::Vec3b>(picture)) {
    pixels.push_back({pixel[0], pixel[1], pixel[2]});
  }
  return pixels;
}

}  // namespace luminav
