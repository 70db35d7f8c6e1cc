#include "drivers/camera/exposure_control.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

namespace luminav {
namespace {

/// A ceiling of one brightness and, if wanted, a white lamp over a share of the rows.
GreyImage picture(double ceiling_grey, double lamp_share = 0.0) {
  GreyImage image{160, 120, {}};
  image.pixels.assign(160 * 120, static_cast<std::uint8_t>(std::clamp(ceiling_grey, 0.0, 255.0)));
  std::fill_n(image.pixels.begin(), static_cast<std::ptrdiff_t>(lamp_share * 160 * 120), std::uint8_t{255});
  return image;
}

/// A camera whose grey level is proportional to exposure and gain, with settings that take effect two frames later.
class LinearCamera {
 public:
  explicit LinearCamera(double grey_per_ms) : grey_per_ms_(grey_per_ms) {}
  double grey_per_ms_;

  const ExposureSetting& expose(ExposureControl& control, double angular = 0.0, double lamp_share = 0.0) {
    const double grey = grey_per_ms_ * in_effect_.exposure_us * in_effect_.gain / 1000.0;
    control.update(picture(grey, lamp_share).view(), in_effect_.exposure_us, in_effect_.gain, angular);
    in_effect_ = on_its_way_;
    on_its_way_ = control.setting();
    return in_effect_;
  }
  [[nodiscard]] double grey() const { return grey_per_ms_ * in_effect_.exposure_us * in_effect_.gain / 1000.0; }

 private:
  ExposureSetting in_effect_;
  ExposureSetting on_its_way_;
};

TEST(MeasureBrightness, IsTheMeanOfWhatIsNoLamp) {
  const CeilingBrightness brightness = measure_brightness(picture(90.0, 0.2).view(), 225.0);
  EXPECT_DOUBLE_EQ(brightness.mean, 90.0);
  EXPECT_NEAR(brightness.lamp_share, 0.2, 1e-9);
}

TEST(MeasureBrightness, AllWhiteIsOverexposedAndNotFullOfLamps) {
  EXPECT_DOUBLE_EQ(measure_brightness(picture(255.0).view(), 225.0).mean, 255.0);
  EXPECT_DOUBLE_EQ(measure_brightness(picture(50.0, 0.7).view(), 225.0).mean, 255.0);
}

TEST(MeasureBrightness, OfAnEmptyPictureIsZero) {
  EXPECT_DOUBLE_EQ(measure_brightness(GreyImage{}.view(), 225.0).mean, 0.0);
}

TEST(ExposureControl, DoesNothingWithinTheRange) {
  ExposureControl control({});
  for (const double grey : {80.0, 100.0, 120.0}) {
    for (int i = 0; i < 10; ++i) {
      EXPECT_EQ(control.update(picture(grey).view(), 8000.0, 1.0, 0.0), (ExposureSetting{8000.0, 1.0}));
    }
  }
}

TEST(ExposureControl, ReachesTheRangeFromDarkAndFromBright) {
  for (const double grey_per_ms : {2.0, 5.0, 12.5, 60.0, 300.0}) {
    LinearCamera camera(grey_per_ms);
    ExposureControl control({});
    for (int i = 0; i < 150; ++i) {
      camera.expose(control);
    }
    EXPECT_GE(camera.grey(), 80.0) << grey_per_ms;
    EXPECT_LE(camera.grey(), 120.0) << grey_per_ms;
    EXPECT_EQ(control.complaint(), "");
  }
}

TEST(ExposureControl, StaysPutOnceInTheRange) {
  LinearCamera camera(3.0);
  ExposureControl control({});
  for (int i = 0; i < 150; ++i) {
    camera.expose(control);
  }
  const ExposureSetting reached = control.setting();
  for (int i = 0; i < 100; ++i) {
    camera.expose(control);
    EXPECT_EQ(control.setting(), reached);
  }
}

TEST(ExposureControl, NeverStepsFartherThanTheLimit) {
  LinearCamera camera(0.5);
  ExposureParams params;
  ExposureControl control(params);
  double last = control.setting().exposure_us * control.setting().gain;
  for (int i = 0; i < 200; ++i) {
    camera.expose(control);
    const double now = control.setting().exposure_us * control.setting().gain;
    EXPECT_LE(now / last, params.max_step * 1.0001);
    EXPECT_GE(now / last, 1.0 / params.max_step / 1.0001);
    last = now;
  }
}

TEST(ExposureControl, TakesGainOnlyWhenTheExposureIsAtItsLongest) {
  LinearCamera camera(1.0);
  ExposureParams params;
  ExposureControl control(params);
  for (int i = 0; i < 200; ++i) {
    camera.expose(control);
    EXPECT_TRUE(control.setting().gain == 1.0 || control.setting().exposure_us == params.max_exposure_us);
  }
  EXPECT_GT(control.setting().gain, 3.9);  // 80 grey levels at 20 ms need a gain of 4
}

TEST(ExposureControl, AimsLowerWhileALampIsInViewAndForAWhileAfter) {
  LinearCamera camera(12.5);
  ExposureParams params;
  params.lit_target = 0.25;
  ExposureControl control(params);
  for (int i = 0; i < 60; ++i) {
    camera.expose(control, 0.0, 0.02);
  }
  EXPECT_GE(camera.grey(), 20.0);
  EXPECT_LE(camera.grey(), 30.0);
  const ExposureSetting low = control.setting();
  for (int i = 0; i < params.lamp_memory - 1; ++i) {
    camera.expose(control);
    EXPECT_EQ(control.setting(), low);
  }
  for (int i = 0; i < 60; ++i) {
    camera.expose(control);
  }
  EXPECT_GE(camera.grey(), 80.0);
  EXPECT_LE(camera.grey(), 120.0);
}

TEST(ExposureControl, APictureThatIsMostlyWhiteIsNoReasonToAimLower) {
  LinearCamera camera(60.0);
  ExposureParams params;
  params.lit_target = 0.25;
  ExposureControl control(params);
  for (int i = 0; i < 100; ++i) {
    camera.expose(control);  // white at first
  }
  for (int i = 0; i < params.lamp_memory; ++i) {
    camera.expose(control);
  }
  EXPECT_GE(camera.grey(), 80.0);
}

TEST(ExposureControl, WithOneAimForAllALampThatEntersTheViewChangesNothing) {
  LinearCamera camera(12.5);
  ExposureParams params;
  params.lit_target = 1.0;
  ExposureControl control(params);
  for (int i = 0; i < 60; ++i) {
    camera.expose(control, 0.0, i < 20 ? 0.0 : 0.4);
    EXPECT_EQ(control.setting(), (ExposureSetting{8000.0, 1.0}));
  }
}

TEST(ExposureControl, HoldsWhileTurningAndCatchesUpAfterwards) {
  LinearCamera camera(7.5);  // grey level 60: too dark, but things can be seen
  ExposureControl control({});
  for (int i = 0; i < 60; ++i) {
    camera.expose(control, 0.5);
    EXPECT_EQ(control.setting(), (ExposureSetting{8000.0, 1.0}));
  }
  for (int i = 0; i < 60; ++i) {
    camera.expose(control, 0.0);
  }
  EXPECT_GE(camera.grey(), 80.0);
}

TEST(ExposureControl, EvenWhileTurningAPictureWithNothingInItIsPutRight) {
  for (const double grey_per_ms : {1.5, 100.0}) {
    LinearCamera camera(grey_per_ms);
    ExposureControl control({});
    for (int i = 0; i < 100; ++i) {
      camera.expose(control, 1.0);
    }
    EXPECT_GT(camera.grey(), 30.0);
    EXPECT_LT(camera.grey(), 200.0);
  }
}

TEST(ExposureControl, OneDarkFrameIsNoReason) {
  ExposureControl control({});
  for (int i = 0; i < 20; ++i) {
    control.update(picture(i % 3 == 0 ? 20.0 : 100.0).view(), 8000.0, 1.0, 0.0);
    EXPECT_EQ(control.setting(), (ExposureSetting{8000.0, 1.0}));
  }
}

TEST(ExposureControl, WaitsUntilItsSettingIsInEffect) {
  ExposureControl control({});
  for (int i = 0; i < 3; ++i) {
    control.update(picture(40.0).view(), 8000.0, 1.0, 0.0);
  }
  const ExposureSetting first = control.setting();
  EXPECT_GT(first.exposure_us, 8000.0);
  for (int i = 0; i < 6; ++i) {  // frames that were still on their way
    control.update(picture(40.0).view(), 8000.0, 1.0, 0.0);
    EXPECT_EQ(control.setting(), first);
  }
}

TEST(ExposureControl, SaysWhenTheRangeCannotBeMetAndWhenItCanAgain) {
  LinearCamera camera(0.1);
  ExposureControl control({});
  for (int i = 0; i < 200; ++i) {
    camera.expose(control);
  }
  EXPECT_NE(control.complaint().find("too dark"), std::string::npos) << control.complaint();
  camera.grey_per_ms_ = 2.0;
  for (int i = 0; i < 100; ++i) {
    camera.expose(control);
  }
  EXPECT_EQ(control.complaint(), "");
  camera.grey_per_ms_ = 5000.0;
  for (int i = 0; i < 300; ++i) {
    camera.expose(control);
  }
  EXPECT_NE(control.complaint().find("too bright"), std::string::npos) << control.complaint();
}

TEST(ExposureControl, RefusesParametersThatContradictEachOther) {
  ExposureParams crossed;
  crossed.min_target = 130.0;
  EXPECT_THROW(ExposureControl{crossed}, std::invalid_argument);
  ExposureParams backwards;
  backwards.min_exposure_us = 1e6;
  EXPECT_THROW(ExposureControl{backwards}, std::invalid_argument);
  ExposureParams stuck;
  stuck.max_step = 1.0;
  EXPECT_THROW(ExposureControl{stuck}, std::invalid_argument);
}

}  // namespace
}  // namespace luminav
