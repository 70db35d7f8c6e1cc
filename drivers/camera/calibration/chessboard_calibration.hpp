#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "services/common/geometry/camera_model.hpp"
#include "services/common/image/grey_image.hpp"

namespace luminav {

/// The flat board that is shown to the camera.
struct Chessboard {
  int columns = 9;        // inner corners
  int rows = 6;           // inner corners
  double square = 0.025;  // [m]
  int window_px = 11;     // half of the side of the window in which a corner is refined
};

/// Inner corners of a board in one picture [px], row by row.
using BoardView = std::vector<Eigen::Vector2d>;

/// Finds the board and its corners to sub-pixel; nothing when it is not in the picture as a whole.
std::optional<BoardView> find_chessboard(const GreyView& image, const Chessboard& board);

/// What makes one camera the best explanation of all views.
struct LensCalibration {
  CameraIntrinsics intrinsics;
  double rms_px = 0.0;                                    // reprojection error over all corners
  std::vector<double> view_rms_px;                        // of each view
  std::vector<std::vector<Eigen::Vector2d>> residual_px;  // of each view and corner: seen less predicted
  double focal_sigma_px = 0.0;                            // 1 sigma of fx and fy, at most; 0 = unknown
  double centre_sigma_px = 0.0;                           // of cx and cy
};

inline constexpr std::size_t kFewestViews = 4;

/// Zhang 2000 for the pinhole (k1 k2 p1 p2 k3), Kannala and Brandt 2006 for the fisheye (k1 to k4). Needs at least
/// `kFewestViews` views in different directions; throws when they determine no camera.
LensCalibration calibrate_lens(const std::vector<BoardView>& views, const Chessboard& board, LensModel model, int width,
                               int height);

/// Corner residuals of all views drawn where they were seen, `scale` times enlarged, a colour for each view; RGB bytes,
/// row by row, of the size of the camera's image.
std::vector<std::array<std::uint8_t, 3>> draw_residuals(const LensCalibration& calibration,
                                                        const std::vector<BoardView>& views, double scale);

}  // namespace luminav
