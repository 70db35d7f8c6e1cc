#include "drivers/camera/exposure_control.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace luminav {
namespace {

constexpr double kWhiteShare = 0.6;     // more saturated pixels than this are no lamps
constexpr double kBlindFactor = 2.5;    // so far out of the range nothing is seen, and turning is no excuse
constexpr int kLongestWait = 10;        // [frames] a camera that rounds its settings never reports what was asked
constexpr double kSameExposure = 0.05;  // relative difference between asked and reported that counts as in effect
constexpr int kFramesToComplain = 15;   // a second

}  // namespace

CeilingBrightness measure_brightness(const GreyView& image, double lamp_grey) {
  constexpr int kStep = 4;
  std::int64_t sum = 0;
  std::int64_t dark = 0;
  std::int64_t all = 0;
  for (int row = kStep / 2; row < image.height; row += kStep) {
    const auto* pixels = image.pixels.data() + static_cast<std::ptrdiff_t>(row) * image.width;
    for (int column = kStep / 2; column < image.width; column += kStep) {
      const int grey = pixels[column];
      const bool lamp = grey >= lamp_grey;
      sum += lamp ? 0 : grey;
      dark += lamp ? 0 : 1;
      ++all;
    }
  }
  if (all == 0) {
    return {};
  }
  const double lamp_share = 1.0 - static_cast<double>(dark) / static_cast<double>(all);
  if (lamp_share > kWhiteShare) {
    return {255.0, lamp_share};
  }
  return {static_cast<double>(sum) / static_cast<double>(dark), lamp_share};
}

ExposureControl::ExposureControl(const ExposureParams& params)
    : params_(params), setting_{params.initial_exposure_us, 1.0} {
  if (!(params.min_target > 0.0 && params.min_target < params.max_target && params.max_target < params.lamp_grey &&
        params.lamp_grey <= 255.0)) {
    throw std::invalid_argument("exposure: must be 0 < min_target < max_target < lamp_grey <= 255");
  }
  if (!(params.min_exposure_us > 0.0 && params.min_exposure_us <= params.max_exposure_us && params.max_gain >= 1.0 &&
        params.max_step > 1.0 && params.patience >= 1)) {
    throw std::invalid_argument(
        "exposure: must be 0 < min_exposure_us <= max_exposure_us, max_gain >= 1, max_step > 1, patience >= 1");
  }
  if (!(params.lit_target > 0.0 && params.lit_target <= 1.0 && params.lamp_memory >= 0)) {
    throw std::invalid_argument("exposure: must be 0 < lit_target <= 1, lamp_memory >= 0");
  }
  if (!(params.lamp_exposure > 0.0 && params.lamp_exposure < 1.0) ||
      (params.two_exposures && params.lit_target < 1.0)) {
    throw std::invalid_argument("exposure: must be 0 < lamp_exposure < 1, and lit_target 1 with two_exposures");
  }
  // A step that jumps across the dead band would swing for ever.
  if (params.max_step > 20.0) {
    throw std::invalid_argument("exposure: max_step must be at most 20");
  }
  setting_.exposure_us = std::clamp(setting_.exposure_us, params.min_exposure_us, params.max_exposure_us);
}

ExposureSetting ExposureControl::split(double product) const {
  const double exposure = std::clamp(product, params_.min_exposure_us, params_.max_exposure_us);
  return {exposure, std::clamp(product / exposure, 1.0, params_.max_gain)};
}

bool ExposureControl::shows_lamp(const CeilingBrightness& brightness) const {
  return brightness.lamp_share > params_.lamp_share && brightness.lamp_share <= kWhiteShare;
}

double ExposureControl::aim() {
  lamp_seen_ = shows_lamp(brightness_) ? params_.lamp_memory : std::max(0, lamp_seen_ - 1);
  return lamp_seen_ > 0 ? params_.lit_target : 1.0;
}

ExposureSetting ExposureControl::update(const GreyView& image, double exposure_us, double gain, double angular) {
  return update(measure_brightness(image, params_.lamp_grey), exposure_us, gain, angular);
}

ExposureSetting ExposureControl::update(const CeilingBrightness& brightness, double exposure_us, double gain,
                                        double angular) {
  brightness_ = brightness;
  const double mean = brightness_.mean;
  const double aimed = aim();
  const double min_target = aimed * params_.min_target;
  const double max_target = aimed * params_.max_target;
  const double product = exposure_us * gain;
  const double asked = setting_.exposure_us * setting_.gain;
  if (!settled_) {  // frames on their way were still taken with the setting before
    settled_ = std::abs(product - asked) <= kSameExposure * asked || ++waiting_ >= kLongestWait;
    if (!settled_) {
      return setting_;
    }
  }
  if (mean >= min_target && mean <= max_target) {
    out_of_range_ = 0;
    at_limit_ = 0;
    complaint_.clear();
    return setting_;
  }
  const bool blind = mean < min_target / kBlindFactor || mean > 0.5 * (params_.max_target + 255.0);
  if (std::abs(angular) > params_.turning_rate && !blind) {
    out_of_range_ = 0;
    return setting_;
  }
  if (++out_of_range_ < params_.patience) {
    return setting_;
  }
  out_of_range_ = 0;
  const double middle = 0.5 * (min_target + max_target);
  const double factor = std::clamp(middle / std::max(mean, 1.0), 1.0 / params_.max_step, params_.max_step);
  const ExposureSetting wanted = split((product > 0.0 ? product : asked) * factor);
  const double change = wanted.exposure_us * wanted.gain / asked;
  if (std::abs(change - 1.0) < 1e-3) {
    at_limit_ += params_.patience;
    if (at_limit_ >= kFramesToComplain) {
      complain(mean, aimed);
    }
    return setting_;
  }
  setting_ = wanted;
  settled_ = false;
  waiting_ = 0;
  return setting_;
}

void ExposureControl::complain(double mean, double aim) {
  char text[160];
  const bool dark = mean < aim * params_.min_target;
  std::snprintf(
      text, sizeof text,
      "too %s: ceiling at grey level %.0f, wanted %.0f to %.0f, with exposure %.0f us and gain %.1f at their limit",
      dark ? "dark" : "bright", mean, aim * params_.min_target, aim * params_.max_target, setting_.exposure_us,
      setting_.gain);
  complaint_ = text;
}

}  // namespace luminav
