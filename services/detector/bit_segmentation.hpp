#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "services/common/image/grey_image.hpp"

namespace luminav {

struct BitSegmentationParams {
  int above = 200;        // [grey] pixels brighter than this belong to a blob ...
  int not_above = 30;     // [grey] ... and pixels up to this; -1 = none
  int opening = 2;        // [px] radius of the square of the opening, 0..15
  int least_pixels = 60;  // smaller blobs are left out
};

/// A connected part (8 neighbours) of the opened mask; coordinates are of pixel centres.
struct Blob {
  int pixels = 0;
  double x = 0.0;  // [px] centroid
  double y = 0.0;
  double theta = 0.0;  // [rad] main axis from the second moments, image frame (x right, y down), modulo pi
  // Smallest rectangle round the pixel centres.
  std::array<std::array<double, 2>, 4> corners{};  // [px] going round
  double length = 0.0;                             // [px] long side
  double width = 0.0;                              // [px]
  double rectangle_theta = 0.0;                    // [rad] of the long side, modulo pi
};

/// Two thresholds, opening, components, moments and rectangles with one bit per pixel: 64 pixels are eroded or dilated
/// by one instruction, and components are made of runs, so that their cost follows the outlines. Allocates nothing once
/// warm. Uses AVX2 where the processor has it.
class BitSegmentation {
 public:
  /// Blobs from the top; valid until the next call.
  const std::vector<Blob>& find(const GreyView& image, const BitSegmentationParams& params);

 private:
  using Word = std::uint64_t;
  struct BitRun {
    int row;
    int first;
    int last;
    int parent;  // of the union-find forest
    int next;    // of the same blob, -1 = none
  };
  struct Sums {
    std::int64_t count, x, y, xx, xy, yy;
    int head, tail;  // runs
  };
  void open(int radius, int width);
  void find_runs(int width, int height);
  int root(int run);
  void collect(int least_pixels);
  void measure(const Sums& sums, Blob& blob);
  void smallest_rectangle(Blob& blob) const;

  int words_ = 0;  // of a row, with one more to each side
  int rows_ = 0;
  std::vector<Word> mask_;
  std::vector<Word> work_;
  std::vector<BitRun> runs_;
  std::vector<Sums> sums_;  // per root run
  std::vector<std::array<int, 2>> left_;
  std::vector<std::array<int, 2>> right_;
  std::vector<std::array<int, 2>> hull_;
  std::vector<Blob> blobs_;
};

}  // namespace luminav
