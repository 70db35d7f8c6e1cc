#include "services/viewer/http/query.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

TEST(Query, FindsTheValueOfAKey) {
  EXPECT_EQ(value_of("kind=map&name=a.yaml", "name"), "a.yaml");
  EXPECT_EQ(value_of("kind=map&name=a.yaml", "kind"), "map");
  for (const char* none : {"", "name", "names=a", "a=name=b", "&&"}) {
    EXPECT_EQ(value_of(none, "name"), "") << none;
  }
}

TEST(Query, ReadsEscapedTexts) {
  EXPECT_EQ(decoded("office%207+b"), "office 7 b");
  EXPECT_EQ(decoded("%C3%A4%2f%2B"), "ä/+");
  EXPECT_EQ(decoded(""), "");
  for (const char* wrong : {"%", "%4", "%4x", "a%zz", "%-1", "%+1"}) {
    EXPECT_FALSE(decoded(wrong)) << wrong;
  }
}

}  // namespace
}  // namespace luminav
