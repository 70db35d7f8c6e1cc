#include "drivers/simulator/world/sonar_beam.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

using Eigen::Vector2d;

Vector2d direction_of(double theta) {
  return {std::cos(theta), std::sin(theta)};
}

double incidence_of(const Vector2d& direction, const Vector2d& normal) {
  return std::acos(std::clamp(-direction.dot(normal), -1.0, 1.0));
}

/// 1 up to `full`, falling to 0 at `none`.
double falling(double value, double full, double none) {
  return std::clamp((none - value) / (none - full), 0.0, 1.0);
}

}  // namespace

SonarBeam::SonarBeam(const SonarRing& ring, std::uint64_t seed, const SonarParams& params)
    : ring_(ring), params_(params), random_(seed, "sonar") {}

double SonarBeam::measure(const Scene& scene, const Pose2& world_from_robot, int disc) {
  const Pose2 world_from_sonar = world_from_robot * ring_.robot_from_sonar[static_cast<std::size_t>(disc)];
  heard_.resize(scene.hard_obstacles());
  for (char& heard : heard_) {
    heard = random_.happens(params_.leg_heard) ? 1 : 0;
  }
  const double threshold = params_.threshold * std::max(0.3, 1.0 + random_.gaussian(params_.threshold_spread));
  double range = echo_distance(scene, world_from_sonar, threshold);
  if (range >= ring_.maximum_range) {
    range = bounced_distance(scene, world_from_sonar, threshold);
  }
  const double noise = random_.gaussian(1.0);
  const bool dropped = random_.happens(params_.dropout);
  const bool disturbed = random_.happens(params_.crosstalk);
  const double other = random_.uniform();
  if (disturbed) {
    constexpr double kNearest = 0.3;  // [m]
    return kNearest + other * std::max(0.0, range - kNearest);
  }
  if (dropped || range >= ring_.maximum_range) {
    return ring_.maximum_range;
  }
  const double sigma = params_.noise_near + (params_.noise_far - params_.noise_near) * range / ring_.maximum_range;
  return std::clamp(range + sigma * noise, ring_.minimum_range, ring_.maximum_range);
}

double SonarBeam::echo_distance(const Scene& scene, const Pose2& world_from_sonar, double threshold) {
  const Vector2d origin = world_from_sonar.position();
  const double spacing = 2.0 * ring_.half_angle / params_.rays;
  const double shift = random_.uniform(0.0, spacing);  // so that nothing thin stays between the rays
  double nearest = ring_.maximum_range;
  for (int i = 0; i < params_.rays; ++i) {
    const double off_axis = -ring_.half_angle + i * spacing + shift;
    const Vector2d direction = direction_of(world_from_sonar.theta + off_axis);
    const auto hit = scene.cast_ray(origin, direction, nearest, heard_);
    if (hit && strength(off_axis, hit->distance) * reflection(hit->surface, incidence_of(direction, hit->normal)) >
                   threshold) {
      nearest = std::min(nearest, hit->distance);
    }
  }
  scene.edges_near(origin, nearest, edges_);
  for (const Edge& edge : edges_) {
    const Vector2d offset = edge.point - origin;
    const double distance = offset.norm();
    const double off_axis = wrap_angle(std::atan2(offset.y(), offset.x()) - world_from_sonar.theta);
    if (distance >= nearest || distance <= 0.0 || std::abs(off_axis) > ring_.half_angle ||
        params_.corner * strength(off_axis, distance) <= threshold) {
      continue;
    }
    constexpr double kBeforeCorner = 0.01;  // [m] the corner does not hide itself
    if (!scene.cast_ray(origin, offset / distance, distance - kBeforeCorner, heard_)) {
      nearest = distance;
    }
  }
  return nearest;
}

double SonarBeam::bounced_distance(const Scene& scene, const Pose2& world_from_sonar, double threshold) const {
  // A smooth wall seen obliquely is a mirror: the echo comes from what the mirror shows, and reads too long.
  const Vector2d origin = world_from_sonar.position();
  const Vector2d direction = direction_of(world_from_sonar.theta);
  const auto mirror = scene.cast_ray(origin, direction, ring_.maximum_range, heard_);
  if (!mirror || (mirror->surface != Surface::kSmooth && mirror->surface != Surface::kGlass)) {
    return ring_.maximum_range;
  }
  const Vector2d bounced = direction - 2.0 * direction.dot(mirror->normal) * mirror->normal;
  constexpr double kOffSurface = 0.02;  // [m] so that the ray does not start in the wall
  const Vector2d from = origin + (mirror->distance - kOffSurface) * direction;
  const auto hit = scene.cast_ray(from, bounced, ring_.maximum_range - mirror->distance, heard_);
  if (!hit) {
    return ring_.maximum_range;
  }
  const double total = mirror->distance + hit->distance;
  return strength(0.0, total) * reflection(hit->surface, incidence_of(bounced, hit->normal)) > threshold
             ? std::min(total, ring_.maximum_range)
             : ring_.maximum_range;
}

double SonarBeam::strength(double off_axis, double distance) const {
  const double angle = off_axis / params_.beam_sigma;
  return std::exp(-0.5 * angle * angle - distance / params_.attenuation);
}

double SonarBeam::reflection(Surface surface, double incidence) const {
  switch (surface) {
    case Surface::kSmooth:
      return falling(incidence, params_.specular_full, params_.specular_none);
    case Surface::kGlass:
      return falling(incidence, params_.glass_full, params_.glass_none);
    case Surface::kCloth:
      return params_.cloth * (0.4 + 0.6 * std::cos(incidence));
    case Surface::kThin:
      return params_.thin;
  }
  return 0.0;
}

}  // namespace luminav
