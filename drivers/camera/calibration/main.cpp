// Calibrates a camera's lens from pictures of a chessboard, or from a live camera, and writes it to the robot's file.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "drivers/camera/calibration/chessboard_calibration.hpp"
#include "drivers/camera/calibration/lens_file_text.hpp"
#include "drivers/camera/calibration/live_views.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/common/image/picture_file.hpp"
#include "services/common/process/command_line.hpp"

namespace luminav {
namespace {

struct Arguments {
  std::vector<std::string> pictures;
  std::string robot;
  std::string device;
  std::string board = "9x6";
  std::string model = "pinhole";
  std::string out;
  std::string residuals;
  double square = 0.025;
  std::int64_t window = 0;  // the better one of those below
  std::int64_t views = 20;
  bool only_look = false;
};

constexpr int kUsualWindow = 11;  // [px]
constexpr int kSmallWindow = 5;   // [px] where squares are small or pictures blurred

struct Views {
  std::vector<BoardView> views;
  std::vector<std::string> names;
  int width = 0;
  int height = 0;
};

Chessboard board_of(const Arguments& arguments) {
  Chessboard board;
  char rest = 0;
  if (std::sscanf(arguments.board.c_str(), "%dx%d%c", &board.columns, &board.rows, &rest) != 2 || board.columns < 3 ||
      board.rows < 3 || board.columns > 50 || board.rows > 50) {
    throw ConfigurationError("--board " + arguments.board + ": must be COLUMNSxROWS of inner corners, as 9x6");
  }
  if (!(arguments.square > 0.0 && arguments.square < 1.0)) {
    throw ConfigurationError("--square: must be the side of a square in metres");
  }
  if (arguments.window != 0 && (arguments.window < 2 || arguments.window > 50)) {
    throw ConfigurationError("--window: must be 2 to 50 px, or 0 for the better one of two");
  }
  board.square = arguments.square;
  board.window_px = arguments.window == 0 ? kUsualWindow : static_cast<int>(arguments.window);
  return board;
}

LensModel lens_model(const Arguments& arguments) {
  return arguments.model == "fisheye" ? LensModel::kFisheye : LensModel::kPinhole;
}

Views read_views(const std::vector<std::string>& files, const Chessboard& board) {
  Views result;
  for (const std::string& file : files) {
    const cv::Mat picture = cv::imread(file, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
    if (picture.empty()) {
      throw std::runtime_error(file + ": cannot be read as a picture");
    }
    if (result.width == 0) {
      result.width = picture.cols;
      result.height = picture.rows;
    } else if (result.width != picture.cols || result.height != picture.rows) {
      throw std::runtime_error(fmt::format("{}: {} x {} px, the pictures before are {} x {}: one camera, one size",
                                           file, picture.cols, picture.rows, result.width, result.height));
    }
    const auto view = find_chessboard({picture.cols, picture.rows, {picture.data, picture.total()}}, board);
    if (!view) {
      fmt::print("{}: no board of {} x {} inner corners\n", file, board.columns, board.rows);
      continue;
    }
    result.views.push_back(*view);
    result.names.push_back(std::filesystem::path(file).filename().string());
  }
  return result;
}

void print(const LensCalibration& calibration, const Views& views) {
  const CameraIntrinsics& lens = calibration.intrinsics;
  for (std::size_t i = 0; i < views.names.size(); ++i) {
    fmt::print("  {:<24} {:.3f} px{}\n", views.names[i], calibration.view_rms_px[i],
               calibration.view_rms_px[i] > 2.0 * calibration.rms_px ? "  worse than the others: blurred?" : "");
  }
  fmt::print("{} views, reprojection error {:.3f} px RMS\n", calibration.view_rms_px.size(), calibration.rms_px);
  fmt::print("fx {:.2f}  fy {:.2f}  cx {:.2f}  cy {:.2f} px", lens.fx, lens.fy, lens.cx, lens.cy);
  if (calibration.focal_sigma_px > 0.0) {
    fmt::print("  (+- {:.2f} and {:.2f})", calibration.focal_sigma_px, calibration.centre_sigma_px);
  }
  fmt::print("\ndistortion {:.5f}\n", fmt::join(lens.distortion, " "));
}

void write_residuals(const std::string& file, const LensCalibration& calibration, const Views& views) {
  constexpr double kScale = 40.0;
  auto pixels = draw_residuals(calibration, views.views, kScale);
  for (auto& pixel : pixels) {
    std::swap(pixel[0], pixel[2]);
  }
  const cv::Mat picture(views.height, views.width, CV_8UC3, pixels.data());
  write_picture(file, picture);
}

struct Fit {
  Views views;
  LensCalibration calibration;
};

Fit fit_lens(const Arguments& arguments, const Chessboard& board) {
  Fit fit{read_views(arguments.pictures, board), {}};
  fit.calibration = calibrate_lens(fit.views.views, board, lens_model(arguments), fit.views.width, fit.views.height);
  return fit;
}

/// The usual window, or the smaller one where that fits the same views clearly better.
Fit fit_with_better_window(const Arguments& arguments, Chessboard board) {
  Fit usual = fit_lens(arguments, board);
  board.window_px = kSmallWindow;
  Fit small = fit_lens(arguments, board);
  const bool is_better =
      small.views.views.size() >= usual.views.views.size() && small.calibration.rms_px < 0.9 * usual.calibration.rms_px;
  fmt::print("corners refined within {} px: {:.3f} px RMS, within {} px {:.3f} px; took {} px\n", kUsualWindow,
             usual.calibration.rms_px, kSmallWindow, small.calibration.rms_px, is_better ? kSmallWindow : kUsualWindow);
  return is_better ? small : usual;
}

Fit fit_live(const Arguments& arguments, const Chessboard& board, const CameraIntrinsics& asked) {
  LiveCamera camera{arguments.device, asked.width, asked.height};
  Views views;
  views.views =
      collect_live(camera, board, static_cast<std::size_t>(std::clamp<std::int64_t>(arguments.views, 4, 500)));
  views.width = camera.width;
  views.height = camera.height;
  return {views, calibrate_lens(views.views, board, lens_model(arguments), views.width, views.height)};
}

int run(const Arguments& arguments) {
  if (arguments.model != "pinhole" && arguments.model != "fisheye") {
    throw ConfigurationError("--model " + arguments.model + ": must be pinhole or fisheye");
  }
  if (arguments.pictures.empty() == arguments.device.empty()) {
    throw ConfigurationError("either pictures of the board or --device DEV");
  }
  const Chessboard board = board_of(arguments);
  RobotDescription robot;
  if (!arguments.robot.empty()) {
    robot = read_robot(std::filesystem::path(arguments.robot));
  }
  const auto [views, calibration] = !arguments.device.empty() ? fit_live(arguments, board, robot.camera.intrinsics)
                                    : arguments.window == 0   ? fit_with_better_window(arguments, board)
                                                              : fit_lens(arguments, board);
  print(calibration, views);
  if (!arguments.residuals.empty()) {
    write_residuals(arguments.residuals, calibration, views);
    fmt::print("residuals drawn in {}\n", arguments.residuals);
  }
  if (arguments.robot.empty()) {
    fmt::print("\n{}", with_lens("", calibration));
  } else if (!arguments.only_look) {
    const std::string target = arguments.out.empty() ? arguments.robot : arguments.out;
    const std::string text = with_lens(read_whole_file(arguments.robot), calibration);
    write_whole_file(target, text);
    fmt::print("written to {}\n", target);
  }
  return 0;
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  return luminav::run_guarded("calibrate", [&] {
    luminav::Arguments arguments;
    luminav::CommandLine line(
        "calibrate",
        "Calibrates a lens from pictures of a chessboard, or a live camera, and writes the camera "
        "table of the robot's file; without --robot it prints the table.");
    line.positional("pictures", arguments.pictures, "of the board, all of one size")
        .text("--robot", arguments.robot, "robot's file, whose mounting and timing stay")
        .text("--device", arguments.device, "live camera instead of pictures, as /dev/video0")
        .integer("--views", arguments.views, "to take from a live camera")
        .text("--board", arguments.board, "inner corners of the board, COLUMNSxROWS")
        .number("--square", arguments.square, "side of a square [m]")
        .integer("--window", arguments.window,
                 "half side of the window in which corners are refined [px]; 0 = 11, or 5 where that fits better")
        .text("--model", arguments.model, "pinhole or fisheye")
        .output_file("--png,--residuals", arguments.residuals, "picture of the residuals to write (.png)")
        .output_file("--out", arguments.out, "file to write instead of the robot's own")
        .flag("--dry-run", arguments.only_look, "leave the robot's file as it is");
    if (const auto status = line.parse(argc, argv)) {
      return *status;
    }
    return luminav::run(arguments);
  });
}
