#include "services/jobs/jobs_config.hpp"

#include <gtest/gtest.h>

#include "services/common/configuration/configuration_error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

const std::filesystem::path kLaunch = LUMINAV_SOURCE_DIR "/launch";

TEST(JobsConfig, ReadsTheShippedRobotAndTheBuildingsMap) {
  const JobsConfig config =
      read_jobs_config(kLaunch / "robots/p3dx.toml", kLaunch / "buildings/laboratory/building.toml");
  EXPECT_EQ(config.site.building, "laboratory");
  EXPECT_FALSE(config.site.places.empty());
  EXPECT_EQ(config.site.jobs.home, "") << "nothing drives home by itself where nobody said so";
  EXPECT_EQ(config.robot.sonar.robot_from_sonar.size(), 16U);
  ASSERT_NE(config.site.walls, nullptr);
  EXPECT_EQ(config.site.walls->at({8.5, 2.0}), Prior::kFree);
}

TEST(JobsConfig, ReadsTheJobsFileBesideTheBuildings) {
  const TemporaryFolder folder;
  const auto building = folder.write(
      "building.toml", "name = \"hut\"\nceiling_height = 2.8\n[[place]]\nname = \"dock\"\nx = 1.0\ny = 2.0\n");
  folder.write("jobs.toml", "home = \"dock\"\n[[tour]]\nname = \"t\"\n[[tour.stop]]\nplace = \"dock\"\n");
  const JobSite site = read_jobs_config(kLaunch / "robots/p3dx.toml", building).site;
  EXPECT_EQ(site.jobs.home, "dock");
  ASSERT_EQ(site.jobs.tours.size(), 1U);
  EXPECT_EQ(site.jobs.tours[0].name, "t");
}

TEST(JobsConfig, DemandsAJobsFileThatSomebodyNames) {
  EXPECT_THROW(read_jobs_config(kLaunch / "robots/p3dx.toml", kLaunch / "buildings/laboratory/building.toml",
                                "/nonexistent/jobs.toml"),
               ConfigurationError);
}

}  // namespace
}  // namespace luminav
