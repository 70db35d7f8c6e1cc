#include "drivers/camera/exposure_turns.hpp"

#include <algorithm>

namespace luminav {
namespace {

constexpr int kFrames = 3;        // taken for one before the other's turn; those on their way come on top
constexpr int kMaxWait = 15;      // [frames] for a device that is slow, or does not follow
constexpr int kMaxIgnored = 3;    // turns
constexpr double kDarker = 0.5;   // of the ceiling's grey level: less is a frame for lamps, also with a gamma of 2.2
constexpr double kShorter = 0.5;  // of the ceiling's exposure: where lamps can't have less than that, one is enough

}  // namespace

ExposureTurns::ExposureTurns(const ExposureParams& params)
    : params_(params), ceiling_(params), since_lamp_(params.lamp_memory) {}

double ExposureTurns::lamp_exposure_us() const {
  return std::max(params_.min_exposure_us, params_.lamp_exposure * ceiling_.setting().exposure_us);
}

ExposureSetting ExposureTurns::setting() const {
  const ExposureSetting& ceiling = ceiling_.setting();
  return turn_ == Turn::kLamps ? ExposureSetting{lamp_exposure_us(), ceiling.gain} : ceiling;
}

double ExposureTurns::exposure_of_last(double reported) const {
  const double ceiling = ceiling_.setting().exposure_us;
  const bool is_short = reported < kShorter * ceiling;
  if (turn_ == Turn::kCeiling || is_short == is_for_lamps_) {
    return reported;
  }
  return is_for_lamps_ ? lamp_exposure_us() : ceiling;
}

const std::string& ExposureTurns::complaint() const {
  return ceiling_.complaint().empty() ? complaint_ : ceiling_.complaint();
}

ExposureSetting ExposureTurns::update(const GreyView& image, double exposure_us, double gain, double angular) {
  const CeilingBrightness brightness = measure_brightness(image, params_.lamp_grey);
  is_for_lamps_ = turn_ != Turn::kCeiling && brightness.mean < kDarker * ceiling_mean_;
  ++waited_;
  ++since_lamp_;
  if (turn_ == Turn::kLamps) {
    taken_ += is_for_lamps_ ? 1 : 0;
    if (taken_ >= kFrames || waited_ >= kMaxWait) {
      end_lamps();
    }
  } else if (!is_for_lamps_ || waited_ >= kMaxWait) {
    if (turn_ == Turn::kBackToCeiling) {
      begin(Turn::kCeiling);
    }
    expose_ceiling(brightness, exposure_us, gain, angular);
  }
  return setting();
}

void ExposureTurns::begin(Turn turn) {
  turn_ = turn;
  waited_ = 0;
  taken_ = 0;
}

void ExposureTurns::expose_ceiling(const CeilingBrightness& brightness, double exposure_us, double gain,
                                   double angular) {
  ceiling_.update(brightness, exposure_us, gain, angular);
  ceiling_mean_ = brightness.mean;
  ++taken_;
  since_lamp_ = ceiling_.shows_lamp(brightness) ? 0 : since_lamp_;
  const bool are_lamps_wanted = params_.two_exposures && since_lamp_ < params_.lamp_memory && ignored_ < kMaxIgnored &&
                                lamp_exposure_us() < kShorter * ceiling_.setting().exposure_us;
  if (are_lamps_wanted && ceiling_.is_settled() && taken_ >= kFrames) {
    begin(Turn::kLamps);
  }
}

void ExposureTurns::end_lamps() {
  ignored_ = taken_ == 0 ? ignored_ + 1 : 0;
  if (ignored_ == kMaxIgnored) {
    complaint_ = "no picture for lamps gets darker: the camera does not follow, two_exposures has no effect";
  }
  begin(Turn::kBackToCeiling);
}

}  // namespace luminav
