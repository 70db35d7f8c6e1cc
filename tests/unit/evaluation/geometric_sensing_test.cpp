#include "tests/evaluation/sensing/geometric_sensing.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "services/common/configuration/toml_table.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/subscriber.hpp"
#include "tests/evaluation/sensing/sensing_survey.hpp"

namespace luminav {
namespace {

/// One fixture overhead, lit; a robot that stands or drives below it, and whoever listens to the detections.
class Sensed {
 public:
  explicit Sensed(DetectorBehaviour behaviour, double speed = 0.0, std::uint64_t seed = 1)
      : behaviour_(std::move(behaviour)), speed_(speed), subscriber_(lcm_) {
    Fixture fixture;
    fixture.id = 1;
    world_.building.fixtures = {fixture};
    world_.robot.camera.mounting.z = 0.3;
    world_.robot.camera.time_offset = 0.02;
    world_.lamp_states = {sim_truth_t::LAMP_ON};
    world_.unlit_darker = {20.0};
    CameraDescription believed;
    believed.mounting.z = 0.3;
    believed.row_time = world_.robot.camera.row_time;
    sensing_.emplace(lcm_, world_, world_.building, believed, behaviour_, seed);
    subscriber_.on(channels::kFixtureDetections, &Sensed::on_detections, this);
  }

  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(100.0 * seconds); ++i) {
      utime_ += 10'000;
      sim_truth_t truth{};
      truth.utime = utime_;
      truth.session = 1;
      truth.sequence = ++sequence_;
      truth.x = -0.2 + 0.5 * std::sin(speed_ * sequence_ * 0.01);  // to and fro
      truth.lamp_state = {sim_truth_t::LAMP_ON};
      truth.lamps = 1;
      truth.camera_unplugged = unplugged ? 1 : 0;
      sensing_->on_truth(truth);
      while (lcm_.handleTimeout(0) > 0) {
      }
    }
  }
  void on_detections(const fixture_detections_t& message) { messages.push_back(message); }

  [[nodiscard]] double seen_share() const {
    double seen = 0.0;
    for (const auto& message : messages) {
      seen += message.count > 0 ? 1.0 : 0.0;
    }
    return seen / static_cast<double>(messages.size());
  }

  std::vector<fixture_detections_t> messages;
  bool unplugged = false;

 private:
  lcm::LCM lcm_{"memq://"};
  DetectorBehaviour behaviour_;
  double speed_;
  WorldTruth world_;
  std::optional<GeometricSensing> sensing_;
  Subscriber subscriber_;
  std::int64_t utime_ = 1'000'000'000;
  std::int32_t sequence_ = 0;
};

/// Sees every fixture with this probability and these errors, whatever the circumstances.
DetectorBehaviour behaviour(double probability, std::vector<MeasuredSighting> errors, double keep = 0.0) {
  DetectorBehaviour b;
  for (auto& bin : b.bins) {
    bin = {1000, static_cast<std::int64_t>(1000.0 * probability)};
  }
  while (errors.size() < 8) {
    errors.push_back(errors.back());
  }
  for (auto& list : b.sightings) {
    list = errors;
  }
  b.keep_seen.fill(keep);
  b.keep_error.fill(keep);
  b.prepare();
  return b;
}

MeasuredSighting exact() {
  MeasuredSighting sighting;
  sighting.near_end = sighting.far_end = true;
  sighting.state = fixture_detection_t::STATE_LIT;
  return sighting;
}

TEST(GeometricSensing, SendsAFrameWhenTheCameraWould) {
  Sensed sensed(behaviour(1.0, {exact()}));
  sensed.run(10.2);
  // 15 frames a second, the first after 50 ms and each 52.5 ms + 40 ms late
  EXPECT_NEAR(static_cast<double>(sensed.messages.size()), 150.0, 3.0);
  for (std::size_t i = 1; i < sensed.messages.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(sensed.messages[i].utime - sensed.messages[i - 1].utime), 66'667.0, 1.0);
  }
}

TEST(GeometricSensing, ReportsTheFixtureWhereItIs) {
  Sensed sensed(behaviour(1.0, {exact()}));
  sensed.run(1.0);
  ASSERT_FALSE(sensed.messages.empty());
  ASSERT_EQ(sensed.messages[0].count, 1);
  EXPECT_NEAR(sensed.messages[0].detections[0].x, 0.2, 1e-3);
  EXPECT_NEAR(sensed.messages[0].detections[0].y, 0.0, 1e-3);
  EXPECT_EQ(sensed.messages[0].detections[0].state, fixture_detection_t::STATE_LIT);
}

TEST(GeometricSensing, DrawsTheMeasuredErrorsAndCovariance) {
  MeasuredSighting off = exact();
  off.along = 0.010;
  off.across = -0.004;
  off.turn = 0.02;
  off.sigma_along = 0.012;
  off.sigma_turn = 0.03;
  Sensed sensed(behaviour(1.0, {off}));
  sensed.run(1.0);
  const fixture_detection_t& d = sensed.messages.at(0).detections.at(0);
  EXPECT_NEAR(d.x, 0.2 + 0.010, 1e-3);
  EXPECT_NEAR(d.y, -0.004, 1e-3);
  EXPECT_NEAR(d.theta, 0.02, 1e-3);
  EXPECT_NEAR(d.covariance[0], 0.012 * 0.012, 1e-6);
  EXPECT_NEAR(d.covariance[8], 0.03 * 0.03, 1e-9);
}

TEST(GeometricSensing, SeesAsOftenAsMeasured) {
  for (const double keep : {0.0, 0.8}) {
    Sensed sensed(behaviour(0.7, {exact()}, keep));
    sensed.run(400.0);
    // 6,000 frames; kept outcomes leave 6,000 (1 - keep) / (1 + keep) independent ones
    EXPECT_NEAR(sensed.seen_share(), 0.7, 4.0 * std::sqrt(0.21 / (6000.0 * (1.0 - keep) / (1.0 + keep)))) << keep;
  }
}

TEST(GeometricSensing, KeepsItsLuckFromFrameToFrameAsMeasured) {
  Sensed sensed(behaviour(0.5, {exact()}, 0.9));
  sensed.run(400.0);
  int same = 0;
  for (std::size_t i = 1; i < sensed.messages.size(); ++i) {
    same += sensed.messages[i].count == sensed.messages[i - 1].count ? 1 : 0;
  }
  // kept, or drawn the same again: 0.9 + 0.1 * 0.5
  EXPECT_NEAR(same / static_cast<double>(sensed.messages.size()), 0.95, 0.015);
}

TEST(GeometricSensing, RaisesFalseAlarmsThatStayWhereTheyAreInTheWorld) {
  DetectorBehaviour b = behaviour(0.0, {exact()});
  b.false_alarms_begin = 0.05;
  b.false_alarms_last = 0.8;
  MeasuredFalseAlarm alarm;
  alarm.robot_from_fixture = {0.3, 0.1, 0.2};
  alarm.covariance = {1e-4, 0, 0, 0, 1e-4, 0, 0, 0, 1e-4};
  alarm.length = 1.2;
  alarm.width = 0.3;
  b.false_alarms = {alarm};
  Sensed sensed(b);
  sensed.run(200.0);
  double alarms = 0.0;
  for (const auto& message : sensed.messages) {
    alarms += message.count;
    for (const auto& detection : message.detections) {
      EXPECT_NEAR(detection.x, 0.3, 1e-6);  // the robot stands
    }
  }
  // each lasts 1 / (1 - 0.8) = 5 frames
  EXPECT_NEAR(alarms / static_cast<double>(sensed.messages.size()), 0.25, 0.06);
}

TEST(GeometricSensing, IsSilentWhileTheCameraIsUnplugged) {
  Sensed sensed(behaviour(1.0, {exact()}));
  sensed.run(1.0);
  sensed.unplugged = true;
  sensed.messages.clear();
  sensed.run(2.0);
  EXPECT_TRUE(sensed.messages.empty());
  sensed.unplugged = false;
  sensed.run(1.0);
  EXPECT_GT(sensed.messages.size(), 10U);
}

TEST(GeometricSensing, GivesTheSameForTheSameSeed) {
  const DetectorBehaviour b = behaviour(0.5, {exact()}, 0.3);
  Sensed first(b, 0.5, 7);
  Sensed second(b, 0.5, 7);
  Sensed other(b, 0.5, 8);
  first.run(20.0);
  second.run(20.0);
  other.run(20.0);
  ASSERT_EQ(first.messages.size(), second.messages.size());
  bool all_like_other = true;
  for (std::size_t i = 0; i < first.messages.size(); ++i) {
    EXPECT_EQ(first.messages[i].count, second.messages[i].count);
    all_like_other = all_like_other && first.messages[i].count == other.messages[i].count;
  }
  EXPECT_FALSE(all_like_other);
}

TEST(FitBehaviour, GetsBackWhatTheSurveyedRunsDid) {
  // A fixture that is seen in blocks: the outcome is drawn anew with probability 0.2.
  SplitMix generator(1);
  SensingSurveyResult run;
  bool seen = true;
  double error = 0.0;
  for (std::int64_t frame = 0; frame < 40'000; ++frame) {
    if (generator.uniform() < 0.2) {
      seen = generator.uniform() < 0.6;
    }
    if (generator.uniform() < 0.5) {
      error = 0.01 * generator.uniform();
    }
    SurveyedSighting sighting;
    sighting.sighting = {0, 0, 2, 8, 0};
    sighting.frame = frame;
    sighting.motion = 0;
    if (seen) {
      sighting.seen = exact();
      sighting.seen->across = error;
    }
    run.sightings.push_back(sighting);
  }
  run.frames = 40'000;
  run.false_begins = 200;
  run.false_frames = 800;
  const DetectorBehaviour fitted = fit_behaviour({run}, "modern", "test");
  EXPECT_NEAR(fitted.seen_probability({0, 0, 2, 8, 0}), 0.6, 0.02);
  EXPECT_NEAR(fitted.keep_seen[0], 0.8, 0.03);
  EXPECT_NEAR(fitted.keep_error[0], 0.5, 0.05);
  EXPECT_NEAR(fitted.false_alarms_begin, 0.005, 1e-9);
  EXPECT_NEAR(fitted.false_alarms_last, 0.75, 1e-9);
  EXPECT_EQ(fitted.errors({0, 0, 2, 8, 0}).size(), 60U);
}

TEST(DetectorBehaviour, FallsBackOnTheClassMostAlike) {
  DetectorBehaviour b;
  b.bins[static_cast<std::size_t>(SightingClass{0, 0, 2, 8, 0}.index())] = {100, 90};
  b.bins[static_cast<std::size_t>(SightingClass{0, 2, 2, 8, 0}.index())] = {100, 20};
  b.prepare();
  EXPECT_EQ(b.seen_probability({0, 0, 2, 8, 2}), 0.9);  // turning fast: never measured
  EXPECT_EQ(b.seen_probability({0, 4, 2, 8, 0}), 0.2);  // unlit, darker: like unlit
  EXPECT_EQ(b.seen_probability({1, 0, 2, 8, 0}), 0.9);  // a square one: like a rectangle of that light
}

TEST(DetectorBehaviour, TheShippedFilesCanBeRead) {
  const DetectorBehaviour shipped =
      read_detector_behaviour(LUMINAV_SOURCE_DIR "/tests/evaluation/behaviour-modern.json");
  EXPECT_EQ(shipped.mode, "modern");
  EXPECT_GT(shipped.seen_probability({0, 0, 2, 8, 0}), 0.8);  // a lit fixture, whole in the image
  EXPECT_FALSE(shipped.errors({0, 0, 2, 8, 0}).empty());
  EXPECT_EQ(read_detector_behaviour(LUMINAV_SOURCE_DIR "/tests/evaluation/behaviour-paper.json").mode, "paper");
}

TEST(DetectorBehaviour, SaysHowToMeasureAMissingFile) {
  try {
    (void)read_detector_behaviour("/nowhere/behaviour.json");
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("--fit-sensing"));
  }
}

}  // namespace
}  // namespace luminav
