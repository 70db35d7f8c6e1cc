#include "drivers/camera/camera_node.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <random>
#include <utility>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kStart = 1'000'000'000'000;

WorldTruth laboratory() {
  WorldTruth truth;
  truth.building.ceiling_height = 2.8;
  truth.robot.camera.mounting.z = 0.3;
  truth.robot.camera.time_offset = 0.030;
  truth.daylight = 0.4;
  for (int i = 0; i < 4; ++i) {
    Fixture fixture;
    fixture.id = i + 1;
    fixture.world_from_fixture = {2.4 * i, 0.3, 0.0};
    truth.building.fixtures.push_back(fixture);
    truth.unlit_darker.push_back(20.0);
    truth.lamp_states.push_back(sim_truth_t::LAMP_ON);
  }
  return truth;
}

/// The node over memq://, the world told to it at 100 Hz, and all that it publishes.
class CameraNodeTest : public testing::Test {
 protected:
  CameraNodeTest() { lcm_.subscribe(channels::kCameraImage, &CameraNodeTest::on_image, this); }

  void start(const CameraConfig& config = {}, const std::vector<ScenarioEvent>& events = {}) {
    WorldTruth world = laboratory();
    world.events = events;
    ceiling_ = std::make_unique<SimulatedCeiling>(world, 5);
    node_ = std::make_unique<CameraNode>(lcm_, config, clock_, *ceiling_);
    truth_.utime = clock_.utime();
    truth_.session = kStart;
    truth_.daylight = 0.4;
    truth_.lamps = 4;
    truth_.lamp_state.assign(4, sim_truth_t::LAMP_ON);
  }
  void step() {
    clock_.advance(10'000);
    truth_.utime = clock_.utime();
    truth_.theta = wrap_angle(truth_.theta + 0.01 * truth_.angular);
    lcm_.publish(channels::kSimTruth, &truth_);
    odometry_t odometry{};
    odometry.utime = clock_.utime();
    odometry.angular = truth_.angular;
    lcm_.publish(channels::kOdometry, &odometry);
    drain();
  }
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(100 * seconds); ++i) {
      step();
    }
  }
  void drain() {
    while (lcm_.handleTimeout(0) > 0) {
    }
  }
  void on_image(const lcm::ReceiveBuffer* buffer, const std::string&) {
    camera_image_t image{};
    ASSERT_GE(image.decode(buffer->data, 0, static_cast<int>(buffer->data_size)), 0);
    images_.push_back(image);
  }

  lcm::LCM lcm_{"memq://"};
  VirtualClock clock_{kStart};
  std::unique_ptr<SimulatedCeiling> ceiling_;
  std::unique_ptr<CameraNode> node_;
  sim_truth_t truth_{};
  std::vector<camera_image_t> images_;
};

TEST_F(CameraNodeTest, PublishesFifteenFramesASecondWithEvenStampsAndNoGaps) {
  start();
  run(4.0);
  ASSERT_GE(images_.size(), 57U);  // 60 but for the time until the first one is whole
  ASSERT_LE(images_.size(), 60U);
  for (std::size_t i = 1; i < images_.size(); ++i) {
    EXPECT_EQ(images_[i].sequence, images_[i - 1].sequence + 1);
    EXPECT_NEAR(static_cast<double>(images_[i].utime - images_[i - 1].utime), 66'667.0, 1.0);
  }
  EXPECT_EQ(images_[0].width, 640);
  EXPECT_EQ(images_[0].height, 480);
  EXPECT_NEAR(images_[0].row_time_us, 52.08, 0.1);
  EXPECT_FALSE(node_->health().fault) << node_->health().reason;
}

TEST_F(CameraNodeTest, StampsAreWrongByTheCamerasTrueTimeOffsetAndNothingElse) {
  start();
  truth_.angular = 0.5;
  run(1.0);
  // The first frame's middle is half a readout and 50 ms after the first truth.
  const double first_truth = static_cast<double>(kStart + 10'000);
  const double true_middle = std::round(first_truth + 12'500.0 + 50'000.0);
  ASSERT_FALSE(images_.empty());
  EXPECT_NEAR(static_cast<double>(images_[0].utime) + 30'000.0, true_middle, 1.0);
}

TEST_F(CameraNodeTest, HandsAPictureOnWhenItArrivesAndWaitsForNoTruthOfThatTime) {
  start();
  while (!node_->time_left()) {
    step();
  }
  clock_.advance(*node_->time_left() - 1);
  node_->poll();
  drain();
  EXPECT_TRUE(images_.empty());
  clock_.advance(1);
  node_->poll();
  drain();
  ASSERT_EQ(images_.size(), 1U);
  const std::int64_t true_middle = images_[0].utime + 30'000;
  // half the readout, half the exposure, the transfer
  EXPECT_NEAR(static_cast<double>(clock_.utime() - true_middle), 12'500.0 + 4'000.0 + 40'000.0, 2.0);
  EXPECT_FALSE(node_->time_left()) << "the next one is not exposed yet";
}

TEST_F(CameraNodeTest, SendsJpegsThatFitIntoADatagramAndDecode) {
  CameraConfig config;
  config.max_size = 20'000;  // less than the quality asked for takes
  start(config);
  run(1.0);
  ASSERT_FALSE(images_.empty());
  JpegDecoder decoder;
  GreyImage decoded;
  for (const camera_image_t& image : images_) {
    EXPECT_EQ(image.format, camera_image_t::FORMAT_JPEG);
    EXPECT_LE(image.size, 20'000);
    EXPECT_LT(image.quality, 85);
    ASSERT_TRUE(decoder.decode(image.data, decoded));
    EXPECT_EQ(decoded.width, 640);
  }
}

/// A picture of noise at first, then only dull ones, 15 a second.
class NoiseThenDull : public FrameSource {
 public:
  bool take(std::int64_t now, Frame& frame) override {
    frame.image = {320, 240, std::vector<std::uint8_t>(320 * 240, 90)};
    frame.utime = now;
    frame.image.pixels[0] = static_cast<std::uint8_t>(80 + now / 1'000'000 % 20);  // no two are equal
    if (std::exchange(is_first_, false)) {
      std::mt19937 rng(7);
      std::generate(frame.image.pixels.begin(), frame.image.pixels.end(),
                    [&] { return static_cast<std::uint8_t>(rng() & 0xffU); });
    }
    return true;
  }
  bool set_exposure(double, double) override { return false; }
  [[nodiscard]] std::string description() const override { return "noise, then dull"; }

 private:
  bool is_first_ = true;
};

TEST_F(CameraNodeTest, ForgetsAPictureThatDidNotFit) {
  CameraConfig config;
  config.max_size = 4'000;
  NoiseThenDull source;
  CameraNode node(lcm_, config, clock_, source);
  node.poll();
  drain();
  EXPECT_TRUE(images_.empty());
  EXPECT_TRUE(node.health().degraded);
  int degraded = 0;
  for (int second = 1; second <= 20; ++second) {
    clock_.advance(1'000'000);
    node.poll();
    degraded += node.health().degraded ? 1 : 0;
  }
  drain();
  EXPECT_EQ(images_.size(), 20U);
  EXPECT_EQ(degraded, 9) << "for ten seconds of pictures";
}

TEST_F(CameraNodeTest, KeepsTheQualityWhereThereIsRoom) {
  start();
  run(1.0);
  ASSERT_FALSE(images_.empty());
  EXPECT_EQ(images_.back().quality, 85);
  EXPECT_LE(images_.back().size, 60'000);
}

TEST_F(CameraNodeTest, SendsRawPicturesWithinOneProgram) {
  CameraConfig config;
  config.encoding = ImageEncoding::kMono8;
  start(config);
  run(0.5);
  ASSERT_FALSE(images_.empty());
  EXPECT_EQ(images_[0].format, camera_image_t::FORMAT_MONO8);
  EXPECT_EQ(images_[0].size, 640 * 480);
}

double mean_grey(const camera_image_t& image) {
  GreyImage decoded;
  JpegDecoder decoder;
  EXPECT_TRUE(decoder.decode(image.data, decoded));
  return measure_brightness(decoded.view(), 225.0).mean;
}

TEST_F(CameraNodeTest, AdaptsItsExposureWhenThePowerIsCut) {
  start();
  run(3.0);
  EXPECT_GE(mean_grey(images_.back()), 78.0);
  const double before = images_.back().exposure_us * images_.back().gain;
  truth_.lamp_state.assign(4, sim_truth_t::LAMP_OFF);
  run(4.0);
  EXPECT_GE(mean_grey(images_.back()), 78.0);
  EXPECT_LE(mean_grey(images_.back()), 122.0);
  EXPECT_GT(images_.back().exposure_us * images_.back().gain, 1.5 * before);
}

TEST_F(CameraNodeTest, TakesPicturesForTheLampsAndForTheCeilingInTurnWhereToldSo) {
  CameraConfig config;
  config.exposure.two_exposures = true;
  start(config);
  run(3.0);
  images_.clear();
  run(4.0);
  const auto is_for_lamps = [](const camera_image_t& image) { return image.exposure_us < 2000.0; };
  EXPECT_NEAR(static_cast<double>(std::count_if(images_.begin(), images_.end(), is_for_lamps)), 30.0, 5.0);
  for (const camera_image_t& image : images_) {
    GreyImage decoded;
    JpegDecoder decoder;
    ASSERT_TRUE(decoder.decode(image.data, decoded));
    const CeilingBrightness brightness = measure_brightness(decoded.view(), 225.0);
    if (is_for_lamps(image)) {
      EXPECT_LT(brightness.mean, 20.0);
      EXPECT_LT(brightness.lamp_share, 0.001) << "no lamp is white in it";
    } else {
      EXPECT_GE(brightness.mean, 78.0);
      EXPECT_GT(brightness.lamp_share, 0.01);
    }
  }
  truth_.lamp_state.assign(4, sim_truth_t::LAMP_OFF);
  run(8.0);
  images_.clear();
  run(2.0);
  EXPECT_EQ(std::count_if(images_.begin(), images_.end(), is_for_lamps), 0) << "nothing burns";
}

TEST_F(CameraNodeTest, HoldsItsExposureWhileTheRobotTurns) {
  start();
  run(3.0);
  const double before = images_.back().exposure_us;
  truth_.angular = 0.6;
  truth_.daylight = 0.15;
  truth_.lamp_state = {sim_truth_t::LAMP_ON, sim_truth_t::LAMP_OFF, sim_truth_t::LAMP_OFF, sim_truth_t::LAMP_OFF};
  run(3.0);
  EXPECT_EQ(images_.back().exposure_us, before);
  EXPECT_LT(mean_grey(images_.back()), 80.0) << "nothing to adapt to, the test is void";
  truth_.angular = 0.0;
  run(3.0);
  EXPECT_GT(images_.back().exposure_us, before);
}

TEST_F(CameraNodeTest, SaysThatItIsTooDarkInTheMessageAndInItsHealth) {
  start();
  truth_.daylight = 0.0;
  truth_.lamp_state.assign(4, sim_truth_t::LAMP_OFF);
  run(12.0);
  EXPECT_NE(images_.back().health.find("too dark"), std::string::npos);
  EXPECT_TRUE(node_->health().degraded);
}

TEST_F(CameraNodeTest, AnUnpluggedCameraIsAFaultAndComesBack) {
  start();
  run(1.0);
  truth_.camera_unplugged = 1;
  run(0.2);
  const std::size_t before = images_.size();
  run(2.0);
  EXPECT_EQ(images_.size(), before);
  EXPECT_TRUE(node_->health().fault);
  truth_.camera_unplugged = 0;
  run(1.0);
  EXPECT_GE(images_.size(), before + 12);
  EXPECT_FALSE(node_->health().fault);
  EXPECT_EQ(images_.back().sequence, static_cast<std::int32_t>(images_.size()) - 1);
}

TEST_F(CameraNodeTest, ANewSessionOfTheSimulatorIsFollowedEvenBackInTime) {
  start();
  run(1.0);
  const std::size_t before = images_.size();
  truth_.session = 2;
  clock_ = VirtualClock(kStart - 50'000'000);
  run(1.0);
  EXPECT_GE(images_.size(), before + 12);
  EXPECT_LT(images_.back().utime, kStart);
}

TEST_F(CameraNodeTest, DropsAndCountsWhatMakesNoSense) {
  start();
  run(1.0);
  const std::size_t before = images_.size();
  sim_truth_t broken = truth_;
  broken.utime += 5'000;
  broken.x = std::numeric_limits<double>::quiet_NaN();
  lcm_.publish(channels::kSimTruth, &broken);
  broken.x = 0.0;
  broken.lamp_state.assign(4, 17);
  lcm_.publish(channels::kSimTruth, &broken);
  lcm_.publish(channels::kSimTruth, &truth_);  // again
  lcm_.publish(channels::kSimTruth, "garbage", 7);
  odometry_t odometry{};
  odometry.utime = clock_.utime() + 1;
  odometry.angular = std::numeric_limits<double>::infinity();
  lcm_.publish(channels::kOdometry, &odometry);
  lcm_.publish(channels::kOdometry, "", 0);
  drain();
  EXPECT_EQ(node_->health().dropped_inputs, 6);
  run(1.0);
  EXPECT_GE(images_.size(), before + 14);
}

TEST_F(CameraNodeTest, WithoutTruthItSaysWhatItWaitsFor) {
  start();
  EXPECT_TRUE(node_->health().fault);
  EXPECT_NE(node_->health().reason.find("SIM_TRUTH"), std::string::npos);
}

TEST_F(CameraNodeTest, TheSameWorldGivesTheSameBytesTwice) {
  std::vector<std::vector<camera_image_t>> runs;
  for (int repetition = 0; repetition < 2; ++repetition) {
    images_.clear();
    node_.reset();
    clock_ = VirtualClock(kStart);
    truth_ = {};
    start();
    truth_.angular = 0.3;
    run(1.5);
    runs.push_back(images_);
  }
  ASSERT_EQ(runs[0].size(), runs[1].size());
  ASSERT_GE(runs[0].size(), 15U);
  for (std::size_t i = 0; i < runs[0].size(); ++i) {
    EXPECT_EQ(runs[0][i].utime, runs[1][i].utime);
    EXPECT_EQ(runs[0][i].data, runs[1][i].data);
  }
}

TEST(CameraConfig, TheShippedRobotIsReadable) {
  const CameraConfig config = read_camera_config(LUMINAV_SOURCE_DIR "/launch/robots/p3dx.toml");
  EXPECT_EQ(config.rate, 15.0);
  EXPECT_EQ(config.encoding, ImageEncoding::kJpeg);
}

TEST(CameraConfig, AnUnknownOrImpossibleKeyIsAnErrorWithFileAndLine) {
  const auto file = std::filesystem::temp_directory_path() / ("luminav-camera-" + std::to_string(getpid()) + ".toml");
  for (const std::string wrong : {"exposre = 3", "rate = 0.0", "encoding = \"png\"", "min_target = 200.0"}) {
    std::filesystem::copy_file(LUMINAV_SOURCE_DIR "/launch/robots/p3dx.toml", file,
                               std::filesystem::copy_options::overwrite_existing);
    std::ifstream in(file);
    std::string text{std::istreambuf_iterator<char>(in), {}};
    std::erase_if(text, [](char letter) { return letter == '\r'; });
    const auto existing = text.find("[camera_driver]");
    if (existing == std::string::npos) {
      text += "\n[camera_driver]\n" + wrong + "\n";
    } else {
      text.insert(existing + 16, wrong + "\n");
    }
    std::ofstream(file) << text;
    try {
      read_camera_config(file);
      ADD_FAILURE() << wrong;
    } catch (const ConfigurationError& error) {
      EXPECT_NE(std::string(error.what()).find(file.filename().string() + ":"), std::string::npos) << error.what();
    }
  }
  std::filesystem::remove(file);
}

TEST_F(CameraNodeTest, PublishesNoPictureOfAFrozenCameraAndSaysSoWithinTwoSeconds) {
  ScenarioEvent freeze;
  freeze.at = 3.0;
  freeze.kind = EventKind::kFreeze;
  freeze.device = "camera";
  freeze.duration = 4.0;
  start({}, {freeze});
  run(2.9);
  EXPECT_EQ(node_->health().reason, "");
  run(1.1);
  EXPECT_TRUE(node_->health().fault);
  EXPECT_NE(node_->health().reason.find("frozen"), std::string::npos);
  const std::size_t before = images_.size();
  run(2.5);
  EXPECT_EQ(images_.size(), before);
  run(2.0);
  EXPECT_EQ(node_->health().reason, "");
  EXPECT_GT(images_.size(), before);
}

TEST_F(CameraNodeTest, SaysThatItIsCoveredWithinTwoSeconds) {
  ScenarioEvent cover;
  cover.at = 3.0;
  cover.kind = EventKind::kCover;
  cover.duration = 4.0;
  start({}, {cover});
  run(2.9);
  EXPECT_EQ(node_->health().reason, "");
  run(2.1);
  EXPECT_TRUE(node_->health().degraded);
  EXPECT_NE(node_->health().reason.find("covered"), std::string::npos);
  EXPECT_EQ(images_.back().health, node_->health().reason);
  run(8.0);
  EXPECT_EQ(node_->health().reason, "");
}

}  // namespace
}  // namespace luminav
