#pragma once

#include <cstddef>
#include <cstdint>

// Plain loops over arrays of float, eight particles at a time. The source is compiled twice, for AVX2 and for any
// machine; both give the same bytes. Lengths are rounded up to eight, so arrays need that room. No other header may
// come in here: an inline function compiled for AVX2 could end up in the program for all machines.
namespace luminav {

/// One odometry step as turn, way, turn, with the deviations of their noise. Thrun et al. 2005, table 5.6.
struct NoisyStep {
  float first_turn = 0.0F;      // [rad]
  float distance = 0.0F;        // [m] negative: backwards
  float second_turn = 0.0F;     // [rad]
  float first_sigma = 0.0F;     // [rad]
  float distance_sigma = 0.0F;  // [m]
  float second_sigma = 0.0F;    // [rad]
};

/// Key of a counter-based generator: the same key and index give the same number, whatever else was drawn.
struct NoiseKey {
  std::uint32_t low = 0;
  std::uint32_t high = 0;
};

/// Rectangle round points [m].
struct PointBox {
  float min_x, min_y, max_x, max_y;
};

/// Fixtures that may be the nearest one of some points. `period` is the angle after which it looks the same, 0 = none.
struct NearestCandidates {
  const float* x;
  const float* y;
  const float* theta;
  const float* period;
  std::size_t count;
};

/// How one sighting is scored.
struct SightingScore {
  float theta = 0.0F;          // [rad] of the fixture in the robot frame
  float distance_gain = 0.0F;  // equation 1: [1/m]
  float angle_gain = 0.0F;     // equation 1: [1/rad]; 0 = the sighting has no orientation
  float metric_xx = 1.0F;      // equation 1: squared distance = xx dx^2 + 2 xy dx dy + yy dy^2 in the robot frame
  float metric_xy = 0.0F;
  float metric_yy = 1.0F;
  float position_precision = 0.0F;  // Gaussian: 1 / (2 sigma^2) [1/m^2]
  float heading_precision = 0.0F;   // Gaussian: 1 / (2 sigma^2) [1/rad^2]; 0 = the sighting has no orientation
  float floor = 0.0F;               // Gaussian: likelihood of anything else
};

/// Offset of the nearest fixture from each point, world axes, with the fixture's heading and period. One block.
struct NearestOffsets {
  float* dx;
  float* dy;
  float* theta;
  float* period;
};

struct ParticleArrays {
  float* x;
  float* y;
  float* theta;
};

/// Weighted sums of a block, relative to a reference.
struct ParticleMoments {
  float weight, x, y, cosine, sine;
  float xx, xy, yy, xt, yt, tt, t;
};

struct ParticleKernels {
  const char* name;
  /// Moves particles `first` .. by a step with noise.
  void (*move)(const NoisyStep& step, NoiseKey key, std::size_t first, float* x, float* y, float* theta,
               std::size_t count);
  void (*sine_cosine)(const float* theta, float* cosine, float* sine, std::size_t count);
  /// Where each particle sees a point of the robot frame, and the rectangle round these places.
  PointBox (*project)(const float* x, const float* y, const float* cosine, const float* sine, float robot_x,
                      float robot_y, float* projected_x, float* projected_y, std::size_t count);
  void (*find_nearest)(const float* x, const float* y, const NearestCandidates& candidates,
                       const NearestOffsets& nearest, std::size_t count);
  /// Adds 1 / (1 + kd d + kt |dtheta|) to the sums.
  void (*add_equation_one)(const SightingScore& score, const NearestOffsets& nearest, const float* theta,
                           const float* cosine, const float* sine, float* sum, std::size_t count);
  /// Multiplies floor + exp(-...) into the products.
  void (*multiply_gaussian)(const SightingScore& score, const NearestOffsets& nearest, const float* theta,
                            float* product, std::size_t count);
  /// Adds noise of a deviation, then keeps all at or above `min`.
  void (*jitter)(NoiseKey key, std::size_t first, float sigma, float min, float* values, std::size_t count);
  /// Sums about a reference pose.
  ParticleMoments (*moments)(const float* x, const float* y, const float* theta, const float* weight, float x0,
                             float y0, float theta0, std::size_t count);
  /// Systematic resampling: copies particles in proportion to their weights, as many as there were. `offset` in [0, 1).
  /// Kitagawa 1996.
  void (*resample)(const ParticleArrays& from, const float* weight, double total, double offset,
                   const ParticleArrays& to, std::size_t count);
};

/// The fastest ones that this machine can run.
const ParticleKernels& particle_kernels();
/// Those for any machine; for tests.
const ParticleKernels& portable_particle_kernels();

}  // namespace luminav
