#include "services/common/configuration/building_watch.hpp"

#include <gtest/gtest.h>

#include "services/common/configuration/whole_file.hpp"
#include "services/common/process/running_system.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

const std::filesystem::path kLaboratory = LUMINAV_SOURCE_DIR "/launch/buildings/laboratory";
constexpr const char* kZone = "\n[[zone]]\nname = \"stairs\"\npolygon = [[1.0, 1.0], [2.0, 1.0], [2.0, 2.0]]\n";

class BuildingWatchTest : public testing::Test {
 protected:
  BuildingWatchTest() { std::filesystem::copy(kLaboratory, folder_.path() / "mine"); }
  void append(const std::string& text) { write_whole_file(file_, read_whole_file(file_) + text); }
  [[nodiscard]] std::int64_t sum_now() const { return identify("", file_).building_hash; }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "mine/building.toml";
};

TEST_F(BuildingWatchTest, TakesNewZonesOverWhenAnotherProcessHasThem) {
  BuildingWatch watch(file_);
  EXPECT_EQ(watch.sum(), sum_now());
  append(kZone);
  EXPECT_FALSE(watch.take_over(watch.sum())) << "nobody has them yet";
  EXPECT_FALSE(watch.take_over(4711)) << "the other's file is another one";
  EXPECT_FALSE(watch.take_over(0)) << "the other has no building";
  EXPECT_TRUE(watch.building().zones.empty());
  EXPECT_TRUE(watch.take_over(sum_now()));
  ASSERT_EQ(watch.building().zones.size(), 1U);
  EXPECT_EQ(watch.sum(), sum_now());
  EXPECT_FALSE(watch.take_over(sum_now())) << "it has them";
}

TEST_F(BuildingWatchTest, TakesOverWhatItsOwnProcessHasWritten) {
  BuildingWatch watch(file_);
  EXPECT_FALSE(watch.take_over());
  append(kZone);
  EXPECT_TRUE(watch.take_over());
  EXPECT_EQ(watch.building().zones.size(), 1U);
}

TEST_F(BuildingWatchTest, KeepsToItsFixturesAndToWhatCanBeRead) {
  BuildingWatch watch(file_);
  const std::string before = read_whole_file(file_);
  append("\n[[fixture]]\nid = 999\nx = 1.0\ny = 1.0\nlength = 1.2\nwidth = 0.3\n");
  EXPECT_FALSE(watch.take_over(sum_now())) << "the localizer has built on the fixtures";
  write_whole_file(file_, before + "\n[[zone]]\nname = ");
  EXPECT_FALSE(watch.take_over()) << "half a file";
  std::filesystem::remove(file_);
  EXPECT_FALSE(watch.take_over());
  EXPECT_TRUE(watch.building().zones.empty());
}

}  // namespace
}  // namespace luminav
