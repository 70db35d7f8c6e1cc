#include "drivers/camera/simulated/lighting.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/camera/simulated/random.hpp"

namespace luminav::simulated {
namespace {

constexpr std::uint64_t kFlickerPurpose = 2;

// Light on the ceiling, in units of a tile in a fully lit room. Ratios as between 400 lux by lamps and daylight
// factors of some per cent; the shapes by eye.
constexpr double kNight = 0.004;  // what is left with everything dark: displays, street lights
constexpr double kDaylightEverywhere = 0.15;
constexpr double kDaylightAtWindow = 1.6;  // full day, at the window
constexpr double kGlare = 4.0;             // full day, where sun comes back from the sill
constexpr double kGlareDepth = 0.35;       // [m] from the window
constexpr double kWindowDepth = 1.5;       // [m] to a half
constexpr double kWindowReach = 8.0;       // [m]

// A lamp lights the ceiling around it by way of the floor. A 2.4 x 3.6 m pattern of 1.2 x 0.3 m fixtures adds up to 1:
// strength * pi * kLampSpread^2 = 2.4 * 3.6.
constexpr double kLampSpread = 2.0;  // [m]
constexpr double kLampStrength = 0.69;
constexpr double kLampReach = 9.0;       // [m] beyond it a lamp adds less than 0.2 %
constexpr double kLampArea = 1.2 * 0.3;  // [m^2]

}  // namespace

CeilingLight::CeilingLight(const Building& building, std::uint64_t seed)
    : building_(building), seed_(seed), lamps_(building.fixtures.size(), LampState::kOn) {}

void CeilingLight::set(double daylight, const std::vector<LampState>& lamps) {
  daylight_ = std::clamp(daylight, 0.0, 1.0);
  if (lamps.size() == lamps_.size()) {
    lamps_ = lamps;
  }
}

double CeilingLight::emission(int fixture, double utime) const {
  switch (lamp(fixture)) {
    case LampState::kOff:
      return 0.0;
    case LampState::kOn:
      return 1.0;
    case LampState::kHalf:
      return 0.5;
    case LampState::kFlicker:
      break;
  }
  SplitMix random = random_stream(seed_, kFlickerPurpose, static_cast<std::uint64_t>(fixture));
  const double frequency = random.uniform(4.0, 9.0);  // [Hz] of a tube that does not start
  const double phase = random.uniform();
  const double cycle = utime * 1e-6 * frequency + phase;
  return cycle - std::floor(cycle) < 0.5 ? 1.0 : 0.0;
}

void CeilingLight::gather(const Eigen::Vector2d& centre, double reach, double utime) {
  near_lamps_.clear();
  for (std::size_t i = 0; i < building_.fixtures.size(); ++i) {
    const Fixture& fixture = building_.fixtures[i];
    if ((fixture.world_from_fixture.position() - centre).norm() > reach + kLampReach) {
      continue;
    }
    const double strength = emission(static_cast<int>(i), utime) * kLampStrength *
                            std::clamp(fixture.length * fixture.width / kLampArea, 0.25, 3.0);
    if (strength > 0.0) {
      near_lamps_.push_back({fixture.world_from_fixture.x, fixture.world_from_fixture.y, strength});
    }
  }
  near_windows_.clear();
  for (const Window& window : building_.windows) {
    const Pose2& pose = window.world_from_window;
    if ((pose.position() - centre).norm() <= reach + kWindowReach) {
      near_windows_.push_back({pose.x, pose.y, std::cos(pose.theta), std::sin(pose.theta), window.width});
    }
  }
}

double CeilingLight::daylight_at(const Eigen::Vector2d& point) const {
  double light = kDaylightEverywhere;
  for (const Daylight& window : near_windows_) {
    const double dx = point.x() - window.x;
    const double dy = point.y() - window.y;
    const double along = window.cosine * dx + window.sine * dy;  // into the room
    const double inward = std::max(0.0, along);
    const double inside = 1.0 / (1.0 + std::exp(-12.0 * along));  // hardly any on the other side of the wall
    const double aside = (window.cosine * dy - window.sine * dx) / (0.5 * window.width + 0.4 * (1.0 + inward));
    const double lateral = 1.0 / (1.0 + aside * aside * aside * aside);
    const double depth = 1.0 / (1.0 + (inward / kWindowDepth) * (inward / kWindowDepth));
    const double glare = std::exp(-(inward / kGlareDepth) * (inward / kGlareDepth)) * daylight_ * daylight_;
    light += inside * lateral * (kDaylightAtWindow * depth + kGlare * glare);
  }
  return daylight_ * light;
}

double CeilingLight::at(const Eigen::Vector2d& point) const {
  double light = kNight + daylight_at(point);
  for (const Lamp& lamp : near_lamps_) {
    const double dx = point.x() - lamp.x;
    const double dy = point.y() - lamp.y;
    const double fall = 1.0 + (dx * dx + dy * dy) / (kLampSpread * kLampSpread);
    light += lamp.strength / (fall * fall);
  }
  return light;
}

}  // namespace luminav::simulated
