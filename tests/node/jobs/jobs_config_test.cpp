#include "services/jobs/jobs_config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/configuration/configuration_error.hpp"
#include "services/jobs/jobs_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::filesystem::path kLaunch = LUMINAV_SOURCE_DIR "/launch";

JobSite read(const std::string& text) {
  const TemporaryFolder folder;
  JobSite site{.building = "laboratory", .places = {{"lift", {1.0, 2.0, 0.0}, true}, {"dock", {}, true}}};
  read_jobs_file(folder.write("jobs.toml", text), site);
  return site;
}

std::string complaint(const std::string& text) {
  try {
    read(text);
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "none";
}

TEST(JobsConfig, ReadsTheShippedRobotAndTheBuildingsMap) {
  const JobsConfig config =
      read_jobs_config(kLaunch / "robots/p3dx.toml", kLaunch / "buildings/laboratory/building.toml");
  EXPECT_EQ(config.site.building, "laboratory");
  EXPECT_FALSE(config.site.places.empty());
  EXPECT_EQ(config.site.home, "") << "nothing drives home by itself where nobody said so";
  EXPECT_EQ(config.robot.sonar.robot_from_sonar.size(), 16U);
  ASSERT_NE(config.site.walls, nullptr);
  EXPECT_EQ(config.site.walls->at({8.5, 2.0}), Prior::kFree);
}

TEST(JobsConfig, ReadsHomeAndTours) {
  const JobSite site = read(R"(
home = "dock"
charger = true
[[tour]]
name = "morning"
at = "09:30"
days = "Mo-Fr"
[[tour.stop]]
place = "lift"
pause = 20
text = "The lift."
[[tour.stop]]
place = "dock"
)");
  EXPECT_EQ(site.home, "dock");
  EXPECT_TRUE(site.has_charger);
  ASSERT_EQ(site.tours.size(), 1U);
  EXPECT_EQ(site.tours[0].at, 34'200);
  EXPECT_THAT(site.tours[0].days, ElementsAre(true, true, true, true, true, false, false));
  ASSERT_EQ(site.tours[0].stops.size(), 2U);
  EXPECT_EQ(site.tours[0].stops[0].pause, 20.0);
  EXPECT_EQ(site.tours[0].stops[0].text, "The lift.");
}

TEST(JobsConfig, SaysWhatIsWrongWithAJobsFile) {
  const std::string tour = "[[tour]]\nname = \"t\"\n";
  const std::string stop = "[[tour.stop]]\nplace = \"lift\"\n";
  EXPECT_THAT(complaint("home = \"attic\""), HasSubstr("laboratory has no place \"attic\""));
  EXPECT_THAT(complaint(tour), HasSubstr("a tour has 1 to 20"));
  EXPECT_THAT(complaint(tour + "at = \"25:00\"\n" + stop), HasSubstr("time of day as 09:30"));
  EXPECT_THAT(complaint(tour + "days = \"weekdays\"\n" + stop), HasSubstr("days as Mo-Fr"));
  EXPECT_THAT(complaint(tour + stop + tour + stop), HasSubstr("two tours \"t\""));
  EXPECT_THAT(complaint(tour + stop + "pause = -1\n"), HasSubstr("pause"));
  EXPECT_THAT(complaint(tour + "[[tour.stop]]\nplace = \"attic\"\n"), HasSubstr("no place \"attic\""));
  EXPECT_THAT(complaint("hours = 3"), HasSubstr("hours"));
}

}  // namespace
}  // namespace luminav
