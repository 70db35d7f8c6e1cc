#include "services/surveyor/survey/ceiling_kinds.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "services/common/configuration/configuration_error.hpp"

namespace luminav {
namespace {

CeilingKinds read(const std::string& text) {
  const std::string file = testing::TempDir() + "/kinds.toml";
  std::ofstream(file) << text;
  return read_ceiling_kinds(file);
}

std::string complaint(const std::string& text) {
  try {
    (void)read(text);
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "";
}

const char* const kTube = "[[kind]]\nlength = 1.2\nwidth = 0.15\nlamps = 1\n";

TEST(CeilingKinds, ReadsTheShippedFile) {
  EXPECT_EQ(read_ceiling_kinds(LUMINAV_SOURCE_DIR "/launch/survey/laboratory-kinds.toml").kinds.size(), 2u);
}

TEST(CeilingKinds, ReadsWhatOnePersonMeasures) {
  const CeilingKinds kinds = read(std::string("ceiling_height = 2.7\n") + kTube +
                                  "[[kind]]\nshape = \"round\"\ndiameter = 0.3\nheight = 2.5\n");
  ASSERT_EQ(kinds.kinds.size(), 2u);
  EXPECT_DOUBLE_EQ(kinds.ceiling_height, 2.7);
  EXPECT_DOUBLE_EQ(kinds.kinds[0].height, 2.7);
  EXPECT_EQ(kinds.kinds[0].lamps, 1);
  EXPECT_EQ(kinds.kinds[1].shape, FixtureShape::kRound);
  EXPECT_DOUBLE_EQ(kinds.kinds[1].height, 2.5);
  EXPECT_EQ(building_of(kinds).fixtures.size(), 2u);
}

TEST(CeilingKinds, RefusesAFileWithoutAKind) {
  EXPECT_THAT(complaint("ceiling_height = 2.7\n"), testing::HasSubstr("at least one [[kind]]"));
}

TEST(CeilingKinds, RefusesTwoKindsThatLookTheSame) {
  EXPECT_THAT(complaint(std::string("ceiling_height = 2.7\n") + kTube + kTube),
              testing::HasSubstr("looks like kind 1"));
}

TEST(CeilingKinds, RefusesWhatItDoesNotKnow) {
  EXPECT_THAT(complaint(std::string("ceiling_height = 2.7\n") + kTube + "x = 1.0\n"), testing::HasSubstr("x"));
  EXPECT_THAT(complaint(kTube), testing::HasSubstr("ceiling_height"));
}

}  // namespace
}  // namespace luminav
