#include "services/surveyor/drive/drive_collector.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "services/common/log/log_message.hpp"
#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

odometry_t odometry_at(std::int64_t utime, double x = 0.0) {
  odometry_t message{};
  message.utime = utime;
  message.session = 1;
  message.x = x;
  return message;
}

survey_command_t place(std::int64_t id, const std::string& name) {
  survey_command_t message{};
  message.utime = message.id = id;
  message.action = survey_command_t::ACTION_PLACE;
  message.name = name;
  return message;
}

TEST(DriveCollector, SaysWhatToldNothing) {
  DriveCollector collector;
  EXPECT_TRUE(collector.add(odometry_at(1'000'000)));
  EXPECT_FALSE(collector.add(odometry_at(1'000'000))) << "old";
  EXPECT_FALSE(collector.add(odometry_at(2'000'000, std::numeric_limits<double>::quiet_NaN())));
  EXPECT_FALSE(collector.add(sonar_t{})) << "nothing fresh";
  EXPECT_FALSE(collector.add(camera_image_t{})) << "nobody looks at images";
  EXPECT_THAT(collector.so_far().drive.odometry, SizeIs(1));
}

TEST(DriveCollector, TakesMessagesOfALogAsIfTheyHadJustCome) {
  DriveCollector collector;
  const std::vector<std::uint8_t> bytes = encoded(odometry_at(1'000'000, 2.0));
  EXPECT_TRUE(collector.add(channels::kOdometry, bytes.data(), bytes.size()));
  EXPECT_FALSE(collector.add(channels::kSonar, bytes.data(), bytes.size())) << "of another type";
  EXPECT_FALSE(collector.add(channels::kPose, bytes.data(), bytes.size()));
  EXPECT_FALSE(collector.add(channels::kOdometry, bytes.data(), bytes.size() / 2));
  ASSERT_THAT(collector.so_far().drive.odometry, SizeIs(1));
  EXPECT_EQ(collector.so_far().drive.odometry[0].odom_from_robot.x, 2.0);
}

TEST(DriveCollector, KeepsPosesOfWhichALocalizerWasSure) {
  DriveCollector collector;
  pose_t message{};
  message.utime = 1'000'000;
  message.x = 3.0;
  message.state = pose_t::STATE_AMBIGUOUS;
  EXPECT_FALSE(collector.add(message));
  message.state = pose_t::STATE_TRACKING;
  EXPECT_TRUE(collector.add(message));
  EXPECT_FALSE(collector.add(message)) << "old";
  message.utime = 2'000'000;
  message.y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(collector.add(message));
  ASSERT_THAT(collector.so_far().drive.told, SizeIs(1));
  EXPECT_EQ(collector.so_far().drive.told[0].world_from_robot.x, 3.0);
}

TEST(DriveCollector, KnowsThatNothingWasLeftToExplore) {
  DriveCollector collector;
  survey_command_t message = place(1, kExplored);
  message.action = survey_command_t::ACTION_FINISH;
  EXPECT_TRUE(collector.add(message));
  EXPECT_TRUE(collector.collected().is_explored);
  message.name = "";  // somebody else finished it
  DriveCollector other;
  EXPECT_FALSE(other.add(message));
  EXPECT_FALSE(other.collected().is_explored);
}

TEST(DriveCollector, NamesThePlaceOfTheLastOdometry) {
  DriveCollector collector;
  EXPECT_FALSE(collector.add(place(7, "lift"))) << "nobody knows where";
  collector.add(odometry_at(1'000'000));
  EXPECT_TRUE(collector.add(place(8, "lift")));
  collector.add(odometry_at(2'000'000));
  EXPECT_FALSE(collector.add(place(8, "lift"))) << "repeated";
  ASSERT_THAT(collector.so_far().places, SizeIs(1));
  EXPECT_EQ(collector.so_far().places[0].utime, 1'000'000);
  EXPECT_TRUE(collector.add(place(9, "lift")));
  ASSERT_THAT(collector.so_far().places, SizeIs(1)) << "moved";
  EXPECT_EQ(collector.so_far().places[0].utime, 2'000'000);
}

TEST(DriveCollector, PutsSightingsInTheOrderOfTime) {
  DriveCollector collector;
  for (const std::int64_t utime : {3'000'000, 1'000'000}) {
    fixture_detections_t message{};
    message.utime = utime;
    collector.add(message);
  }
  EXPECT_EQ(collector.collected().drive.frames[0].utime, 1'000'000);
  EXPECT_THAT(collector.collected().places, IsEmpty());
}

}  // namespace
}  // namespace luminav
