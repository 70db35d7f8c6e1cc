#include "services/viewer/address/page_addresses.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace luminav {
namespace {

TEST(PageAddresses, OfAllCardsAreNumbersAndNotTheMachinesOwn) {
  EXPECT_EQ(reachable_addresses("192.168.7.4"), std::vector<std::string>{"192.168.7.4"});
  for (const std::string& address : reachable_addresses("0.0.0.0")) {
    EXPECT_EQ(address.find_first_not_of("0123456789."), std::string::npos) << address;
    EXPECT_FALSE(address.starts_with("127.")) << address;
  }
}

TEST(QrCode, IsASquareOfBlackAndWhiteAndGrowsWithItsText) {
  const std::string code = qr_code("http://192.168.7.4:8080/#token=0123456789abcdef01234567");
  const auto lines = std::count(code.begin(), code.end(), '\n');
  EXPECT_GE(lines, 14);
  EXPECT_NE(code.find("\033[30;107m"), std::string::npos) << "black on white whatever the terminal's colours are";
  const std::string longer = qr_code(std::string(300, 'x'));
  EXPECT_GT(std::count(longer.begin(), longer.end(), '\n'), lines);
  EXPECT_EQ(qr_code(std::string(5000, 'x')), "");
}

}  // namespace
}  // namespace luminav
