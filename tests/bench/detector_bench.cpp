// The detector and, beside it in the same run, OpenCV's chain on an image with two lights. The image comes from a
// generator of its own so that others can replicate it; its sum and what is found in it are checked before anything is
// timed, and the program fails if they are not met.

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "services/common/geometry/split_mix.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/common/image/jpeg_codec.hpp"
#include "services/detector/detector.hpp"

namespace luminav {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;

struct Light {
  double x, y, angle, length, width;
};

std::vector<Light> draw_lights(int count, SplitMix& random) {
  constexpr std::array<std::array<double, 2>, 3> kPlaces{{{170, 130}, {470, 340}, {320, 235}}};
  std::vector<Light> lights;
  for (int i = 0; i < count; ++i) {
    Light light{};
    light.x = kPlaces[static_cast<std::size_t>(i)][0] + random.uniform(-30, 30);
    light.y = kPlaces[static_cast<std::size_t>(i)][1] + random.uniform(-25, 25);
    light.angle = random.uniform(0, kPi);
    light.length = 150 + random.uniform(-10, 10);
    light.width = 40 + random.uniform(-4, 4);
    lights.push_back(light);
  }
  return lights;
}

GreyImage draw_image(const std::vector<Light>& lights, SplitMix& random) {
  GreyImage image{kWidth, kHeight, {}};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      double grey = 60.0 + 20.0 * x / kWidth + 4.0 * random.gauss();
      for (const Light& light : lights) {
        const double c = std::cos(light.angle);
        const double s = std::sin(light.angle);
        const double u = std::abs(c * (x - light.x) + s * (y - light.y)) - 0.5 * light.length;
        const double v = std::abs(-s * (x - light.x) + c * (y - light.y)) - 0.5 * light.width;
        const double outside = std::hypot(std::max(u, 0.0), std::max(v, 0.0));
        grey += outside <= 0.0 ? 250.0 : 150.0 * std::exp(-outside / 8.0);
      }
      image.pixels.push_back(static_cast<std::uint8_t>(std::clamp(grey, 0.0, 255.0)));
    }
  }
  return image;
}

struct Workload {
  std::vector<Light> lights;
  GreyImage image;
};

const Workload& workload(int count) {
  static const std::array<Workload, 3> all = [] {
    std::array<Workload, 3> made;
    for (int n = 1; n <= 3; ++n) {
      SplitMix random(9);
      Workload& work = made[static_cast<std::size_t>(n - 1)];
      work.lights = draw_lights(n, random);
      work.image = draw_image(work.lights, random);
    }
    return made;
  }();
  return all[static_cast<std::size_t>(count - 1)];
}

/// Thresholds, opening by 3 x 3 twice, Canny, external contours, moments, smallest rectangle.
class OpenCvChain {
 public:
  struct Found {
    double x, y;
    cv::RotatedRect rectangle;
  };

  const std::vector<Found>& find(const GreyImage& image) {
    const cv::Mat grey(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data()));
    cv::threshold(grey, high_, 200, 255, cv::THRESH_BINARY);
    cv::threshold(grey, low_, 30, 255, cv::THRESH_BINARY_INV);
    cv::bitwise_or(high_, low_, mask_);
    cv::erode(mask_, opened_, kernel_, {-1, -1}, 2);
    cv::dilate(opened_, mask_, kernel_, {-1, -1}, 2);
    cv::Canny(mask_, edges_, 50, 150);
    cv::findContours(edges_, contours_, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    found_.clear();
    for (const auto& contour : contours_) {
      if (contour.size() < 60 || cv::contourArea(contour) < 500) {
        continue;
      }
      const cv::Moments moments = cv::moments(contour);
      found_.push_back({moments.m10 / moments.m00, moments.m01 / moments.m00, cv::minAreaRect(contour)});
    }
    return found_;
  }

 private:
  cv::Mat kernel_ = cv::getStructuringElement(cv::MORPH_RECT, {3, 3});
  cv::Mat high_, low_, mask_, opened_, edges_;
  std::vector<std::vector<cv::Point>> contours_;
  std::vector<Found> found_;
};

CameraDescription camera() {
  CameraDescription description;
  description.mounting.z = 0.3;
  return description;
}

/// The lights as fixtures 2.5 m above the camera.
CeilingCatalogue catalogue(const std::vector<Light>& lights) {
  CeilingCatalogue result;
  for (const Light& light : lights) {
    const double scale = 2.5 / camera().intrinsics.fx;
    result.fixtures.push_back(
        {.length = scale * light.length, .width = scale * light.width, .height = 2.8, .lamps = 1});
  }
  return result;
}

Detector make_detector(DetectorMode mode) {
  DetectorParams params;
  params.mode = mode;
  return Detector(params, camera(), catalogue(workload(2).lights));
}

void opencv_chain(benchmark::State& state) {
  OpenCvChain chain;
  for (auto _ : state) {
    benchmark::DoNotOptimize(chain.find(workload(2).image).data());
  }
}

void detect(benchmark::State& state, DetectorMode mode) {
  Detector detector = make_detector(mode);
  for (auto _ : state) {
    benchmark::DoNotOptimize(detector.detect(workload(2).image.view()).size());
  }
}

void jpeg_decode(benchmark::State& state) {
  JpegEncoder encoder;
  const auto bytes = encoder.encode(workload(2).image.view(), 85);
  JpegDecoder decoder;
  GreyImage image;
  for (auto _ : state) {
    benchmark::DoNotOptimize(decoder.decode(bytes, image));
  }
  state.counters["bytes"] = static_cast<double>(bytes.size());
}

void require(bool holds, const std::string& what) {
  if (!holds) {
    fmt::print(stderr, "bench_detector: {}\n", what);
    std::exit(1);
  }
}

/// The image is the one meant, and all find the same lights in it.
void check() {
  require(std::abs(SplitMix(42).uniform() - 0.741564878772) < 1e-12, "first uniform number of seed 42");
  require(std::abs(SplitMix(7).gauss() - 0.988474332319) < 1e-12, "first normal number of seed 7");
  // light falls off with the distance to the rectangle, corners rounded; where two meet they add up
  constexpr std::array<std::int64_t, 3> kSums{22997832, 24614738, 26246012};
  for (int n = 1; n <= 3; ++n) {
    std::int64_t sum = 0;
    for (const std::uint8_t grey : workload(n).image.pixels) {
      sum += grey;
    }
    require(sum == kSums[static_cast<std::size_t>(n - 1)], fmt::format("image {}: sum of pixels {}", n, sum));
    OpenCvChain chain;
    const std::size_t found = chain.find(workload(n).image).size();
    require(found == static_cast<std::size_t>(n), fmt::format("image {}: OpenCV finds {}", n, found));
  }
  const std::vector<Detection> modern = make_detector(DetectorMode::kModern).detect(workload(2).image.view());
  require(modern.size() == 2, fmt::format("modern mode finds {}", modern.size()));
  for (const Detection& detection : modern) {
    const auto same = std::any_of(workload(2).lights.begin(), workload(2).lights.end(), [&](const Light& light) {
      return std::hypot(light.x - detection.centre_px.x(), light.y - detection.centre_px.y()) < 0.5;
    });
    require(same,
            fmt::format("modern mode: no light at {:.2f} {:.2f}", detection.centre_px.x(), detection.centre_px.y()));
  }
}

BENCHMARK(opencv_chain)->Name("detector/opencv");
BENCHMARK_CAPTURE(detect, modern, DetectorMode::kModern)->Name("detector/modern");
BENCHMARK_CAPTURE(detect, paper, DetectorMode::kPaper)->Name("detector/paper");
BENCHMARK(jpeg_decode)->Name("jpeg_decode");

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  // Else the heap's end goes back to the system between frames, as chance has it, and its page faults double what
  // OpenCV's chain takes.
  mallopt(M_MMAP_THRESHOLD, 64 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
  luminav::check();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
