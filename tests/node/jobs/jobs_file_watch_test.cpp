#include "services/jobs/jobs_file_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/configuration/whole_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

using ::testing::HasSubstr;

constexpr const char* kTour = "[[tour]]\nname = \"t\"\n[[tour.stop]]\nplace = \"lift\"\n";

class JobsFileWatchTest : public testing::Test {
 protected:
  JobsFileWatchTest() {
    building_.name = "laboratory";
    building_.places = {{"lift", {1.0, 2.0, 0.0}, true}};
  }
  /// How many tours the file has, if it says something new; else -1.
  int look() {
    const std::optional<JobsFile> jobs = watch_.look(building_);
    return jobs ? static_cast<int>(jobs->tours.size()) : -1;
  }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "jobs.toml";
  Building building_;
  JobsFileWatch watch_{file_};
};

TEST_F(JobsFileWatchTest, TakesAFileOverThatComesChangesAndGoes) {
  EXPECT_EQ(look(), 0);
  write_whole_file(file_, kTour);
  EXPECT_EQ(look(), 1);
  EXPECT_EQ(look(), -1) << "it says nothing new";
  write_whole_file(file_, std::string(kTour) + "# a remark\n");
  EXPECT_EQ(look(), 1);
  std::filesystem::remove(file_);
  EXPECT_EQ(look(), 0);
}

TEST_F(JobsFileWatchTest, SaysWhatIsWrongUntilItIsMended) {
  write_whole_file(file_, kTour);
  EXPECT_EQ(look(), 1);
  write_whole_file(file_, std::string(kTour) + "hours = 3\n");
  EXPECT_EQ(look(), -1);
  EXPECT_THAT(watch_.objection(), HasSubstr("hours"));
  write_whole_file(file_, kTour);
  EXPECT_EQ(look(), 1);
  EXPECT_EQ(watch_.objection(), "");
}

TEST_F(JobsFileWatchTest, WaitsForThePlaceThatATourNeeds) {
  write_whole_file(file_, "[[tour]]\nname = \"t\"\n[[tour.stop]]\nplace = \"attic\"\n");
  EXPECT_EQ(look(), -1);
  EXPECT_THAT(watch_.objection(), HasSubstr("no place \"attic\""));
  building_.places.push_back({"attic", {}, false});
  EXPECT_EQ(look(), 1);
}

}  // namespace
}  // namespace luminav
