#include "services/common/tours/jobs_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/configuration/configuration_error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Building laboratory() {
  Building building;
  building.name = "laboratory";
  building.places = {{"lift", {1.0, 2.0, 0.0}, true}, {"dock", {}, true}};
  return building;
}

JobsSource read(const std::string& text) {
  const TemporaryFolder folder;
  return read_jobs_source(folder.write("jobs.toml", text), laboratory());
}

std::string complaint(const std::string& text) {
  try {
    read(text);
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "none";
}

TEST(JobsFile, ReadsHomeAndToursWithTheirLines) {
  const JobsSource source = read(R"(home = "dock"
charger = true
[[tour]]
name = "morning"
at = "09:30"
days = "Mo-Fr"
[[tour.stop]]
place = "lift"
pause = 20
text = "The lift."
photo = true
[[tour.stop]]
place = "dock"
)");
  EXPECT_EQ(source.jobs.home, "dock");
  EXPECT_TRUE(source.jobs.has_charger);
  ASSERT_EQ(source.jobs.tours.size(), 1U);
  const Tour& tour = source.jobs.tours[0];
  EXPECT_EQ(tour.at, 34'200);
  EXPECT_THAT(tour.days, ElementsAre(true, true, true, true, true, false, false));
  ASSERT_EQ(tour.stops.size(), 2U);
  EXPECT_EQ(tour.stops[0].pause, 20.0);
  EXPECT_EQ(tour.stops[0].text, "The lift.");
  EXPECT_TRUE(tour.stops[0].photo);
  EXPECT_FALSE(tour.stops[1].photo);
  EXPECT_EQ(source.lines[0].tour, 3);
  EXPECT_THAT(source.lines[0].stops, ElementsAre(7, 12));
}

TEST(JobsFile, SaysNothingWhereItIsNot) {
  const TemporaryFolder folder;
  EXPECT_TRUE(read_jobs_file(folder.path() / "jobs.toml", laboratory()).tours.empty());
}

TEST(JobsFile, SaysWhatIsWrong) {
  const std::string tour = "[[tour]]\nname = \"t\"\n";
  const std::string stop = "[[tour.stop]]\nplace = \"lift\"\n";
  EXPECT_EQ(complaint(tour + stop), "none");
  EXPECT_THAT(complaint("home = \"attic\""), HasSubstr("laboratory has no place \"attic\""));
  EXPECT_THAT(complaint(tour), HasSubstr("a tour has 1 to 20"));
  EXPECT_THAT(complaint(tour + "at = \"25:00\"\n" + stop), HasSubstr("time of day as 09:30"));
  EXPECT_THAT(complaint(tour + "days = \"weekdays\"\n" + stop), HasSubstr("days as Mo-Fr"));
  EXPECT_THAT(complaint(tour + stop + tour + stop), HasSubstr("two tours \"t\""));
  EXPECT_THAT(complaint(tour + stop + "pause = -1\n"), HasSubstr("pause"));
  EXPECT_THAT(complaint(tour + "[[tour.stop]]\nplace = \"attic\"\n"), HasSubstr("no place \"attic\""));
  EXPECT_THAT(complaint("hours = 3"), HasSubstr("hours"));
  std::string many;
  for (int i = 0; i < 51; ++i) {
    many += "[[tour]]\nname = \"" + std::to_string(i) + "\"\n" + stop;
  }
  EXPECT_THAT(complaint(many), HasSubstr("50 tours at most"));
}

}  // namespace
}  // namespace luminav
