#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>

#include "services/common/image/grey_image.hpp"

namespace luminav {

/// Grey levels across an edge, each the mean of three pixels along it.
struct EdgeMeans {
  static constexpr std::size_t kCount = 8;
  using Distances = std::array<double, kCount>;  // [px] outwards of the edge
  using Means = std::array<float, kCount>;
  struct Place {
    Eigen::Vector2d pixel;
    Eigen::Vector2d normal;  // outwards, of length 1
  };
};

/// The means at each place, which must be `is_sampled` at all distances with two pixels to spare.
void sample_edge_means(const GreyView& image, std::span<const EdgeMeans::Place> places,
                       const EdgeMeans::Distances& distances, EdgeMeans::Means* means);

}  // namespace luminav
