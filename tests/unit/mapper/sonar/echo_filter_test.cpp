#include "services/mapper/sonar/echo_filter.hpp"

#include <gtest/gtest.h>

#include <random>

namespace luminav {
namespace {

constexpr std::int64_t kRound = 320'000;  // [us] from one reading of a disc to its next

TEST(EchoFilter, LetsAnEchoThroughWhenItComesAgain) {
  EchoFilter filter({}, 16);
  EXPECT_FALSE(filter.confirm(3, 1'000'000, {1.0, 2.0}, 1.5));
  EXPECT_TRUE(filter.confirm(3, 1'000'000 + kRound, {1.05, 2.05}, 1.5));
}

TEST(EchoFilter, TakesTheWordOfANeighbour) {
  EchoFilter filter({}, 16);
  EXPECT_FALSE(filter.confirm(15, 1'000'000, {1.0, 2.0}, 1.5));
  EXPECT_TRUE(filter.confirm(0, 1'040'000, {1.1, 2.0}, 1.5)) << "the ring closes";
  EXPECT_FALSE(filter.confirm(8, 1'080'000, {1.1, 2.0}, 1.5)) << "a disc on the other side";
}

TEST(EchoFilter, ForgetsOldEchoes) {
  EchoFilter filter({}, 16);
  EXPECT_FALSE(filter.confirm(3, 1'000'000, {1.0, 2.0}, 1.5));
  EXPECT_FALSE(filter.confirm(3, 4'000'000, {1.0, 2.0}, 1.5));
}

TEST(EchoFilter, StopsMostOfWhatComesAtRandom) {
  EchoFilter filter({}, 16);
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> range(0.3, 5.0);
  int passed = 0;
  constexpr int kEchoes = 2000;
  for (int i = 0; i < kEchoes; ++i) {
    const double r = range(rng);
    // one reading in ten is disturbed: the disc's last one was seldom disturbed too
    passed += filter.confirm(3, 1'000'000 + i * 10 * kRound, {r, 0.0}, r) ? 1 : 0;
  }
  EXPECT_LT(passed, kEchoes / 50);
}

TEST(EchoFilter, RefusesImpossibleParameters) {
  EXPECT_THROW(EchoFilter({.memory = 0.0}, 16), std::invalid_argument);
  EXPECT_THROW(EchoFilter({}, 0), std::invalid_argument);
}

}  // namespace
}  // namespace luminav
