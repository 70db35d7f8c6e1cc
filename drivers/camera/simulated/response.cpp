#include "drivers/camera/simulated/response.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/camera/simulated/random.hpp"
#include "services/common/geometry/vector_clones.hpp"

namespace luminav::simulated {
namespace {

constexpr std::uint64_t kTilePurpose = 3;
constexpr std::uint64_t kRowPurpose = 4;
constexpr std::size_t kNoiseTile = 1U << 15U;
constexpr double kVignetteLoss = 0.30;  // in the corners; cheap webcams lose 20 to 40 %

}  // namespace

SensorResponse::SensorResponse(int width, int height, double grey_noise, std::uint64_t seed)
    : width_(width), height_(height), grey_noise_(grey_noise), seed_(seed) {
  // A tile, because drawing 307,200 deviates for each frame would cost more than all the rest.
  SplitMix random = random_stream(seed, kTilePurpose, 0);
  const std::size_t length = kNoiseTile + static_cast<std::size_t>(width);
  noise_.reserve(length);
  for (std::size_t i = 0; i < length; ++i) {
    noise_.push_back(static_cast<float>(random.gauss()));
  }
  const double corner = 0.25 * (double{1} * width * width + double{1} * height * height);
  for (int column = 0; column < width; ++column) {
    const double x = column - 0.5 * (width - 1);
    vignette_.push_back(static_cast<float>(kVignetteLoss * x * x / corner));
  }
}

void SensorResponse::begin_frame(std::uint64_t frame, double exposure_us, double gain) {
  frame_ = frame;
  scale_ = static_cast<float>(kNominalGrey * exposure_us / kNominalExposureUs * gain);
  // With gain fewer photons make the same grey level: shot noise grows with its root.
  sigma_ = static_cast<float>(grey_noise_ * std::sqrt(gain));
}

LUMINAV_VECTOR_CLONES void SensorResponse::develop(int row, const float* brightness, std::uint8_t* grey) const {
  SplitMix random = random_stream(seed_, kRowPurpose, frame_ * 8192 + static_cast<std::uint64_t>(row));
  const float* __restrict noise = noise_.data() + random.next() % kNoiseTile;
  const float* __restrict loss = vignette_.data();
  const float* __restrict in = brightness;
  std::uint8_t* __restrict out = grey;
  const double corner = 0.25 * (double{1} * width_ * width_ + double{1} * height_ * height_);
  const double y = row - 0.5 * (height_ - 1);
  const float middle = static_cast<float>(1.0 - kVignetteLoss * y * y / corner);
  // Copies, because bytes may alias the members and then nothing is vectorised.
  const int width = width_;
  const float scale = scale_;
  const float sigma = sigma_;
  for (int i = 0; i < width; ++i) {
    const float value = in[i] * scale * (middle - loss[i]) + sigma * noise[i] + 0.5F;
    out[i] = static_cast<std::uint8_t>(static_cast<int>(std::min(std::max(value, 0.0F), 255.0F)));
  }
}

}  // namespace luminav::simulated
