#include "drivers/camera/exposure_turns.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <stdexcept>
#include <vector>

namespace luminav {
namespace {

constexpr double kGreyPerMs = 12.5;  // of a ceiling that needs 8 ms

ExposureParams in_turn() {
  ExposureParams params;
  params.two_exposures = true;
  return params;
}

/// A camera that shows a setting so many frames after it was asked for, and reports it when it shows it or at once.
/// Below it a ceiling with a lamp that is white in pictures of the ceiling only.
class SlowCamera {
 public:
  SlowCamera(int delay, bool reports_at_once)
      : reports_at_once_(reports_at_once), settings_(static_cast<std::size_t>(delay + 1)) {}

  /// Takes a frame and gives it to the control.
  void expose(ExposureTurns& turns) {
    const ExposureSetting shown = settings_.front();
    const double grey = shown_light_ * kGreyPerMs * shown.exposure_us * shown.gain / 1000.0;
    GreyImage image{160, 120, std::vector<std::uint8_t>(160 * 120, static_cast<std::uint8_t>(std::min(255.0, grey)))};
    if (burns_) {
      std::fill_n(image.pixels.begin(), 400, static_cast<std::uint8_t>(std::min(255.0, 8.0 * grey)));
    }
    const double reported = (reports_at_once_ ? settings_.back() : shown).exposure_us;
    const ExposureSetting next = turns.update(image.view(), reported, shown.gain, 0.0);
    greys_.push_back(grey);
    is_label_right_ = is_label_right_ && std::abs(turns.exposure_of_last(reported) - shown.exposure_us) < 1e-9;
    settings_.pop_front();
    settings_.push_back(next);
  }
  void expose(ExposureTurns& turns, int frames) {
    for (int i = 0; i < frames; ++i) {
      expose(turns);
    }
  }
  [[nodiscard]] std::vector<double> greys_of_last(int frames) const { return {greys_.end() - frames, greys_.end()}; }

  double shown_light_ = 1.0;
  bool burns_ = true;
  bool is_label_right_ = true;

 private:
  bool reports_at_once_;
  std::deque<ExposureSetting> settings_;
  std::vector<double> greys_;
};

int dark_ones(const std::vector<double>& greys) {
  return static_cast<int>(std::count_if(greys.begin(), greys.end(), [](double grey) { return grey < 20.0; }));
}

TEST(ExposureTurns, WhileALampBurnsSomeFramesAreTakenForItWhateverTheDelayAndTheReport) {
  for (const int delay : {0, 1, 2, 3, 6}) {
    for (const bool reports_at_once : {false, true}) {
      ExposureTurns turns(in_turn());
      SlowCamera camera(delay, reports_at_once);
      camera.expose(turns, 120);
      const std::vector<double> greys = camera.greys_of_last(90);
      for (const double grey : greys) {
        EXPECT_TRUE(std::abs(grey - 100.0) < 1e-9 || std::abs(grey - 7.0) < 1e-9) << grey << ", delay " << delay;
      }
      EXPECT_NEAR(dark_ones(greys), 45, 10) << "delay " << delay;
      EXPECT_TRUE(camera.is_label_right_) << "delay " << delay << (reports_at_once ? ", reported at once" : "");
      EXPECT_EQ(turns.complaint(), "");
    }
  }
}

TEST(ExposureTurns, WhereNothingBurnsOrNobodyAskedForThemNoneAre) {
  ExposureTurns turns(in_turn());
  SlowCamera unlit(2, false);
  unlit.burns_ = false;
  unlit.expose(turns, 60);
  EXPECT_EQ(dark_ones(unlit.greys_of_last(60)), 0);
  ExposureTurns one(ExposureParams{});
  SlowCamera lit(2, false);
  lit.expose(one, 60);
  EXPECT_EQ(dark_ones(lit.greys_of_last(60)), 0);
}

TEST(ExposureTurns, TheCeilingStaysInRangeWhenTheLightChanges) {
  for (const double light : {0.4, 2.0}) {
    ExposureTurns turns(in_turn());
    SlowCamera camera(2, true);
    camera.expose(turns, 60);
    camera.shown_light_ = light;
    camera.expose(turns, 150);
    const std::vector<double> greys = camera.greys_of_last(40);
    EXPECT_GE(*std::max_element(greys.begin(), greys.end()), 80.0);
    EXPECT_LE(*std::max_element(greys.begin(), greys.end()), 120.0);
  }
}

TEST(ExposureTurns, GoesOnWithoutThemWhenTheLampGoesOut) {
  ExposureTurns turns(in_turn());
  SlowCamera camera(2, true);
  camera.expose(turns, 60);
  camera.burns_ = false;
  camera.shown_light_ = 0.3;
  camera.expose(turns, 250);
  const std::vector<double> greys = camera.greys_of_last(60);
  EXPECT_GE(*std::min_element(greys.begin(), greys.end()), 80.0);
}

TEST(ExposureTurns, SaysThatADeviceDoesNotFollowAndGivesUp) {
  ExposureTurns turns(in_turn());
  GreyImage image{160, 120, std::vector<std::uint8_t>(160 * 120, 100)};
  std::fill_n(image.pixels.begin(), 400, std::uint8_t{255});
  for (int i = 0; i < 100; ++i) {
    turns.update(image.view(), 8000.0, 1.0, 0.0);
  }
  EXPECT_NE(turns.complaint(), "");
  EXPECT_EQ(turns.setting().exposure_us, 8000.0);
}

TEST(ExposureTurns, TakesNoneWhereTheShortestExposureIsTheCeilings) {
  ExposureParams params = in_turn();
  params.min_exposure_us = 6000.0;
  ExposureTurns turns(params);
  SlowCamera camera(2, false);
  camera.expose(turns, 60);
  EXPECT_EQ(dark_ones(camera.greys_of_last(60)), 0);
  EXPECT_EQ(turns.complaint(), "");
}

TEST(ExposureTurns, RefusesOneLowAimBesides) {
  ExposureParams params = in_turn();
  params.lit_target = 0.4;
  EXPECT_THROW(ExposureTurns{params}, std::invalid_argument);
}

}  // namespace
}  // namespace luminav
