#include "drivers/p3dx/line/line_rates.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace luminav {
namespace {

std::vector<int> tried(LineRates& rates) {
  std::vector<int> result;
  do {
    result.push_back(rates.current());
  } while (rates.advance());
  return result;
}

TEST(LineRates, BeginWithTheConfiguredAndTheFastOneAndNameEachOnce) {
  LineRates slow(9600, 0);
  EXPECT_THAT(tried(slow), testing::ElementsAre(9600, 38400, 19200, 115200, 57600));
  slow.restart();
  EXPECT_EQ(slow.current(), 9600);
  LineRates fast(19200, 115200);
  EXPECT_THAT(tried(fast), testing::ElementsAre(19200, 115200, 9600, 38400, 57600));
}

TEST(LineRates, SwitchToAFasterOneOnceInASession) {
  LineRates rates(9600, 115200);
  EXPECT_FALSE(rates.wants_fast(0)) << "no serial line";
  EXPECT_FALSE(rates.wants_fast(115200));
  EXPECT_TRUE(rates.wants_fast(9600));
  EXPECT_EQ(rates.switch_to_fast(), 115200);
  EXPECT_FALSE(rates.wants_fast(9600));
  rates.begin_session();
  EXPECT_TRUE(rates.wants_fast(9600));
  EXPECT_FALSE(LineRates(9600, 0).wants_fast(9600));
}

}  // namespace
}  // namespace luminav
