#include "services/localizer/paper/pose_confidence.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

int views_until(PoseConfidence& confidence, const ViewEvidence& view, bool (PoseConfidence::*is_decided)() const) {
  int views = 0;
  while (!(confidence.*is_decided)() && views < 1000) {
    confidence.add(view);
    ++views;
  }
  return views;
}

TEST(PoseConfidence, AsksForMoreThanOneFixtureBeforeItIsSure) {
  PoseConfidence confidence{ConfidenceParams{}};
  const int views = views_until(confidence, {.fits = 1}, &PoseConfidence::is_sure);
  EXPECT_GE(views, 5);
  EXPECT_LE(views, 20);
}

TEST(PoseConfidence, WhatDoesNotFitRefutesAlsoAfterAnHourOfFits) {
  for (const ViewEvidence& view :
       {ViewEvidence{.misfits = 1}, ViewEvidence{.absent = 1}, ViewEvidence{.is_in_wall = true}}) {
    PoseConfidence confidence{ConfidenceParams{}};
    for (int i = 0; i < 10'000; ++i) {
      confidence.add({.fits = 1});
    }
    EXPECT_LE(views_until(confidence, view, &PoseConfidence::is_refuted), 10);
  }
}

TEST(PoseConfidence, OneOddViewRefutesNothing) {
  PoseConfidence confidence{ConfidenceParams{}};
  views_until(confidence, {.fits = 1}, &PoseConfidence::is_sure);
  confidence.add({.misfits = 1, .absent = 1});
  EXPECT_FALSE(confidence.is_refuted());
  EXPECT_FALSE(confidence.is_sure());
  EXPECT_LE(views_until(confidence, {.fits = 1}, &PoseConfidence::is_sure), 10);
}

}  // namespace
}  // namespace luminav
