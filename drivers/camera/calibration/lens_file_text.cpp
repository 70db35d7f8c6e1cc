#include "drivers/camera/calibration/lens_file_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/common/configuration/toml_edit.hpp"

namespace luminav {

std::string with_lens(const std::string& robot_toml, const LensCalibration& calibration) {
  const CameraIntrinsics& lens = calibration.intrinsics;
  const auto number = [](double value, double sigma) {
    return sigma > 0.0 ? fmt::format("{:.3f}  # +- {:.2f}", value, sigma) : fmt::format("{:.3f}", value);
  };
  return with_keys_set(
      robot_toml, "camera",
      {{"model", lens.model == LensModel::kFisheye ? "\"fisheye\"" : "\"pinhole\""},
       {"width", std::to_string(lens.width)},
       {"height", std::to_string(lens.height)},
       {"fx", number(lens.fx, calibration.focal_sigma_px)},
       {"fy", number(lens.fy, calibration.focal_sigma_px)},
       {"cx", number(lens.cx, calibration.centre_sigma_px)},
       {"cy", number(lens.cy, calibration.centre_sigma_px)},
       {"distortion",
        fmt::format("[{:.6f}]  # {} views of a chessboard, reprojection error {:.3f} px RMS",
                    fmt::join(lens.distortion, ", "), calibration.view_rms_px.size(), calibration.rms_px)}});
}

}  // namespace luminav
