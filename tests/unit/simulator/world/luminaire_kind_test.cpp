#include "drivers/simulator/world/luminaire_kind.hpp"

#include <gtest/gtest.h>

#include <set>

#include "services/common/building/building.hpp"

namespace luminav {
namespace {

using Kind = LuminaireKind;

/// Two long fixtures, two square ones and a round one.
Building mixed() {
  Building building;
  for (const auto& [shape, length, width, lamps] : {std::tuple(FixtureShape::kRectangle, 1.2, 0.3, 2),
                                                    {FixtureShape::kSquare, 0.6, 0.6, 4},
                                                    {FixtureShape::kRectangle, 1.2, 0.3, 2},
                                                    {FixtureShape::kSquare, 0.6, 0.6, 4},
                                                    {FixtureShape::kRound, 0.2, 0.2, 1}}) {
    Fixture fixture;
    fixture.shape = shape;
    fixture.length = length;
    fixture.width = width;
    fixture.lamps = lamps;
    building.fixtures.push_back(fixture);
  }
  return building;
}

TEST(LuminaireKind, HasANameThatLeadsBackToIt) {
  for (std::size_t i = 0; i < luminaire_names().size(); ++i) {
    EXPECT_EQ(luminaire_named(luminaire_names()[i]), static_cast<Kind>(i));
  }
  EXPECT_FALSE(luminaire_named("chandelier").has_value());
}

TEST(LuminaireKind, FixturesAlikeAreBuiltAlikeAndWhatFitsNowhereIsAPanel) {
  const std::vector<Kind> choice{Kind::kLouvre, Kind::kOpal, Kind::kPrismatic};
  std::set<Kind> drawn;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const std::vector<Kind> kinds = draw_luminaires(choice, mixed(), seed);
    ASSERT_EQ(kinds.size(), 5U);
    EXPECT_EQ(kinds[0], kinds[2]);
    EXPECT_EQ(kinds[1], kinds[3]);
    EXPECT_EQ(kinds[4], Kind::kPanel);
    drawn.insert(kinds[0]);
  }
  EXPECT_EQ(drawn.size(), 3U);
  EXPECT_EQ(draw_luminaires({}, mixed(), 1), std::vector<Kind>(5, Kind::kPanel));
}

TEST(LuminaireKind, APendantHangsBelowTheCeilingAndABattenIsNarrow) {
  Fixture fixture;
  fixture.width = 0.15;
  fixture.lamps = 1;
  fixture.height = 2.4;
  EXPECT_TRUE(is_built_as(Kind::kPendant, fixture, 2.8));
  EXPECT_TRUE(is_built_as(Kind::kBatten, fixture, 2.8));
  fixture.height = 2.8;
  fixture.width = 0.3;
  EXPECT_FALSE(is_built_as(Kind::kPendant, fixture, 2.8));
  EXPECT_FALSE(is_built_as(Kind::kBatten, fixture, 2.8));
  EXPECT_FALSE(is_built_as(Kind::kDownlight, fixture, 2.8));
}

}  // namespace
}  // namespace luminav
