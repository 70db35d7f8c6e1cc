#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <luminav/camera_image_t.hpp>
#include <luminav/fixture_detections_t.hpp>
#include <vector>

#include "services/common/image/jpeg_codec.hpp"
#include "services/common/process/channels.hpp"
#include "services/detector/detector_node.hpp"
#include "tests/unit/detector/ceiling_picture.hpp"

namespace luminav {
namespace {

class DetectorNodeTest : public testing::Test {
 protected:
  DetectorNodeTest() { subscriber_.on(channels::kFixtureDetections, &DetectorNodeTest::on_detections, this); }

  void on_detections(const fixture_detections_t& message) { received_.push_back(message); }

  static DetectorConfig config() {
    DetectorConfig config;
    config.camera = test::test_camera();
    config.camera.time_offset = 0.012;  // for the localizer to add
    config.catalogue = test::test_catalogue();
    return config;
  }

  static camera_image_t mono8(const GreyImage& image) {
    camera_image_t message{};
    message.utime = 5'000'000;
    message.sequence = 7;
    message.width = image.width;
    message.height = image.height;
    message.format = camera_image_t::FORMAT_MONO8;
    message.size = static_cast<std::int32_t>(image.pixels.size());
    message.data.assign(image.pixels.begin(), image.pixels.end());
    return message;
  }

  static GreyImage picture_with_one_fixture() {
    test::DrawnCeiling ceiling;
    ceiling.shapes = {{.pose = {0.1, -0.1, 0.6}}};
    return test::draw_ceiling(ceiling, test::test_camera(), 2.8);
  }

  void send(const camera_image_t& message) {
    lcm_.publish(channels::kCameraImage, &message);
    while (lcm_.handleTimeout(0) > 0) {
    }
  }

  lcm::LCM lcm_{"memq://"};
  Subscriber subscriber_{lcm_};
  std::vector<fixture_detections_t> received_;
};

TEST_F(DetectorNodeTest, AnswersAnImageWithItsFixtureAndItsCorrectedTime) {
  DetectorNode node(lcm_, config());
  camera_image_t image = mono8(picture_with_one_fixture());
  image.exposure_us = 4000.0;
  send(image);
  ASSERT_EQ(received_.size(), 1U);
  EXPECT_EQ(received_[0].exposure_us, 4000.0);
  EXPECT_EQ(received_[0].utime, 5'000'000);
  EXPECT_EQ(received_[0].sequence, 7);
  ASSERT_EQ(received_[0].count, 1);
  const fixture_detection_t& detection = received_[0].detections[0];
  EXPECT_EQ(detection.shape, fixture_detection_t::SHAPE_RECTANGLE);
  EXPECT_EQ(detection.state, fixture_detection_t::STATE_LIT);
  EXPECT_NEAR(detection.x, 0.1, 2e-3);
  EXPECT_NEAR(detection.y, -0.1, 2e-3);
  EXPECT_NEAR(detection.theta, 0.6, 2e-3);
  EXPECT_GT(detection.covariance[0], 0.0);
  EXPECT_NEAR(received_[0].median_grey, 110.0, 5.0);
}

TEST_F(DetectorNodeTest, AnswersAnEmptyCeilingToo) {
  DetectorNode node(lcm_, config());
  send(mono8(test::draw_ceiling({}, test::test_camera(), 2.8)));
  ASSERT_EQ(received_.size(), 1U);
  EXPECT_EQ(received_[0].count, 0);
}

TEST_F(DetectorNodeTest, ReadsJpegAndDropsDamagedOnes) {
  DetectorNode node(lcm_, config());
  const GreyImage image = picture_with_one_fixture();
  JpegEncoder encoder;
  const auto bytes = encoder.encode(image.view(), 85);
  camera_image_t message = mono8(image);
  message.format = camera_image_t::FORMAT_JPEG;
  message.quality = 85;
  message.data.assign(bytes.begin(), bytes.end());
  message.size = static_cast<std::int32_t>(message.data.size());
  send(message);
  ASSERT_EQ(received_.size(), 1U);
  EXPECT_EQ(received_[0].count, 1);
  EXPECT_EQ(node.health().dropped_inputs, 0);

  message.data.resize(message.data.size() / 2);
  message.size = static_cast<std::int32_t>(message.data.size());
  send(message);
  EXPECT_EQ(received_.size(), 1U);
  EXPECT_EQ(node.health().dropped_inputs, 1);
}

TEST_F(DetectorNodeTest, RefusesAnotherAspectAndSaysBothSizes) {
  DetectorNode node(lcm_, config());
  send(mono8({320, 200, std::vector<std::uint8_t>(320 * 200, 90)}));
  EXPECT_TRUE(received_.empty());
  EXPECT_TRUE(node.health().degraded);
  EXPECT_THAT(node.health().reason, testing::HasSubstr("320 x 200"));
  EXPECT_THAT(node.health().reason, testing::HasSubstr("640 x 480"));
  send(mono8(picture_with_one_fixture()));
  EXPECT_EQ(received_.size(), 1U);
  EXPECT_FALSE(node.health().degraded);
}

TEST_F(DetectorNodeTest, DropsSizesThatDoNotMatchTheData) {
  DetectorNode node(lcm_, config());
  camera_image_t message = mono8(picture_with_one_fixture());
  message.width = -640;
  send(message);
  message.width = 1 << 20;
  send(message);
  message.width = 640;
  message.format = 9;
  send(message);
  EXPECT_TRUE(received_.empty());
  EXPECT_EQ(node.health().dropped_inputs, 3);
}

TEST_F(DetectorNodeTest, SurvivesBytesThatDoNotDecode) {
  DetectorNode node(lcm_, config());
  const std::vector<std::uint8_t> rubbish(200, 0x5a);
  lcm_.publish(channels::kCameraImage, rubbish.data(), static_cast<unsigned>(rubbish.size()));
  while (lcm_.handleTimeout(0) > 0) {
  }
  EXPECT_EQ(node.health().dropped_inputs, 1);
  send(mono8(picture_with_one_fixture()));
  EXPECT_EQ(received_.size(), 1U);
}

class DetectorConfigTest : public testing::Test {
 protected:
  static std::filesystem::path launch() { return std::filesystem::path(LUMINAV_SOURCE_DIR) / "launch"; }

  static std::filesystem::path robot_with(const std::string& text) {
    std::ifstream in(launch() / "robots/p3dx.toml");
    const std::string whole((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    const auto file = std::filesystem::path(testing::TempDir()) / "detector_robot.toml";
    std::ofstream(file) << whole << "\n" << text << "\n";
    return file;
  }
};

TEST_F(DetectorConfigTest, ReadsWhatIsShipped) {
  const DetectorConfig config =
      read_detector_config(launch() / "robots/p3dx.toml", launch() / "buildings/laboratory/building.toml");
  EXPECT_EQ(config.catalogue.fixtures.size(), 2U);
  EXPECT_FALSE(config.catalogue.elements.empty());
}

TEST_F(DetectorConfigTest, RefusesKeysThatItDoesNotKnow) {
  const auto robot = robot_with("[detector.modern]\nlit_contrasts = 3.0");
  EXPECT_THROW(read_detector_config(robot, launch() / "buildings/laboratory/building.toml"), ConfigurationError);
}

}  // namespace
}  // namespace luminav
