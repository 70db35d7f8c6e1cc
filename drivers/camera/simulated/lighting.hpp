#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "drivers/camera/simulated/truth.hpp"
#include "services/common/building/building.hpp"

namespace luminav::simulated {

/// State of all lamps and of the day. Brightness is relative: 1 = a white tile in a room with all its lamps on, which
/// is grey level 100 at the nominal exposure.
class CeilingLight {
 public:
  CeilingLight(const Building& building, std::uint64_t seed);

  /// Takes over what burns and how bright the day is; `lamps` in the order of the building's fixtures (else ignored).
  void set(double daylight, const std::vector<LampState>& lamps);
  [[nodiscard]] double daylight() const { return daylight_; }
  [[nodiscard]] LampState lamp(int fixture) const { return lamps_[static_cast<std::size_t>(fixture)]; }
  /// Share of its full light that a fixture gives at a time [us]: flickering ones go on and off several times a second.
  [[nodiscard]] double emission(int fixture, double utime) const;

  /// Collects what lights the ceiling around a place at a time [us]; `reach` [m] is the radius of what will be asked.
  void gather(const Eigen::Vector2d& centre, double reach, double utime);
  /// Light that falls on the ceiling at a point of the world; only within what was gathered.
  [[nodiscard]] double at(const Eigen::Vector2d& point) const;

 private:
  struct Lamp {
    double x;
    double y;
    double strength;
  };
  struct Daylight {
    double x;  // [m] of the window
    double y;  // [m]
    double cosine;
    double sine;
    double width;  // [m]
  };
  [[nodiscard]] double daylight_at(const Eigen::Vector2d& point) const;

  const Building& building_;
  std::uint64_t seed_;
  double daylight_ = 0.0;
  std::vector<LampState> lamps_;
  std::vector<Lamp> near_lamps_;
  std::vector<Daylight> near_windows_;
};

}  // namespace luminav::simulated
