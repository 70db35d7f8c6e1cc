#pragma once

namespace luminav {

enum class DetectorMode { kPaper, kModern };

/// The paper's chain: two thresholds, opening, contours, validation, moments and minimum-area rectangle.
struct PaperParams {
  double high_threshold = 235.0;    // [grey] a lit lamp is brighter than this ...
  double high_above_median = 60.0;  // [grey] ... and than the image's median plus this
  double low_threshold = 110.0;     // [grey] an unlit fixture is darker than this ...
  double low_below_median = 14.0;   // [grey] ... and than the image's median less this
  int opening_size = 3;             // [px] side of the square kernel
  int opening_iterations = 1;       // erosions, then as many dilations
  double canny_low = 50.0;          // [grey] hysteresis of the edge image
  double canny_high = 150.0;        // [grey]
  bool direct_contours = true;      // contours of the mask itself: Canny on it shifts centres by 0.15 px
  bool accept_cut = false;          // also what touches the image border, whose centre is then wrong
  double area_tolerance = 0.35;     // share that the area may deviate from length x width
  double length_tolerance = 0.15;   // share that the long side may deviate
  double width_tolerance = 0.25;    // share by which the width may miss [one lamp, two lamps]
  double bloom = 0.12;              // [m] that a lit fixture may look longer and wider
  double minimum_fill = 0.65;       // contour area / area of its minimum-area rectangle
  double half_lit_share = 0.80;     // below this share of lit pixels (and above its complement): half lit
  double position_sigma = 0.010;    // [m] of each axis: the paper gives no uncertainty
  double heading_sigma = 0.02;      // [rad]
};

/// Regions at several levels, guesses in metres, edges to sub-pixel through the lens model.
struct ModernDetectorParams {
  double lit_contrast = 22.0;      // [grey] least height of a lamp above its surroundings
  double unlit_contrast = 3.5;     // [grey] least depth of an unlit region, on a ceiling of about 100
  double lit_edge = 14.0;          // [grey] least step across the outline of a lamp
  double unlit_edge = 3.5;         // [grey] of an unlit fixture
  double size_tolerance = 0.16;    // share by which a side may miss the kind's: sizes within 10 %, heights within 5 %
  double max_bloom = 0.070;        // [m] by which light may widen a lamp on each side
  double min_visible = 0.30;       // share of a cut fixture's length that must be in the image
  double min_side_support = 0.75;  // share of a long side in view that must show its edge
  double min_end_support = 0.55;   // share of an end in view that must show its edge
  double edge_sigma_px = 0.15;     // [px] least error of one edge point
  double outline_sigma_px = 0.30;  // [px] error that all points of a side share
};

struct DetectorParams {
  DetectorMode mode = DetectorMode::kModern;
  PaperParams paper;
  ModernDetectorParams modern;
};

}  // namespace luminav
