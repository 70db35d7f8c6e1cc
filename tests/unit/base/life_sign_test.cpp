#include "drivers/base/safety/life_sign.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

TEST(LifeSign, TellsTheGuardianEach55Milliseconds) {
  VirtualClock clock;
  LifeSign life(0.3, 1.0);
  int told = 0;
  life.report_to([&] { ++told; });
  for (int i = 0; i < 100; ++i) {
    life.beat(clock);
    clock.advance(10'000);
  }
  EXPECT_GE(told, 16);
  EXPECT_LE(told, 19);
  EXPECT_FALSE(life.guardian_may_have_acted(clock.utime()));
}

TEST(LifeSign, KnowsThatItWasSilentForTooLong) {
  VirtualClock clock;
  LifeSign life(0.3, 1.0);
  life.report_to([] {});
  life.beat(clock);
  const std::int64_t beat = clock.utime();
  clock.advance(310'000);
  EXPECT_TRUE(life.guardian_may_have_acted(clock.utime()));
  EXPECT_EQ(life.guardian_done_at(), beat + 1'000'000);
  life.forget();
  EXPECT_FALSE(life.guardian_may_have_acted(clock.utime()));
}

TEST(LifeSign, KnowsThatTheBeatItselfCameTooLate) {
  VirtualClock clock;
  LifeSign life(0.3, 1.0);
  bool sleeps = false;
  life.report_to([&] { clock.advance(sleeps ? 400'000 : 0); });
  life.beat(clock);
  clock.advance(60'000);
  sleeps = true;
  life.beat(clock);
  EXPECT_TRUE(life.guardian_may_have_acted(clock.utime()));
}

TEST(LifeSign, NeverFearsAGuardianThatIsNotThere) {
  VirtualClock clock;
  LifeSign life(0.3, 0.0);
  life.report_to([] {});
  life.beat(clock);
  clock.advance(5'000'000);
  EXPECT_FALSE(life.guardian_may_have_acted(clock.utime()));
}

}  // namespace
}  // namespace luminav
