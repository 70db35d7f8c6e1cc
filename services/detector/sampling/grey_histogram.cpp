#include "services/detector/sampling/grey_histogram.hpp"

#include <algorithm>
#include <numeric>

namespace luminav {

GreyHistogram::GreyHistogram(std::span<const std::uint8_t> cells, std::size_t step) {
  for (std::size_t i = 0; i < cells.size(); i += step) {
    ++counts_[cells[i]];
    ++total_;
  }
}

int GreyHistogram::median() const {
  int below = 0;
  for (std::size_t level = 0; level < counts_.size(); ++level) {
    below += counts_[level];
    if (2 * below >= total_) {
      return static_cast<int>(level);
    }
  }
  return 0;
}

double GreyHistogram::share_from(int level) const {
  const int count = std::accumulate(counts_.begin() + std::clamp(level, 0, 256), counts_.end(), 0);
  return static_cast<double>(count) / std::max(total_, 1);
}

double GreyHistogram::interpolated_median() const {
  const int level = median();
  const int below = std::accumulate(counts_.begin(), counts_.begin() + level, 0);
  const int here = std::max(counts_[static_cast<std::size_t>(level)], 1);
  return level - 0.5 + (0.5 * total_ - below) / here;
}

}  // namespace luminav
