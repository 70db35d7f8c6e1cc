// Compiled once for AVX2 and once for any machine (LUMINAV_KERNELS names the function that hands them out).
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "services/localizer/paper/particle_kernels.hpp"

namespace luminav {
namespace {

using Float8 = float __attribute__((vector_size(32)));
using Int8 = std::int32_t __attribute__((vector_size(32)));
using Unsigned8 = std::uint32_t __attribute__((vector_size(32)));

constexpr std::size_t kLanes = 8;
constexpr float kPi = 3.14159265358979F;
constexpr float kTwoPi = 6.28318530717959F;

inline Float8 load(const float* from) {
  Float8 value;
  __builtin_memcpy(&value, from, sizeof value);
  return value;
}

inline void store(float* to, Float8 value) {
  __builtin_memcpy(to, &value, sizeof value);
}

inline Float8 splat(float value) {
  return Float8{} + value;
}

inline Int8 bits(Float8 value) {
  Int8 result;
  __builtin_memcpy(&result, &value, sizeof result);
  return result;
}

inline Float8 from_bits(Int8 value) {
  Float8 result;
  __builtin_memcpy(&result, &value, sizeof result);
  return result;
}

inline Float8 smaller(Float8 a, Float8 b) {
  return a < b ? a : b;
}

inline Float8 larger(Float8 a, Float8 b) {
  return a > b ? a : b;
}

inline Float8 magnitude(Float8 a) {
  return from_bits(bits(a) & 0x7FFFFFFF);
}

/// To the nearest integer, for |a| below 2^22.
inline Float8 round_to_integer(Float8 a) {
  constexpr float kMagic = 12582912.0F;  // 1.5 * 2^23: the sum has no room for a fraction
  return (a + kMagic) - kMagic;
}

inline Float8 square_root(Float8 a) {
#if defined(__AVX__)
  return reinterpret_cast<Float8>(_mm256_sqrt_ps(reinterpret_cast<__m256>(a)));
#elif defined(__SSE2__)
  float values[kLanes];
  store(values, a);
  _mm_storeu_ps(values, _mm_sqrt_ps(_mm_loadu_ps(values)));
  _mm_storeu_ps(values + 4, _mm_sqrt_ps(_mm_loadu_ps(values + 4)));
  return load(values);
#else
  for (std::size_t i = 0; i < kLanes; ++i) {
    a[i] = __builtin_sqrtf(a[i]);
  }
  return a;
#endif
}

inline Float8 wrap(Float8 angle) {
  return angle - kTwoPi * round_to_integer(angle * (1.0F / kTwoPi));
}

struct SineCosine {
  Float8 sine;
  Float8 cosine;
};

/// Of angles up to a few turns. Polynomials of Taylor's kind fitted on +-pi/4 (Cephes); error below 2e-7.
inline SineCosine sine_cosine_of(Float8 angle) {
  const Float8 quarter = round_to_integer(angle * (2.0F / kPi));
  // pi/2 in two parts, the first with few digits so that its product is exact
  const Float8 r = (angle - quarter * 1.5703125F) - quarter * 4.83826794896e-4F;
  const Float8 z = r * r;
  const Float8 sine = r + r * z * (-1.6666654611e-1F + z * (8.3321608736e-3F - z * 1.9515295891e-4F));
  const Float8 cosine =
      1.0F - 0.5F * z + z * z * (4.166664568298827e-2F + z * (-1.388731625493765e-3F + z * 2.443315711809948e-5F));
  const Int8 turns = __builtin_convertvector(quarter, Int8);
  const Int8 swapped = (turns & 1) == 1;
  const Int8 sine_sign = (turns & 2) << 30;
  const Int8 cosine_sign = ((turns + 1) & 2) << 30;
  return {from_bits(bits(swapped ? cosine : sine) ^ sine_sign), from_bits(bits(swapped ? sine : cosine) ^ cosine_sign)};
}

/// Natural logarithm of positive normal numbers, error below 2e-7 (Cephes).
inline Float8 logarithm(Float8 a) {
  const Int8 raw = bits(a);
  Int8 exponent = (raw >> 23) - 126;
  Float8 m = from_bits((raw & 0x007FFFFF) | 0x3F000000);  // in [0.5, 1)
  const Int8 is_small = m < 0.70710678F;
  exponent += is_small;  // true is -1
  m = is_small ? m + m - 1.0F : m - 1.0F;
  const Float8 z = m * m;
  Float8 p = splat(7.0376836292e-2F);
  constexpr float kCoefficients[] = {-1.1514610310e-1F, 1.1676998740e-1F, -1.2420140846e-1F, 1.4249322787e-1F,
                                     -1.6668057665e-1F, 2.0000714765e-1F, -2.4999993993e-1F, 3.3333331174e-1F};
  for (const float coefficient : kCoefficients) {
    p = p * m + coefficient;
  }
  const Float8 e = __builtin_convertvector(exponent, Float8);
  return (m * z * p - 2.12194440e-4F * e - 0.5F * z) + m + 0.693359375F * e;
}

/// e to the power of numbers not above 0; below -80 it stays there. Error below 2e-7 (Cephes).
inline Float8 exponential(Float8 a) {
  a = larger(a, splat(-80.0F));
  const Float8 n = round_to_integer(a * 1.44269504F);
  const Float8 r = (a - n * 0.693359375F) + n * 2.12194440e-4F;
  Float8 p = splat(1.9875691500e-4F);
  constexpr float kCoefficients[] = {1.3981999507e-3F, 8.3334519073e-3F, 4.1665795894e-2F, 1.6666665459e-1F,
                                     5.0000001201e-1F};
  for (const float coefficient : kCoefficients) {
    p = p * r + coefficient;
  }
  p = p * r * r + r + 1.0F;
  return p * from_bits((__builtin_convertvector(n, Int8) + 127) << 23);
}

/// A hash of 32 bits without visible patterns in counters: Wellons' "lowbias32", keyed before and between its rounds.
inline Unsigned8 hash(Unsigned8 counter, NoiseKey key) {
  Unsigned8 h = counter + key.low;
  h ^= h >> 16;
  h *= 0x7FEB352DU;
  h ^= (h >> 15) ^ key.high;
  h *= 0x846CA68BU;
  h ^= h >> 16;
  return h;
}

struct TwoNormals {
  Float8 first;
  Float8 second;
};

/// Box and Muller 1958.
inline TwoNormals normals(Unsigned8 counter, NoiseKey key) {
  const Int8 radial = reinterpret_cast<Int8>(hash(counter, key) >> 8);
  const Int8 angular = reinterpret_cast<Int8>(hash(counter + 1U, key)) >> 8;
  const Float8 uniform = (__builtin_convertvector(radial, Float8) + 1.0F) * 0x1.0p-24F;  // in (0, 1]
  const Float8 radius = square_root(-2.0F * smaller(logarithm(uniform), splat(0.0F)));
  const SineCosine turn = sine_cosine_of(__builtin_convertvector(angular, Float8) * (kPi * 0x1.0p-23F));
  return {radius * turn.cosine, radius * turn.sine};
}

inline Unsigned8 counters(std::size_t first) {
  constexpr Unsigned8 kSteps = {0, 4, 8, 12, 16, 20, 24, 28};  // four numbers for each particle
  return kSteps + static_cast<std::uint32_t>(4 * first);
}

void move(const NoisyStep& step, NoiseKey key, std::size_t first, float* x, float* y, float* theta, std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Unsigned8 counter = counters(first + i);
    const TwoNormals one = normals(counter, key);
    const TwoNormals two = normals(counter + 2U, key);
    const Float8 heading = load(theta + i) + step.first_turn + step.first_sigma * one.first;
    const Float8 distance = step.distance + step.distance_sigma * one.second;
    const SineCosine turn = sine_cosine_of(heading);
    store(x + i, load(x + i) + distance * turn.cosine);
    store(y + i, load(y + i) + distance * turn.sine);
    store(theta + i, wrap(heading + step.second_turn + step.second_sigma * two.first));
  }
}

void sine_cosine(const float* theta, float* cosine, float* sine, std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    const SineCosine turn = sine_cosine_of(load(theta + i));
    store(cosine + i, turn.cosine);
    store(sine + i, turn.sine);
  }
}

float min_of(Float8 values) {
  float min = values[0];
  for (std::size_t i = 1; i < kLanes; ++i) {
    min = values[i] < min ? values[i] : min;
  }
  return min;
}

PointBox project(const float* x, const float* y, const float* cosine, const float* sine, float robot_x, float robot_y,
                 float* projected_x, float* projected_y, std::size_t count) {
  Float8 min_x = splat(1e30F);
  Float8 min_y = splat(1e30F);
  Float8 max_x = splat(-1e30F);
  Float8 max_y = splat(-1e30F);
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Float8 c = load(cosine + i);
    const Float8 s = load(sine + i);
    const Float8 px = load(x + i) + c * robot_x - s * robot_y;
    const Float8 py = load(y + i) + s * robot_x + c * robot_y;
    store(projected_x + i, px);
    store(projected_y + i, py);
    min_x = smaller(min_x, px);
    min_y = smaller(min_y, py);
    max_x = larger(max_x, px);
    max_y = larger(max_y, py);
  }
  return {min_of(min_x), min_of(min_y), -min_of(-max_x), -min_of(-max_y)};
}

void find_nearest(const float* x, const float* y, const NearestCandidates& candidates, const NearestOffsets& nearest,
                  std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Float8 px = load(x + i);
    const Float8 py = load(y + i);
    Float8 dx = candidates.x[0] - px;
    Float8 dy = candidates.y[0] - py;
    Float8 theta = splat(candidates.theta[0]);
    Float8 period = splat(candidates.period[0]);
    Float8 min = dx * dx + dy * dy;
    for (std::size_t k = 1; k < candidates.count; ++k) {
      const Float8 other_x = candidates.x[k] - px;
      const Float8 other_y = candidates.y[k] - py;
      const Float8 squared = other_x * other_x + other_y * other_y;
      const Int8 is_nearer = squared < min;
      min = is_nearer ? squared : min;
      dx = is_nearer ? other_x : dx;
      dy = is_nearer ? other_y : dy;
      theta = is_nearer ? splat(candidates.theta[k]) : theta;
      period = is_nearer ? splat(candidates.period[k]) : period;
    }
    store(nearest.dx + i, dx);
    store(nearest.dy + i, dy);
    store(nearest.theta + i, theta);
    store(nearest.period + i, period);
  }
}

/// Heading difference of sighting and fixture modulo the fixture's symmetry; 0 where it has no orientation.
inline Float8 heading_difference(Float8 turn, Float8 period) {
  const Int8 is_round = period == 0.0F;
  const Float8 safe = is_round ? splat(1.0F) : period;
  const Float8 wrapped = turn - period * round_to_integer(turn / safe);
  return is_round ? splat(0.0F) : wrapped;
}

void add_equation_one(const SightingScore& score, const NearestOffsets& nearest, const float* theta,
                      const float* cosine, const float* sine, float* sum, std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Float8 dx = load(nearest.dx + i);
    const Float8 dy = load(nearest.dy + i);
    const Float8 c = load(cosine + i);
    const Float8 s = load(sine + i);
    const Float8 forward = c * dx + s * dy;
    const Float8 left = c * dy - s * dx;
    const Float8 squared =
        score.metric_xx * forward * forward + 2.0F * score.metric_xy * forward * left + score.metric_yy * left * left;
    const Float8 turn =
        heading_difference(load(theta + i) + score.theta - load(nearest.theta + i), load(nearest.period + i));
    const Float8 away = score.distance_gain * square_root(larger(squared, splat(0.0F)));
    store(sum + i, load(sum + i) + 1.0F / (1.0F + away + score.angle_gain * magnitude(turn)));
  }
}

void multiply_gaussian(const SightingScore& score, const NearestOffsets& nearest, const float* theta, float* product,
                       std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Float8 dx = load(nearest.dx + i);
    const Float8 dy = load(nearest.dy + i);
    const Float8 turn =
        heading_difference(load(theta + i) + score.theta - load(nearest.theta + i), load(nearest.period + i));
    const Float8 exponent = -score.position_precision * (dx * dx + dy * dy) - score.heading_precision * turn * turn;
    store(product + i, load(product + i) * (score.floor + exponential(exponent)));
  }
}

void jitter(NoiseKey key, std::size_t first, float sigma, float min, float* values, std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    const TwoNormals noise = normals(counters(first + i), key);
    store(values + i, larger(load(values + i) + sigma * noise.first, splat(min)));
  }
}

float sum_of(Float8 values) {
  return ((values[0] + values[1]) + (values[2] + values[3])) + ((values[4] + values[5]) + (values[6] + values[7]));
}

ParticleMoments moments(const float* x, const float* y, const float* theta, const float* weight, float x0, float y0,
                        float theta0, std::size_t count) {
  Float8 w = {}, wx = {}, wy = {}, wt = {}, xx = {}, xy = {}, yy = {}, xt = {}, yt = {}, tt = {}, wc = {}, ws = {};
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Float8 each = load(weight + i);
    const Float8 dx = load(x + i) - x0;
    const Float8 dy = load(y + i) - y0;
    const Float8 dt = wrap(load(theta + i) - theta0);
    const SineCosine turn = sine_cosine_of(dt);
    const Float8 weighted_x = each * dx;
    const Float8 weighted_y = each * dy;
    const Float8 weighted_t = each * dt;
    w += each;
    wx += weighted_x;
    wy += weighted_y;
    wt += weighted_t;
    wc += each * turn.cosine;
    ws += each * turn.sine;
    xx += weighted_x * dx;
    xy += weighted_x * dy;
    yy += weighted_y * dy;
    xt += weighted_x * dt;
    yt += weighted_y * dt;
    tt += weighted_t * dt;
  }
  return {.weight = sum_of(w),
          .x = sum_of(wx),
          .y = sum_of(wy),
          .cosine = sum_of(wc),
          .sine = sum_of(ws),
          .xx = sum_of(xx),
          .xy = sum_of(xy),
          .yy = sum_of(yy),
          .xt = sum_of(xt),
          .yt = sum_of(yt),
          .tt = sum_of(tt),
          .t = sum_of(wt)};
}

/// Eight copies at once: most particles have fewer, and the next one overwrites what is too much.
inline void copy_eight(const ParticleArrays& from, std::size_t source, const ParticleArrays& to, std::size_t target) {
  store(to.x + target, splat(from.x[source]));
  store(to.y + target, splat(from.y[source]));
  store(to.theta + target, splat(from.theta[source]));
}

void resample(const ParticleArrays& from, const float* weight, double total, double offset, const ParticleArrays& to,
              std::size_t count) {
  constexpr std::size_t kRun = 256;  // particles whose weights are summed as float
  const double scale = static_cast<double>(count) / total;
  const auto float_scale = static_cast<float>(scale);
  const auto last = static_cast<std::int64_t>(count);
  double carried = 0.0;
  std::int64_t done = 0;
  std::size_t heaviest = 0;  // stands in for what rounding leaves over at the end
  for (std::size_t begin = 0; begin < count; begin += kRun) {
    const std::size_t end = begin + kRun < count ? begin + kRun : count;
    // copies of all before this run: the whole numbers below `base`
    const double base = carried * scale - offset + 1.0;
    const auto whole = static_cast<std::int64_t>(base);
    const auto fraction = static_cast<float>(base - static_cast<double>(whole));
    float sum = 0.0F;
    for (std::size_t i = begin; i < end; ++i) {
      sum += weight[i];
      std::int64_t next = whole + static_cast<std::int64_t>(fraction + sum * float_scale);
      next = next < last ? next : last;
      copy_eight(from, i, to, static_cast<std::size_t>(done));
      for (std::int64_t k = done + 8; k < next; k += 8) {
        copy_eight(from, i, to, static_cast<std::size_t>(k));
      }
      heaviest = next > done ? i : heaviest;
      done = next > done ? next : done;
    }
    carried += static_cast<double>(sum);
  }
  for (; done < last; ++done) {
    copy_eight(from, heaviest, to, static_cast<std::size_t>(done));
  }
}

}  // namespace

const ParticleKernels& LUMINAV_KERNELS() {
  static constexpr ParticleKernels kKernels = {
#if defined(__AVX2__)
    .name = "AVX2",
#else
    .name = "portable",
#endif
    .move = move,
    .sine_cosine = sine_cosine,
    .project = project,
    .find_nearest = find_nearest,
    .add_equation_one = add_equation_one,
    .multiply_gaussian = multiply_gaussian,
    .jitter = jitter,
    .moments = moments,
    .resample = resample
  };
  return kKernels;
}

}  // namespace luminav
