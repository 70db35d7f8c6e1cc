#pragma once

#include <Eigen/Geometry>
#include <deque>
#include <set>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/ceiling/fixture_sighting.hpp"

namespace luminav {

/// How far a sighting's kind and size may be from a fixture's.
struct KindGate {
  double length_tolerance = 0.15;  // [m]
  double width_tolerance = 0.05;   // [m]
  double relative = 0.10;          // fraction of the side, added to the tolerances
  double bloom = 0.06;             // [m] that a burning lamp may look wider beyond, most in dark rooms: long exposure
};

/// The building's fixtures with an index by place: asking costs what lies near, not what the building has. And what a
/// known pose taught about their file, by which all poses are judged: a doubt of a fixture is none of the pose.
class FixtureMap {
 public:
  static constexpr double kMaxOffset = 0.6;  // [m] a fixture that hangs elsewhere is looked for within it

  explicit FixtureMap(std::vector<Fixture> fixtures, double cell = 3.0);

  [[nodiscard]] const std::vector<Fixture>& fixtures() const { return fixtures_; }
  [[nodiscard]] const Fixture& operator[](int index) const { return fixtures_[static_cast<std::size_t>(index)]; }
  [[nodiscard]] int size() const { return static_cast<int>(fixtures_.size()); }
  /// Indices of the fixtures whose centre lies within `radius` [m] of a point of the world.
  [[nodiscard]] std::vector<int> near(const Eigen::Vector2d& point_in_world, double radius) const;
  /// The smallest box around their centres [m]; empty without any.
  [[nodiscard]] Eigen::AlignedBox2d extent() const;
  /// The smallest distance [m] between two fixtures' centres; 1e9 with fewer than two.
  [[nodiscard]] double smallest_spacing() const { return smallest_spacing_; }

  /// It was missed, or seen elsewhere, though the pose was right (moved, dead or gone): that it is not seen says
  /// nothing any more.
  void doubt(int index) { doubted_.insert(index); }
  [[nodiscard]] bool is_doubted(int index) const { return doubted_.count(index) > 0; }
  /// How far one in doubt may hang from where the file has it: 0.3 m and 10 degrees, 1-sigma. [m^2, m^2, rad^2]
  [[nodiscard]] static Eigen::Vector3d doubt_variance() { return {0.09, 0.09, 0.03}; }
  /// Indices of the fixtures in doubt.
  [[nodiscard]] const std::set<int>& doubted() const { return doubted_; }
  /// Something is seen there [world] that no fixture explains, and the pose is right.
  void add_stranger(const Eigen::Vector2d& place);
  /// What is seen there is known to be no fixture, or one that hangs elsewhere than the file says.
  [[nodiscard]] bool is_stranger(const Eigen::Vector2d& place) const;
  /// Of both kinds.
  [[nodiscard]] std::size_t doubts() const { return doubted_.size() + strangers_.size(); }

 private:
  [[nodiscard]] std::size_t cell_index(int column, int row) const;

  std::vector<Fixture> fixtures_;
  double cell_;  // [m]
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int columns_ = 0;
  int rows_ = 0;
  std::vector<int> cell_start_;  // CSR: fixtures of cell i are members_[cell_start_[i] .. cell_start_[i + 1])
  std::vector<int> members_;
  double smallest_spacing_ = 1e9;
  std::set<int> doubted_;
  std::deque<Eigen::Vector2d> strangers_;  // [world] oldest first
};

/// False when a sighting cannot be that fixture for its shape or size.
[[nodiscard]] bool fits_kind_and_size(const FixtureSighting& sighting, const Fixture& fixture, const KindGate& gate);

}  // namespace luminav
