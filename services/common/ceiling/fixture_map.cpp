#include "services/common/ceiling/fixture_map.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kSameThing = 0.6;         // [m] a thing seen again within it is the same
constexpr std::size_t kMaxStrangers = 64;  // remembered

}  // namespace

FixtureMap::FixtureMap(std::vector<Fixture> fixtures, double cell) : fixtures_(std::move(fixtures)), cell_(cell) {
  if (fixtures_.empty()) {
    return;
  }
  const Eigen::AlignedBox2d box = extent();
  // a fixture somebody put at 1e6 must not cost the memory of all cells between
  cell_ = std::max(cell_, box.sizes().maxCoeff() / 1000.0);
  origin_ = box.min();
  columns_ = static_cast<int>(box.sizes().x() / cell_) + 1;
  rows_ = static_cast<int>(box.sizes().y() / cell_) + 1;
  std::vector<std::size_t> cell_of;
  for (const Fixture& fixture : fixtures_) {
    const Eigen::Vector2d offset = fixture.world_from_fixture.position() - origin_;
    cell_of.push_back(cell_index(static_cast<int>(offset.x() / cell_), static_cast<int>(offset.y() / cell_)));
  }
  cell_start_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  for (const std::size_t index : cell_of) {
    ++cell_start_[index + 1];
  }
  for (std::size_t i = 1; i < cell_start_.size(); ++i) {
    cell_start_[i] += cell_start_[i - 1];
  }
  members_.resize(fixtures_.size());
  std::vector<int> next(cell_start_.begin(), cell_start_.end() - 1);
  for (std::size_t i = 0; i < fixtures_.size(); ++i) {
    members_[static_cast<std::size_t>(next[cell_of[i]]++)] = static_cast<int>(i);
  }
  for (std::size_t i = 0; i < fixtures_.size(); ++i) {
    for (const int j : near(fixtures_[i].world_from_fixture.position(), std::min(smallest_spacing_, 20.0))) {
      if (j != static_cast<int>(i)) {
        smallest_spacing_ =
            std::min(smallest_spacing_, distance(fixtures_[i].world_from_fixture, (*this)[j].world_from_fixture));
      }
    }
  }
}

Eigen::AlignedBox2d FixtureMap::extent() const {
  Eigen::AlignedBox2d box;
  for (const Fixture& fixture : fixtures_) {
    box.extend(fixture.world_from_fixture.position());
  }
  return box;
}

std::size_t FixtureMap::cell_index(int column, int row) const {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
}

std::vector<int> FixtureMap::near(const Eigen::Vector2d& point_in_world, double radius) const {
  std::vector<int> found;
  if (fixtures_.empty() || !point_in_world.allFinite()) {
    return found;
  }
  const Eigen::Vector2d offset = (point_in_world - origin_).cwiseMax(-1e6).cwiseMin(1e6);
  const int first_column = std::max(0, static_cast<int>(std::floor((offset.x() - radius) / cell_)));
  const int last_column = std::min(columns_ - 1, static_cast<int>(std::floor((offset.x() + radius) / cell_)));
  const int first_row = std::max(0, static_cast<int>(std::floor((offset.y() - radius) / cell_)));
  const int last_row = std::min(rows_ - 1, static_cast<int>(std::floor((offset.y() + radius) / cell_)));
  for (int row = first_row; row <= last_row; ++row) {
    for (int column = first_column; column <= last_column; ++column) {
      const std::size_t cell = cell_index(column, row);
      for (int i = cell_start_[cell]; i < cell_start_[cell + 1]; ++i) {
        const int index = members_[static_cast<std::size_t>(i)];
        if ((fixtures_[static_cast<std::size_t>(index)].world_from_fixture.position() - point_in_world).squaredNorm() <=
            radius * radius) {
          found.push_back(index);
        }
      }
    }
  }
  return found;
}

void FixtureMap::add_stranger(const Eigen::Vector2d& place) {
  if (is_stranger(place)) {
    return;
  }
  strangers_.push_back(place);
  if (strangers_.size() > kMaxStrangers) {
    strangers_.pop_front();
  }
}

bool FixtureMap::is_stranger(const Eigen::Vector2d& place) const {
  return std::any_of(strangers_.begin(), strangers_.end(),
                     [&](const Eigen::Vector2d& known) { return (known - place).norm() < kSameThing; });
}

bool fits_kind_and_size(const FixtureSighting& sighting, const Fixture& fixture, const KindGate& gate) {
  const double length_tolerance = gate.length_tolerance + gate.relative * fixture.length;
  // of a half-lit fixture only one tube may be seen
  const double max_narrower = gate.width_tolerance + gate.relative * fixture.width +
                              (sighting.state == SightingState::kHalf ? 0.5 * fixture.width : 0.0);
  const double max_wider = max_narrower + (sighting.state == SightingState::kLit ? gate.bloom : 0.0);
  if (sighting.clipped) {
    // what the border leaves of a rectangle may look like a square or lie across: only its sides' upper bounds count;
    // and a burning fixture of one tube like one of two that burns by half
    const double min_width = (sighting.state == SightingState::kHalf ? 0.5 : 1.0) * sighting.width;
    return sighting.shape == FixtureShape::kRound
               ? fixture.shape == FixtureShape::kRound
               : sighting.length <= fixture.length + length_tolerance && min_width <= fixture.width + max_wider;
  }
  return sighting.shape == fixture.shape && std::abs(sighting.length - fixture.length) <= length_tolerance &&
         sighting.width >= fixture.width - max_narrower && sighting.width <= fixture.width + max_wider;
}

}  // namespace luminav
