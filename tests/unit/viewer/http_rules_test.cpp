#include "services/viewer/http/http_rules.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

TEST(ReadHost, TakesNamesAddressesAndPorts) {
  EXPECT_EQ(read_host("LocalHost:8080"), (HostAndPort{"localhost", 8080}));
  EXPECT_EQ(read_host("10.0.0.7"), (HostAndPort{"10.0.0.7", 80}));
  EXPECT_EQ(read_host("[::1]:99"), (HostAndPort{"::1", 99}));
}

TEST(ReadHost, RefusesWhatIsNone) {
  for (const char* text : {"", ":8080", "a b", "a:", "a:0", "a:65536", "a:8x", "[::1", "[nonsense]:80", "a/b", "::1"}) {
    EXPECT_FALSE(read_host(text)) << text;
  }
}

TEST(ReadOrigin, TakesOnlyPlainHttpOrigins) {
  EXPECT_EQ(read_origin("http://robot:8080"), (HostAndPort{"robot", 8080}));
  EXPECT_FALSE(read_origin("https://robot:8080"));
  EXPECT_FALSE(read_origin("null"));
  EXPECT_FALSE(read_origin("http://robot:8080/page"));
}

TEST(IsLoopback, KnowsTheWholeBlock) {
  EXPECT_TRUE(is_loopback("127.0.0.1"));
  EXPECT_TRUE(is_loopback("127.1.2.3"));
  EXPECT_TRUE(is_loopback("::1"));
  EXPECT_TRUE(is_loopback("localhost"));
  EXPECT_FALSE(is_loopback("128.0.0.1"));
  EXPECT_FALSE(is_loopback("127.0.0.1.example.org"));
}

TEST(AccessRules, OnLoopbackRefusesForeignNamesForThisMachine) {
  const AccessRules rules("127.0.0.1", "robot", 8080, {});
  EXPECT_FALSE(rules.objection_to_host("localhost:8080"));
  EXPECT_FALSE(rules.objection_to_host("127.0.0.1:8080"));
  EXPECT_TRUE(rules.objection_to_host("evil.example:8080"));
  EXPECT_TRUE(rules.objection_to_host("robot:8080"));
  EXPECT_TRUE(rules.objection_to_host(""));
}

TEST(AccessRules, OnAllAddressesKnowsAddressesAndItsOwnName) {
  const AccessRules rules("0.0.0.0", "Robot", 8080, {"secret"});
  EXPECT_FALSE(rules.objection_to_host("192.168.1.5:8080"));
  EXPECT_FALSE(rules.objection_to_host("robot:8080"));
  EXPECT_FALSE(rules.objection_to_host("robot.local:8080"));
  EXPECT_TRUE(rules.objection_to_host("evil.example:8080"));
}

TEST(AccessRules, TakesCommandsFromItsOwnPageOnly) {
  const AccessRules rules("127.0.0.1", "robot", 8080, {});
  EXPECT_FALSE(rules.objection_to_origin("localhost:8080", "http://localhost:8080"));
  EXPECT_FALSE(rules.objection_to_origin("localhost:8081", "http://localhost:8080"));  // the command port
  EXPECT_FALSE(rules.objection_to_origin("localhost:9000", "http://localhost:9000"));  // through a tunnel
  EXPECT_FALSE(rules.objection_to_origin("localhost:8081", ""));                       // no browser
  EXPECT_TRUE(rules.objection_to_origin("localhost:8081", "http://localhost:3000"));   // another page of this host
  EXPECT_TRUE(rules.objection_to_origin("localhost:8081", "http://evil.example:8080"));
  EXPECT_TRUE(rules.objection_to_origin("localhost:8081", "null"));
  EXPECT_TRUE(rules.objection_to_origin("127.0.0.1:8081", "http://localhost:8080"));
}

TEST(AccessRules, DemandsTheWholeToken) {
  const AccessRules rules("0.0.0.0", "robot", 8080, {"secret"});
  EXPECT_FALSE(rules.objection_to_token("secret", Role::kAdminister));
  for (const char* token : {"", "secre", "secrets", "Secret"}) {
    EXPECT_TRUE(rules.objection_to_token(token, Role::kDrive)) << token;
    EXPECT_FALSE(rules.objection_to_token(token, Role::kLook)) << token;
  }
}

TEST(AccessRules, GivesEachTokenItsRoleAndThoseBelow) {
  const AccessRules rules("0.0.0.0", "robot", 8080, {"owner", "driver", "guest"});
  const auto may = [&](const char* token, Role role) { return !rules.objection_to_token(token, role); };
  EXPECT_TRUE(may("", Role::kAnybody));
  EXPECT_FALSE(may("", Role::kLook));
  EXPECT_TRUE(may("guest", Role::kLook));
  EXPECT_FALSE(may("guest", Role::kDrive));
  EXPECT_TRUE(may("driver", Role::kDrive));
  EXPECT_FALSE(may("driver", Role::kAdminister));
  EXPECT_TRUE(may("owner", Role::kAdminister));
  EXPECT_TRUE(may("owner", Role::kLook));
}

TEST(AccessRules, DemandsNothingWhereNobodyElseComes) {
  const AccessRules rules("127.0.0.1", "robot", 8080, {});
  EXPECT_FALSE(rules.objection_to_token("", Role::kAdminister));
}

TEST(Cookie, IsFoundByItsWholeName) {
  EXPECT_EQ(read_cookie("a=1; luminav_token=x; b=2", "luminav_token"), "x");
  EXPECT_EQ(read_cookie("luminav_token=x", "luminav_token"), "x");
  for (const char* other : {"", ";", "luminav_token", "luminav_tokens=x", "my_luminav_token=x", "a=luminav_token=x"}) {
    EXPECT_EQ(read_cookie(other, "luminav_token"), "") << other;
  }
}

}  // namespace
}  // namespace luminav
