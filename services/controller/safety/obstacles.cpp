#include "services/controller/safety/obstacles.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "services/common/geometry/vector_clones.hpp"

namespace luminav {
namespace {

using Longs = std::int64_t __attribute__((vector_size(kLanes * sizeof(std::int64_t))));
constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Bit i: squares[i] <= most, for 64 of them.
LUMINAV_VECTOR_CLONES
std::uint64_t at_most(const double* squares, double max) {
  Longs flag = {1, 2, 4, 8};
  Longs found{};
  for (std::size_t i = 0; i < 64; i += kLanes, flag <<= kLanes) {
    Doubles four;
    load(squares + i, four);
    found |= (four <= max) & flag;
  }
  return static_cast<std::uint64_t>(found[0] | found[1] | found[2] | found[3]);
}

}  // namespace

void Obstacles::set(std::span<const ObstaclePoint> measured, const PlanePoints& walls, std::size_t zones) {
  zones_ = zones;
  measured_.assign(measured.begin(), measured.end());
  points_.clear();
  points_.reserve(measured.size() + walls.size());
  for (const ObstaclePoint& obstacle : measured) {
    points_.add(obstacle.position);
  }
  points_.add(walls);
  measure();
}

Obstacles Obstacles::seen_from(const Pose2& there_from_here) const {
  const PointTransform transform(there_from_here);
  Obstacles seen = *this;
  seen.points_.clear();
  for (std::size_t i = 0; i < size(); ++i) {
    seen.points_.add(transform * points_[i]);
  }
  for (std::size_t i = 0; i < measured_.size(); ++i) {
    seen.measured_[i].position = seen.points_[i];
  }
  seen.measure();
  return seen;
}

void Obstacles::measure() {
  const std::size_t whole_blocks = (size() + kBlock - 1) / kBlock * kBlock;
  squared_from_box_.resize(whole_blocks);
  min_of_block_.resize(whole_blocks / kBlock);
  points_.fill_last_lanes();
  footprint_.measure_from_box(points_, squared_from_box_.data(), min_of_block_.data());
  std::fill(squared_from_box_.begin() + static_cast<std::ptrdiff_t>(size()), squared_from_box_.end(), kInfinite);
}

std::uint64_t Obstacles::within(std::size_t first, double squared) const {
  return at_most(squared_from_box_.data() + first, squared);
}

double Obstacles::min_distance(double max) const {
  if (points_.empty()) {
    return max;
  }
  const double nearest = std::sqrt(*std::min_element(min_of_block_.begin(), min_of_block_.end()));
  double min = max;
  visit_within(std::min(max, nearest + footprint_.max_inside_box()),
               [&](std::size_t i) { min = std::min(min, footprint_.distance(points_[i])); });
  return min;
}

double Obstacles::min_distance_ahead(double max) const {
  double min = max;
  visit_within(max, [&](std::size_t i) {
    if (points_[i].x() > 0.0) {
      min = std::min(min, footprint_.distance(points_[i]));
    }
  });
  return min;
}

template <class Counts>
double Obstacles::min_distance_of(double max, const Counts& counts) const {
  double min_squared = kInfinite;
  for (std::size_t i = 0; i < measured_.size(); ++i) {
    min_squared = counts(measured_[i]) ? std::min(min_squared, squared_from_box_[i]) : min_squared;
  }
  double min = max;
  visit_within(std::min(max, std::sqrt(min_squared) + footprint_.max_inside_box()), [&](std::size_t i) {
    if (i < measured_.size() && counts(measured_[i])) {
      min = std::min(min, footprint_.distance(points_[i]));
    }
  });
  return min;
}

double Obstacles::min_unknown_distance(double max) const {
  return min_distance_of(max, [](const ObstaclePoint& obstacle) { return !obstacle.is_known; });
}

double Obstacles::min_news_distance(double max) const {
  return min_distance_of(max, [](const ObstaclePoint& obstacle) { return !obstacle.is_known && !obstacle.has_stood; });
}

}  // namespace luminav
