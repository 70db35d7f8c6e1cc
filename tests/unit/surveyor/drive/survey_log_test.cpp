#include "services/surveyor/drive/survey_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <lcm/lcm-cpp.hpp>
#include <luminav/camera_image_t.hpp>
#include <luminav/fixture_detections_t.hpp>
#include <luminav/odometry_t.hpp>
#include <luminav/sonar_t.hpp>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

const char* const kRobot = LUMINAV_SOURCE_DIR "/launch/robots/p3dx.toml";

class SurveyLogTest : public testing::Test {
 protected:
  template <typename Message>
  void write(lcm::LogFile& log, const char* channel, const Message& message) {
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    lcm::LogEvent event{};
    event.timestamp = message.utime;
    event.channel = channel;
    event.datalen = static_cast<std::int32_t>(bytes.size());
    event.data = bytes.data();
    log.writeEvent(&event);
  }

  /// A second of odometry and a sonar reading.
  void write_base(lcm::LogFile& log) {
    for (int i = 0; i <= 10; ++i) {
      odometry_t odometry{};
      odometry.utime = 1'000'000 + 100'000 * i;
      odometry.session = 1;
      odometry.x = 0.05 * i;
      write(log, channels::kOdometry, odometry);
    }
    sonar_t sonar{};
    sonar.utime = 1'500'000;
    sonar.count = 2;
    sonar.range = {1.5F, 5.0F};
    sonar.has_echo = {1, 0};
    sonar.fresh = {1, 0};
    sonar.range_utime = {1'450'000, 0};
    write(log, channels::kSonar, sonar);
  }

  static fixture_detections_t detections(std::int8_t shape) {
    fixture_detections_t message{};
    message.utime = 1'234'000;
    message.count = 1;
    fixture_detection_t detection{};
    detection.shape = shape;
    detection.x = 0.5;
    detection.length = 1.2;
    detection.width = 0.3;
    detection.covariance[0] = detection.covariance[4] = detection.covariance[8] = 1e-4;
    message.detections.push_back(detection);
    return message;
  }

  static camera_image_t grey_image() {
    camera_image_t image{};
    image.utime = 1'300'000;
    image.width = 640;
    image.height = 480;
    image.format = camera_image_t::FORMAT_MONO8;
    image.data.assign(640 * 480, 90);
    image.size = static_cast<std::int32_t>(image.data.size());
    return image;
  }

  [[nodiscard]] SurveyLog read(SightingSource source = SightingSource::kImagesElseDetections) const {
    CeilingKinds kinds;
    kinds.kinds.emplace_back();
    return read_survey_log(file_, kRobot, kinds, source);
  }

  std::string file_ = testing::TempDir() + "/survey.lcm";
};

TEST_F(SurveyLogTest, ReadsOdometrySonarAndDetections) {
  {
    lcm::LogFile log(file_, "w");
    write_base(log);
    write(log, channels::kFixtureDetections, detections(fixture_detection_t::SHAPE_RECTANGLE));
    write(log, channels::kFixtureDetections, detections(fixture_detection_t::SHAPE_ELEMENT));
  }
  const SurveyLog log = read();
  EXPECT_EQ(log.drive.odometry.size(), 11u);
  ASSERT_EQ(log.drive.echoes.size(), 1u);
  EXPECT_EQ(log.drive.echoes[0].utime, 1'450'000);
  ASSERT_EQ(log.drive.frames.size(), 2u);
  EXPECT_EQ(log.drive.frames[0].sightings.size(), 1u);
  EXPECT_TRUE(log.drive.frames[1].sightings.empty());  // a vent is no fixture
  EXPECT_NEAR(log.longest_gap, 0.1, 1e-9);
  EXPECT_FALSE(log.is_cut);
}

TEST_F(SurveyLogTest, LooksAtImagesFartherApartThanTheyWereTaken) {
  {
    lcm::LogFile log(file_, "w");
    write_base(log);
    write(log, channels::kCameraImage, grey_image());
    write(log, channels::kCameraImage, grey_image());
    write(log, channels::kFixtureDetections, detections(fixture_detection_t::SHAPE_RECTANGLE));
  }
  const SurveyLog log = read();
  EXPECT_EQ(log.images, 2u);
  EXPECT_EQ(log.looked_at, 1u);
  EXPECT_TRUE(log.drive.has_lengths);
  ASSERT_EQ(log.drive.frames.size(), 1u);
  EXPECT_EQ(log.drive.frames[0].utime, 1'300'000);
  EXPECT_TRUE(log.drive.frames[0].sightings.empty());
}

TEST_F(SurveyLogTest, TakesTheDetectionsWhenAsked) {
  {
    lcm::LogFile log(file_, "w");
    write_base(log);
    write(log, channels::kFixtureDetections, detections(fixture_detection_t::SHAPE_RECTANGLE));
    write(log, channels::kCameraImage, grey_image());
  }
  const SurveyLog log = read(SightingSource::kDetections);
  EXPECT_EQ(log.looked_at, 0u);
  EXPECT_FALSE(log.drive.has_lengths);
  ASSERT_EQ(log.drive.frames.size(), 1u);
  EXPECT_EQ(log.drive.frames[0].sightings.size(), 1u);
}

TEST_F(SurveyLogTest, TakesWhatIsWholeOfALogThatWasCut) {
  {
    lcm::LogFile log(file_, "w");
    write_base(log);
  }
  std::filesystem::resize_file(file_, std::filesystem::file_size(file_) - 10);
  const SurveyLog log = read();
  EXPECT_TRUE(log.is_cut);
  EXPECT_EQ(log.drive.odometry.size(), 11u);
  EXPECT_TRUE(log.drive.echoes.empty());
}

TEST_F(SurveyLogTest, SaysWhichFileIsMissing) {
  file_ = "/nowhere/survey.lcm";
  EXPECT_THROW((void)read(), std::runtime_error);
}

OdometryReading reading(std::int64_t utime, std::int64_t session) {
  OdometryReading result;
  result.utime = utime;
  result.session = session;
  return result;
}

TEST(SurveyLogs, FollowOneAnotherWithClocksAndSessionsThatBeganAnew) {
  SurveyLog first;
  first.drive.odometry = {reading(1'000'000, 1), reading(2'000'000, 2)};
  first.drive.has_lengths = true;
  first.images = 3;
  SurveyLog second;
  second.drive.odometry = {reading(500'000, 1), reading(600'000, 1), reading(700'000, 2)};
  second.drive.frames.resize(1);
  second.drive.frames[0].utime = 550'000;
  second.places = {{"lift", 600'000, 1}};
  second.drive.has_lengths = true;
  second.is_cut = true;
  const SurveyLog all = one_after_another({first, second});
  ASSERT_EQ(all.drive.odometry.size(), 5U);
  EXPECT_NE(all.drive.odometry[2].session, all.drive.odometry[1].session);
  EXPECT_EQ(all.drive.odometry[3].session, all.drive.odometry[2].session);
  EXPECT_NE(all.drive.odometry[4].session, all.drive.odometry[3].session);
  EXPECT_GT(all.drive.odometry[2].utime, all.drive.odometry[1].utime);
  const std::int64_t shift = all.drive.odometry[2].utime - 500'000;
  EXPECT_EQ(all.drive.frames[0].utime, 550'000 + shift);
  EXPECT_EQ(all.places[0].utime, 600'000 + shift);
  EXPECT_EQ(all.images, 3U);
  EXPECT_TRUE(all.is_cut);
  EXPECT_TRUE(all.drive.has_lengths);
}

}  // namespace
}  // namespace luminav
