#include "services/localizer/paper/particle_kernels.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace luminav {
namespace {

/// FNV-1a over the bits of all that the loops write in some steps, starting anywhere near the origin.
std::uint64_t sum_of_bits(const ParticleKernels& kernels) {
  constexpr std::size_t kCount = 1024;
  std::uint64_t sum = 0xcbf29ce484222325ULL;
  const auto add = [&](const std::vector<float>& values) {
    for (const float value : values) {
      sum = (sum ^ std::bit_cast<std::uint32_t>(value)) * 0x100000001b3ULL;
    }
  };
  const std::vector<float> fixture_x = {0.3F, -1.2F, 2.0F};
  const std::vector<float> fixture_y = {0.1F, 0.7F, -0.4F};
  const std::vector<float> fixture_theta = {0.1F, 1.5F, 0.0F};
  const std::vector<float> period = {3.1415927F, 1.5707963F, 0.0F};
  const SightingScore score{0.2F, 2.0F, 1.0F, 1.1F, 0.1F, 0.9F, 0.02F, 0.5F, 0.05F};
  const std::vector<float> none(kCount);
  std::vector<float> x = none, y = none, theta = none, cosine = none, sine = none, seen_x = none, seen_y = none;
  std::vector<float> dx = none, dy = none, nearest_theta = none, nearest_period = none, weight = none;
  const NearestOffsets nearest{dx.data(), dy.data(), nearest_theta.data(), nearest_period.data()};
  for (std::uint32_t step = 0; step < 20; ++step) {
    kernels.move({0.1F, 0.4F, -0.07F, 0.05F, 0.03F, 0.04F}, {step, 7}, 0, x.data(), y.data(), theta.data(), kCount);
    kernels.sine_cosine(theta.data(), cosine.data(), sine.data(), kCount);
    kernels.project(x.data(), y.data(), cosine.data(), sine.data(), 0.5F, -0.3F, seen_x.data(), seen_y.data(), kCount);
    kernels.find_nearest(seen_x.data(), seen_y.data(),
                         {fixture_x.data(), fixture_y.data(), fixture_theta.data(), period.data(), 3}, nearest, kCount);
    kernels.add_equation_one(score, nearest, theta.data(), cosine.data(), sine.data(), weight.data(), kCount);
    kernels.multiply_gaussian(score, nearest, theta.data(), weight.data(), kCount);
    kernels.jitter({9, step}, 0, 0.01F, 1e-6F, weight.data(), kCount);
    const ParticleMoments moments =
        kernels.moments(x.data(), y.data(), theta.data(), weight.data(), 1.0F, 0.5F, 0.2F, kCount);
    for (const auto* values : {&x, &y, &theta, &cosine, &sine, &seen_x, &seen_y, &dx, &dy, &weight}) {
      add(*values);
    }
    add({moments.weight, moments.x, moments.y, moments.cosine, moments.sine, moments.xx, moments.xy, moments.yy,
         moments.xt, moments.yt, moments.tt, moments.t});
  }
  return sum;
}

TEST(ParticleKernels, GiveTheSameBytesOnEveryMachine) {
  // seen on x86-64, with AVX2 and without, and on 64-bit ARM; contracted multiplications and additions give another one
  constexpr std::uint64_t kSeen = 0xe714533a2d61cb3eULL;
  EXPECT_EQ(sum_of_bits(particle_kernels()), kSeen);
  EXPECT_EQ(sum_of_bits(portable_particle_kernels()), kSeen);
}

TEST(ParticleKernels, SineAndCosineAreRightToFloat) {
  std::vector<float> theta(4096);
  for (std::size_t i = 0; i < theta.size(); ++i) {
    theta[i] = -6.5F + 13.0F * static_cast<float>(i) / 4096.0F;
  }
  std::vector<float> cosine(theta.size());
  std::vector<float> sine(theta.size());
  particle_kernels().sine_cosine(theta.data(), cosine.data(), sine.data(), theta.size());
  for (std::size_t i = 0; i < theta.size(); ++i) {
    ASSERT_NEAR(cosine[i], std::cos(static_cast<double>(theta[i])), 1e-6) << theta[i];
    ASSERT_NEAR(sine[i], std::sin(static_cast<double>(theta[i])), 1e-6) << theta[i];
  }
}

TEST(ParticleKernels, NoiseIsNormalAndIndependent) {
  constexpr std::size_t kCount = 100'000;
  const NoisyStep step{0.0F, 0.0F, 0.0F, 0.0F, 1.0F, 0.1F};
  std::vector<float> x(kCount);
  std::vector<float> y(kCount);
  std::vector<float> theta(kCount);
  particle_kernels().move(step, {123, 456}, 0, x.data(), y.data(), theta.data(), kCount);
  double mean = 0.0;
  double square = 0.0;
  double fourth = 0.0;
  double turn_square = 0.0;
  double both = 0.0;
  double neighbours = 0.0;
  for (std::size_t i = 0; i < kCount; ++i) {
    const double distance = x[i];
    const double turn = 10.0 * theta[i];
    mean += distance / kCount;
    square += distance * distance / kCount;
    fourth += distance * distance * distance * distance / kCount;
    turn_square += turn * turn / kCount;
    both += distance * turn / kCount;
    neighbours += distance * x[(i + 1) % kCount] / kCount;
  }
  const double tolerance = 4.0 / std::sqrt(kCount);  // four deviations
  EXPECT_NEAR(mean, 0.0, tolerance);
  EXPECT_NEAR(square, 1.0, std::sqrt(2.0) * tolerance);
  EXPECT_NEAR(fourth, 3.0, std::sqrt(96.0) * tolerance);
  EXPECT_NEAR(turn_square, 1.0, std::sqrt(2.0) * tolerance);
  EXPECT_NEAR(both, 0.0, tolerance);
  EXPECT_NEAR(neighbours, 0.0, tolerance);
}

}  // namespace
}  // namespace luminav
