#include "services/surveyor/survey/fixture_compass.hpp"

#include <cmath>
#include <complex>

namespace luminav {
namespace {

constexpr double kGain = 0.05;           // of what one sighting tells: a pass has some twenty
constexpr double kGate = radians(10.0);  // [rad] beyond which a fixture hangs askew

/// The sightings that tell a heading, by key frame.
std::vector<std::vector<const FixtureSighting*>> sightings_of(const std::vector<FixturePass>& passes,
                                                              std::size_t frames) {
  std::vector<std::vector<const FixtureSighting*>> by_frame(frames);
  for (const FixturePass& pass : passes) {
    for (const PassSighting& seen : pass.sightings) {
      if (seen.sighting.has_theta) {
        by_frame[static_cast<std::size_t>(seen.frame)].push_back(&seen.sighting);
      }
    }
  }
  return by_frame;
}

}  // namespace

std::vector<Pose2> hold_heading(const std::vector<Pose2>& path, const std::vector<FixturePass>& passes) {
  const auto by_frame = sightings_of(passes, path.size());
  std::vector<Pose2> held;
  std::complex<double> headings = 0.0;  // sum over all so far, modulo a quarter turn
  for (std::size_t i = 0; i < path.size(); ++i) {
    Pose2 pose = i == 0 ? path.front() : held.back() * (path[i - 1].inverse() * path[i]);
    for (const FixtureSighting* sighting : by_frame[i]) {
      const double heading = pose.theta + sighting->robot_from_fixture.theta;
      headings += std::polar(1.0, 4.0 * heading);
      const double askew = wrap_modulo(heading - 0.25 * std::arg(headings), 0.5 * kPi);
      if (std::abs(askew) < kGate) {
        pose.theta = wrap_angle(pose.theta - kGain * askew);
      }
    }
    held.push_back(pose);
  }
  return held;
}

}  // namespace luminav
