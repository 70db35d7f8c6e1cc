#pragma once

#include <vector>

#include "drivers/simulator/geometry/random_stream.hpp"
#include "drivers/simulator/world/scene.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// How a sonar hears. An echo is heard when its strength (1 = a wall seen square on, at the disc) exceeds `threshold`.
struct SonarParams {
  int rays = 21;                     // over the cone
  double beam_sigma = radians(9.0);  // [rad] two-way beam pattern, a Gaussian
  double attenuation = 4.0;          // [m] over which an echo falls to 1/e
  double threshold = 0.12;
  double threshold_spread = 0.15;        // 1 sigma, fraction
  double specular_full = radians(15.0);  // [rad] incidence up to which a smooth wall sends all back
  double specular_none = radians(27.0);  // [rad] from here it sends all away
  double glass_full = radians(6.0);      // [rad]
  double glass_none = radians(10.0);     // [rad]
  double cloth = 0.55;                   // strength of a person
  double thin = 0.15;                    // strength of a leg
  double corner = 0.25;                  // strength of a box's corner
  double leg_heard = 0.4;                // probability that a pulse sees the legs of a chair or table at all
  double noise_near = 0.003;             // [m] 1 sigma at 0 m
  double noise_far = 0.010;              // [m] 1 sigma at the maximum range
  double dropout = 0.002;                // probability of no echo at all
  double crosstalk = 0.004;              // probability of hearing another disc's pulse
};

/// The sonar discs of the robot: a cone of rays each, specular walls, noise, dropouts, cross-talk. The figures are
/// those of Polaroid-type sonars on office walls: range noise 0.3 to 1 cm, loss beyond 15 to 25 degrees of incidence;
/// how often echoes are lost, or another disc's heard, is that of a real ring (tests/data/sonar_scitos_g5).
class SonarBeam {
 public:
  SonarBeam(const SonarRing& ring, std::uint64_t seed, const SonarParams& params = {});

  /// One pulse of a disc with the robot standing there: distance [m] from minimum to maximum range; the maximum when
  /// nothing was heard.
  double measure(const Scene& scene, const Pose2& world_from_robot, int disc);
  [[nodiscard]] int discs() const { return static_cast<int>(ring_.robot_from_sonar.size()); }

 private:
  [[nodiscard]] double echo_distance(const Scene& scene, const Pose2& world_from_sonar, double threshold);
  [[nodiscard]] double bounced_distance(const Scene& scene, const Pose2& world_from_sonar, double threshold) const;
  [[nodiscard]] double strength(double off_axis, double distance) const;
  [[nodiscard]] double reflection(Surface surface, double incidence) const;

  SonarRing ring_;
  SonarParams params_;
  RandomStream random_;
  std::vector<char> heard_;  // per hard obstacle
  std::vector<Edge> edges_;
};

}  // namespace luminav
