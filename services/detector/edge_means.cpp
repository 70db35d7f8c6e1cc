#include "services/detector/edge_means.hpp"

#include <algorithm>

#include "services/common/geometry/vector_clones.hpp"
#include "services/detector/pixel_sampling.hpp"

namespace luminav {
namespace {

constexpr std::size_t kCount = EdgeMeans::kCount;
constexpr std::size_t kSamples = 3 * kCount;  // of a place
constexpr std::size_t kAtOnce = 8;            // places: no load waits for the parts that were just stored

LUMINAV_VECTOR_CLONES
void place_across(const EdgeMeans::Place& place, const double* distances, float* x, float* y) {
  const double pixel_x = place.pixel.x();
  const double pixel_y = place.pixel.y();
  const double normal_x = place.normal.x();
  const double normal_y = place.normal.y();
#pragma GCC ivdep
  for (std::size_t i = 0; i < kCount; ++i) {
    const double middle_x = pixel_x + distances[i] * normal_x;
    const double middle_y = pixel_y + distances[i] * normal_y;
    x[i] = static_cast<float>(middle_x + normal_y);
    y[i] = static_cast<float>(middle_y - normal_x);
    x[kCount + i] = static_cast<float>(middle_x);
    y[kCount + i] = static_cast<float>(middle_y);
    x[2 * kCount + i] = static_cast<float>(middle_x - normal_y);
    y[2 * kCount + i] = static_cast<float>(middle_y + normal_x);
  }
}

LUMINAV_VECTOR_CLONES
void average(const float* grey, float* mean) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < kCount; ++i) {
    mean[i] = (grey[i] + grey[kCount + i] + grey[2 * kCount + i]) / 3.0F;
  }
}

}  // namespace

void sample_edge_means(const GreyView& image, std::span<const EdgeMeans::Place> places,
                       const EdgeMeans::Distances& distances, EdgeMeans::Means* means) {
  alignas(32) std::array<float, kAtOnce * kSamples> x;
  alignas(32) std::array<float, kAtOnce * kSamples> y;
  alignas(32) std::array<float, kAtOnce * kSamples> grey;
  while (!places.empty()) {
    const std::size_t count = std::min(kAtOnce, places.size());
    for (std::size_t i = 0; i < count; ++i) {
      place_across(places[i], distances.data(), &x[i * kSamples], &y[i * kSamples]);
    }
    bilinear_at(image, x.data(), y.data(), count * kSamples, grey.data());
    for (std::size_t i = 0; i < count; ++i) {
      average(&grey[i * kSamples], (means++)->data());
    }
    places = places.subspan(count);
  }
}

}  // namespace luminav
