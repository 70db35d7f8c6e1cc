// Pictures from the bus and from files, and what the detector makes of any pixels.
#include <array>
#include <cmath>
#include <cstdlib>
#include <span>
#include <vector>

#include "drivers/camera/sources/pgm_file.hpp"
#include "services/common/image/jpeg_codec.hpp"
#include "services/detector/detector.hpp"

using namespace luminav;

namespace {

constexpr int kWidth = 96;   // [px]
constexpr int kHeight = 72;  // [px]

void require(bool claim) {
  if (!claim) {
    std::abort();
  }
}

Detector make_detector(DetectorMode mode) {
  CameraDescription camera;
  camera.intrinsics.width = kWidth;
  camera.intrinsics.height = kHeight;
  camera.intrinsics.fx = camera.intrinsics.fy = 80.0;
  camera.intrinsics.cx = 0.5 * (kWidth - 1);
  camera.intrinsics.cy = 0.5 * (kHeight - 1);
  camera.mounting.z = 0.3;
  Building building;
  building.ceiling_height = 2.8;
  building.fixtures.resize(2);
  building.fixtures[0].id = 1;
  building.fixtures[0].length = 1.2;
  building.fixtures[0].width = 0.3;
  building.fixtures[1].id = 2;
  building.fixtures[1].length = building.fixtures[1].width = 0.6;
  building.fixtures[1].shape = FixtureShape::kSquare;
  DetectorParams params;
  params.mode = mode;
  return {params, camera, catalogue_of(building)};
}

void detect(Detector& detector, const std::vector<std::uint8_t>& pixels) {
  for (const Detection& detection : detector.detect({kWidth, kHeight, pixels})) {
    require(std::isfinite(detection.robot_from_fixture.x) && std::isfinite(detection.robot_from_fixture.y) &&
            std::isfinite(detection.robot_from_fixture.theta) && detection.covariance.allFinite());
  }
}

/// A grey with rectangles on it, five bytes each, then raw pixels over its beginning.
std::vector<std::uint8_t> paint(std::span<const std::uint8_t> input) {
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(kWidth) * kHeight, input.empty() ? 128 : input[0]);
  std::size_t at = 2;
  for (std::size_t left = input.size() > 1 ? input[1] % 12 : 0; left > 0 && at + 5 <= input.size(); --left, at += 5) {
    const int column = input[at] % kWidth, row = input[at + 1] % kHeight;
    const int width = std::min<int>(input[at + 2], kWidth - column),
              height = std::min<int>(input[at + 3], kHeight - row);
    for (int r = row; r < row + height; ++r) {
      const auto begin = pixels.begin() + r * kWidth + column;
      std::fill(begin, begin + width, input[at + 4]);
    }
  }
  for (std::size_t i = 0; at + i < input.size() && i < pixels.size(); ++i) {
    pixels[i] = input[at + i];
  }
  return pixels;
}

}  // namespace

/// The first byte says what the rest is.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Detector modern = make_detector(DetectorMode::kModern);
  static Detector paper = make_detector(DetectorMode::kPaper);
  static JpegDecoder decoder(kWidth, kHeight);
  static GreyImage image;
  if (size == 0) {
    return 0;
  }
  const std::span input(data + 1, size - 1);
  switch (data[0] % 4) {
    case 0:
      if (decoder.decode(input, image)) {
        require(image.width == kWidth && image.height == kHeight);
        detect(modern, image.pixels);
      }
      break;
    case 1:
      if (read_pgm(input, image)) {
        require(image.pixels.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
      }
      break;
    case 2:
      detect(modern, paint(input));
      break;
    default:
      detect(paper, paint(input));
  }
  return 0;
}
