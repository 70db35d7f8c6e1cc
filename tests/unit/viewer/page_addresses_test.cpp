#include "services/viewer/address/page_addresses.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

TEST(PageAddresses, OfAllCardsAreNumbersAndNotTheMachinesOwn) {
  EXPECT_EQ(reachable_addresses("192.168.7.4"), std::vector<std::string>{"192.168.7.4"});
  for (const std::string& address : reachable_addresses("0.0.0.0")) {
    EXPECT_EQ(address.find_first_not_of("0123456789."), std::string::npos) << address;
    EXPECT_FALSE(address.starts_with("127.")) << address;
  }
}

}  // namespace
}  // namespace luminav
