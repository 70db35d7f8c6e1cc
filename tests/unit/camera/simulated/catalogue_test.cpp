#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "drivers/camera/simulated/catalogue/clutter.hpp"
#include "drivers/camera/simulated/catalogue/luminaires.hpp"
#include "drivers/camera/simulated/renderer.hpp"
#include "drivers/camera/simulated/shapes.hpp"

namespace luminav::simulated {
namespace {

using Kind = LuminaireKind;

constexpr Kind kAll[] = {Kind::kPanel,     Kind::kLouvre,  Kind::kBatten,    Kind::kOpal,   Kind::kOpalFramed,
                         Kind::kPrismatic, Kind::kPendant, Kind::kDownlight, Kind::kHighBay};

Fixture fixture_of(Kind kind) {
  Fixture fixture;
  fixture.lamps = 2;
  if (kind == Kind::kDownlight || kind == Kind::kHighBay) {
    fixture.shape = FixtureShape::kRound;
    fixture.length = fixture.width = 0.35;
    fixture.lamps = 1;
  }
  return fixture;
}

/// Light of all parts: emission times area.
double light_of(const std::vector<Part>& parts) {
  return std::accumulate(parts.begin(), parts.end(), 0.0, [](double sum, const Part& part) {
    return sum + part.emission * part.half_length * part.half_width;
  });
}

TEST(Luminaires, EachKindShinesFullyHalfOrNotAtAll) {
  for (const Kind kind : kAll) {
    const Fixture fixture = fixture_of(kind);
    const double lit = light_of(parts_of(kind, fixture, LampState::kOn, 0.2));
    const double half = light_of(parts_of(kind, fixture, LampState::kHalf, 0.2));
    const double off = light_of(parts_of(kind, fixture, LampState::kOff, 0.2));
    EXPECT_GT(lit, 1.3 * half) << static_cast<int>(kind);
    EXPECT_GT(half, 0.0) << static_cast<int>(kind);
    EXPECT_EQ(off, 0.0) << static_cast<int>(kind);
  }
}

TEST(Luminaires, NothingSharpLiesBeyondTheOutlineAndItIsFilled) {
  for (const Kind kind : kAll) {
    const Fixture fixture = fixture_of(kind);
    for (const LampState state : {LampState::kOff, LampState::kHalf, LampState::kOn}) {
      double longest = 0.0;
      for (const Part& part : parts_of(kind, fixture, state, 0.2)) {
        if (part.softness > 0.03) {  // light and shade on the ceiling
          continue;
        }
        longest = std::max(longest, part.half_length);
        EXPECT_LE(std::abs(part.x) + part.half_length, 0.5 * fixture.length + 1e-9) << static_cast<int>(kind);
        EXPECT_LE(std::abs(part.y) + part.half_width, 0.5 * fixture.width + 1e-9) << static_cast<int>(kind);
      }
      EXPECT_NEAR(longest, 0.5 * fixture.length, 1e-9) << static_cast<int>(kind);
    }
  }
}

TEST(Luminaires, ALouvreHasATubeForEachLampAndHalfOfThemBurn) {
  for (const int lamps : {2, 3, 4}) {
    Fixture fixture = fixture_of(Kind::kLouvre);
    fixture.lamps = lamps;
    const auto burning = [&](LampState state) {
      const std::vector<Part> parts = parts_of(Kind::kLouvre, fixture, state, 0.2);
      return std::count_if(parts.begin(), parts.end(),
                           [](const Part& part) { return part.round && part.emission > 10.0; });
    };
    EXPECT_EQ(burning(LampState::kOn), lamps);
    EXPECT_EQ(burning(LampState::kHalf), (lamps + 1) / 2);
    EXPECT_EQ(burning(LampState::kOff), 0);
  }
}

TEST(Clutter, EachKindIsMadeOfSomethingWithinItsSize) {
  for (const UsualClutter& usual : usual_clutter()) {
    const std::vector<Part> parts = parts_of(usual.kind, usual.length, usual.width);
    EXPECT_FALSE(parts.empty()) << usual.name;
    for (const Part& part : parts) {
      EXPECT_GT(part.half_length, 0.0) << usual.name;
      EXPECT_GT(part.half_width, 0.0) << usual.name;
      EXPECT_LE(std::abs(part.x) + part.half_length, 0.5 * usual.length + 0.06) << usual.name;
    }
  }
}

/// Sum over a row of pixels 1 mm apart across the middle of a shape.
double painted_across(const Shape& shape) {
  constexpr int kCount = 400;
  std::vector<float> along(kCount, 0.0F);
  std::vector<float> across;
  std::vector<float> light(kCount, 1.0F);
  std::vector<float> brightness(kCount, 0.0F);
  for (int i = 0; i < kCount; ++i) {
    across.push_back(0.001F * static_cast<float>(i - kCount / 2));
  }
  paint(shape, {along.data(), across.data(), light.data(), brightness.data(), kCount});
  return 0.001 * std::accumulate(brightness.begin(), brightness.end(), 0.0);
}

TEST(Shapes, AThinOneGivesAsMuchLightAsItIsWideHoweverBlurred) {
  for (const bool round : {false, true}) {
    for (const float edge : {0.005F, 0.02F, 0.08F}) {
      const Shape line{.round = round,
                       .half_length = 0.6F,
                       .half_width = 0.013F,
                       .edge_along = edge,
                       .edge_across = edge,
                       .reflectance = 0.0F,
                       .emission = 1.0F};
      EXPECT_NEAR(painted_across(line), 0.026, 0.001) << round << " " << edge;
    }
  }
}

/// A ceiling with one luminaire above the robot.
CeilingModel model_of(Kind kind, const Fixture& fixture) {
  CeilingModel model;
  model.building.ceiling_height = 2.8;
  model.building.fixtures.push_back(fixture);
  model.mounting.z = 0.3;
  model.grey_noise = 0.0;
  model.luminaires = {kind};
  return model;
}

double grey_at(const GreyImage& image, int column, int row) {
  return image.pixels[static_cast<std::size_t>(row * image.width + column)];
}

TEST(CeilingRenderer, ALitLouvreShowsItsTubesApartAndAnUnlitOneDarkStripsBetweenBars) {
  CeilingRenderer renderer(model_of(Kind::kLouvre, fixture_of(Kind::kLouvre)));  // two tubes, along the picture's rows
  const TruePose below{};
  const auto picture = [&](LampState state, double exposure_us) {
    renderer.set_world(state == LampState::kOff ? 0.8 : 0.1, {state}, {});
    GreyImage image;
    renderer.render({.exposure_us = exposure_us}, std::span(&below, 1), image);
    return image;
  };
  // The robot's x is up in the picture: across the fixture goes along a row; a quarter of its width is 17 px.
  const GreyImage lit = picture(LampState::kOn, 2000.0);
  EXPECT_GT(grey_at(lit, 320 + 17, 240), 250.0);
  EXPECT_GT(grey_at(lit, 319 - 17, 240), 250.0);
  EXPECT_LT(grey_at(lit, 320, 240), 120.0);
  const GreyImage off = picture(LampState::kOff, 60000.0);
  EXPECT_GT(grey_at(off, 320, 240), 1.25 * grey_at(off, 320 + 10, 240));
  EXPECT_GT(grey_at(off, 320 + 60, 240), 1.5 * grey_at(off, 320 + 10, 240));
}

TEST(CeilingRenderer, WhatHangsLowHidesALamp) {
  CeilingModel model = model_of(Kind::kOpal, fixture_of(Kind::kOpal));
  CeilingRenderer bare(model);
  model.clutter.push_back({ClutterKind::kHead, {}, 0.5, 0.18, 1.7});
  CeilingRenderer hidden(model);
  const TruePose below{};
  GreyImage image;
  bare.render({}, std::span(&below, 1), image);
  EXPECT_EQ(grey_at(image, 320, 240), 255.0);
  hidden.render({}, std::span(&below, 1), image);
  EXPECT_LT(grey_at(image, 320, 240), 100.0);
}

}  // namespace
}  // namespace luminav::simulated
