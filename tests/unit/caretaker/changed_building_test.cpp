#include "services/caretaker/changed_building.hpp"

#include <gmock/gmock.h>

#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/configuration_error.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/caretaker/drawn_visits.hpp"

namespace luminav {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kText = R"(# a hall
name = "hall"
ceiling_height = 3.0

[[fixture]]
id = 1
x = 1.0  # from the east wall
y = 2.0
length = 1.2
width = 0.3

# the second row
[[fixture]]
id = 2
x = 3.0
y = 2.0
theta = 0.5
length = 1.2
width = 0.3

[[place]]
name = "door"
x = 0.0
y = 0.0
)";

class ChangedBuilding : public testing::Test {
 protected:
  void SetUp() override { write_whole_file(file_, kText); }
  CeilingChange change(ChangeKind kind, int id, const Pose2& pose) const {
    CeilingChange change;
    change.kind = kind;
    change.id = id;
    change.fixture.id = id;
    change.fixture.height = 3.0;
    change.fixture.world_from_fixture = pose;
    return change;
  }
  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "building.toml";
};

TEST_F(ChangedBuilding, HasMovedFixturesAndKeepsAllElse) {
  const auto kept = change_building(file_, {change(ChangeKind::kMoved, 1, {1.25, 2.5, 0.1})}, kMonday);
  const Building building = read_building(file_);
  ASSERT_EQ(building.fixtures.size(), 2U);
  EXPECT_DOUBLE_EQ(building.fixtures[0].world_from_fixture.x, 1.25);
  EXPECT_DOUBLE_EQ(building.fixtures[0].world_from_fixture.theta, 0.1);
  EXPECT_DOUBLE_EQ(building.fixtures[1].world_from_fixture.x, 3.0);
  const std::string text = read_whole_file(file_);
  EXPECT_THAT(text, HasSubstr("x = 1.250  # from the east wall"));
  EXPECT_THAT(text, HasSubstr("# the second row\n[[fixture]]"));
  EXPECT_EQ(read_whole_file(kept), kText);
  EXPECT_EQ(kept.filename(), "building-before-2024-10-04-000000.toml");
}

TEST_F(ChangedBuilding, LosesARemovedFixtureAndGetsANewOne) {
  change_building(file_, {change(ChangeKind::kRemoved, 1, {}), change(ChangeKind::kNew, 3, {5.0, 6.0, 0.2})}, kMonday);
  const Building building = read_building(file_);
  ASSERT_EQ(building.fixtures.size(), 2U);
  EXPECT_EQ(building.fixtures[0].id, 2);
  EXPECT_EQ(building.fixtures[1].id, 3);
  EXPECT_DOUBLE_EQ(building.fixtures[1].world_from_fixture.y, 6.0);
  EXPECT_EQ(building.places.size(), 1U);
  EXPECT_THAT(read_whole_file(file_), Not(HasSubstr("id = 1\n")));
}

TEST_F(ChangedBuilding, TakesSeveralChangesAtOnce) {
  change_building(
      file_, {change(ChangeKind::kMoved, 1, {1.5, 2.0, 0.3}), change(ChangeKind::kMoved, 2, {3.5, 2.0, 0.4})}, kMonday);
  const Building building = read_building(file_);
  EXPECT_DOUBLE_EQ(building.fixtures[0].world_from_fixture.x, 1.5);
  EXPECT_DOUBLE_EQ(building.fixtures[1].world_from_fixture.x, 3.5);
  EXPECT_DOUBLE_EQ(building.fixtures[1].world_from_fixture.theta, 0.4);
}

TEST_F(ChangedBuilding, NeverOverwritesAnOlderVersion) {
  const auto first = change_building(file_, {change(ChangeKind::kMoved, 1, {1.5, 2.0, 0.3})}, kMonday);
  const auto second = change_building(file_, {change(ChangeKind::kMoved, 1, {1.6, 2.0, 0.3})}, kMonday);
  EXPECT_NE(first, second);
  EXPECT_EQ(read_whole_file(first), kText);
}

TEST_F(ChangedBuilding, StaysAsItIsWhenAChangeMakesNoSense) {
  EXPECT_THROW(change_building(file_, {change(ChangeKind::kMoved, 9, {})}, kMonday), ConfigurationError);
  EXPECT_THROW(change_building(file_, {change(ChangeKind::kMoved, 1, {1e9, 0.0, 0.0})}, kMonday), ConfigurationError);
  EXPECT_EQ(read_whole_file(file_), kText);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 1);
}

TEST_F(ChangedBuilding, RefusesFixturesInAnInlineArray) {
  write_whole_file(file_,
                   "name = \"hall\"\nceiling_height = 3.0\nfixture = [{id = 1, x = 1.0, y = 2.0, length = 1.2, width = "
                   "0.3}]\n");
  EXPECT_THAT([&] { change_building(file_, {change(ChangeKind::kMoved, 1, {})}, kMonday); },
              testing::ThrowsMessage<ConfigurationError>(HasSubstr("must begin with [[fixture]]")));
}

}  // namespace
}  // namespace luminav
