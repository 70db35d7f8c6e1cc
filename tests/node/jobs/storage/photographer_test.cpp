#include "services/jobs/storage/photographer.hpp"

#include <gtest/gtest.h>

#include "services/common/process/channels.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/jobs/pretended_robot.hpp"

namespace luminav {
namespace {

class PhotographerTest : public testing::Test {
 protected:
  PhotographerTest() {
    JobsFile jobs;
    jobs.tours = {{.name = "round", .stops = {{.place = "lab", .photo = true}, {.place = "office"}}}};
    robot_.executor.set_jobs(jobs);
    EXPECT_EQ(robot_.ask({.kind = JobKind::kTour, .tour = "round"}), "");
    robot_.run(3.0);
  }

  void take_picture(std::int64_t utime) {
    camera_image_t image{};
    image.utime = utime;
    image.format = camera_image_t::FORMAT_JPEG;
    lcm_.publish(channels::kCameraImage, &image);
    while (lcm_.handleTimeout(0) > 0) {
    }
  }
  [[nodiscard]] bool has_kept_one() const { return std::filesystem::exists(folder_.path() / "photos"); }

  TemporaryFolder folder_;
  lcm::LCM lcm_{"memq://"};
  PretendedRobot robot_;
  JobInputs inputs_{SonarRing{}};
  Photographer photographer_{lcm_, folder_.path() / "photos", robot_.executor, inputs_};
};

TEST_F(PhotographerTest, ListensWhereAPictureIsWantedUntilItIsKept) {
  photographer_.tick(5'000'000);
  EXPECT_FALSE(photographer_.is_listening()) << "on the way";
  robot_.arrive();
  photographer_.tick(6'000'000);
  EXPECT_TRUE(photographer_.is_listening());
  take_picture(5'900'000);
  EXPECT_FALSE(has_kept_one()) << "it was taken on the way";
  take_picture(6'000'000);
  EXPECT_TRUE(has_kept_one());
  photographer_.tick(6'200'000);
  EXPECT_FALSE(photographer_.is_listening());
}

TEST_F(PhotographerTest, GoesOnWithoutAPictureThatCannotBeKeptAndSaysWhy) {
  folder_.write("photos", "a file where a folder should be");
  robot_.arrive();
  photographer_.tick(6'000'000);
  take_picture(6'000'000);
  EXPECT_NE(photographer_.error(), "");
  photographer_.tick(6'200'000);
  EXPECT_FALSE(photographer_.is_listening());
}

}  // namespace
}  // namespace luminav
