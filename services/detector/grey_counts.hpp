#pragma once

#include <cstddef>
#include <cstdint>

namespace luminav {

/// Some rows of an image.
struct GreyRows {
  const std::uint8_t* first;
  std::size_t count;  // in each row
  std::size_t rows;
  std::size_t apart;  // from one row to the next that counts
};

/// How many of `count` grey levels are not above `level`.
int count_up_to(const std::uint8_t* grey, std::size_t count, std::uint8_t level);
/// The same over the second, fifth, eighth, ... of each row.
int count_thirds_up_to(const GreyRows& rows, std::uint8_t level);

/// 0 of none.
std::uint8_t largest_of(const std::uint8_t* grey, std::size_t count);

/// The lowest of the levels 0 .. 255 for which `holds`, which then holds for all above; 255 when none does. Looks near
/// `guess` first: the image before was much the same, and counting is what costs.
template <typename Holds>
int median_level(int guess, Holds holds) {
  int below = -1;  // does not hold
  int at = 255;    // is taken to hold
  const bool down = holds(guess);
  (down ? at : below) = guess;
  for (int step = 1; below + 1 < at; step *= 2) {
    const int level = down ? at - step : below + step;
    if (level <= below || level >= at) {
      break;
    }
    const bool here = holds(level);
    (here ? at : below) = level;
    if (here != down) {
      break;
    }
  }
  while (below + 1 < at) {
    const int level = (below + at) / 2;
    (holds(level) ? at : below) = level;
  }
  return at;
}

}  // namespace luminav
