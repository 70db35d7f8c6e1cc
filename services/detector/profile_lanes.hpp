#pragma once

#include <array>
#include <cstddef>

#include "services/common/image/grey_image.hpp"

namespace luminav {

/// Grey profiles along eight straight lines at once, one per lane: place by place, so that one instruction serves all.
/// Every lane gets the same arithmetic in the same order with and without vector instructions.
class ProfileLanes {
 public:
  static constexpr int kLanes = 8;
  static constexpr int kLongest = 64;  // [px]
  using Lanes = std::array<float, kLanes>;

  /// First place and step of each lane's line [px], and the index of its last place that is in view: what lies beyond
  /// is taken to be like that one.
  struct Lines {
    Lanes x, y, dx, dy;
    std::array<int, kLanes> last;
  };
  /// A step between two means.
  struct Steps {
    std::array<int, kLanes> at;    // index of the first pixel behind the largest one; -1: none
    Lanes before, height, behind;  // of the step there and at the places beside
  };

  void clear(int length);
  /// Adds the grey levels along further lines. All places up to `last` must be `is_sampled` within two pixels.
  void add(const GreyView& image, const Lines& lines);
  /// Largest difference of the means of `half_filter` pixels before and behind a place, those near the middle first.
  /// `weight`: sign and scale of the profile.
  [[nodiscard]] Steps largest_steps(int half_filter, float weight) const;
  void copy_lane(std::size_t lane, float* profile) const;

 private:
  int length_ = 0;
  alignas(32) std::array<Lanes, kLongest> grey_;
};

}  // namespace luminav
