#pragma once

#include <cstdint>
#include <optional>

namespace luminav {

/// The occupied ones of the cells round a middle one, and how the surface lies that they form. Columns and rows count
/// from the middle, from -kReach to kReach.
class SurfacePatch {
 public:
  static constexpr int kReach = 3;  ///< [cells]

  void add(int columns, int rows);
  /// Those of the cells that hang together with the middle one, by sides or corners.
  [[nodiscard]] SurfacePatch connected_to_middle() const;
  /// Direction [rad] (-pi/2, pi/2] of the straight thin surface that the cells form; nothing where they form none.
  [[nodiscard]] std::optional<double> direction() const;

 private:
  // eight bits to a row, of which the last is always empty: nothing is carried from row to row
  static constexpr int kRow = 2 * kReach + 2;
  static_assert(kRow * (2 * kReach + 1) <= 64);

  std::uint64_t cells_ = 0;
};

}  // namespace luminav
