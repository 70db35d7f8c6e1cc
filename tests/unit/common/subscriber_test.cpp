#include "services/common/process/subscriber.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <luminav/hypotheses_t.hpp>
#include <luminav/odometry_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/sonar_t.hpp>
#include <luminav/stop_t.hpp>
#include <stdexcept>

namespace luminav {
namespace {

struct Listener {
  explicit Listener(lcm::LCM& lcm) : subscriber(lcm) {
    subscriber.on("ODOMETRY", &Listener::on_odometry, this);
    subscriber.on("HYPOTHESES", &Listener::on_hypotheses, this);
  }
  void on_odometry(const odometry_t& message) {
    if (message.sequence == 13) {
      throw std::runtime_error("unlucky");
    }
    ++heard;
  }
  void on_hypotheses(const hypotheses_t&) { ++heard; }
  Subscriber subscriber;
  int heard = 0;
};

void drain(lcm::LCM& lcm) {
  while (lcm.handleTimeout(0) > 0) {
  }
}

TEST(Subscriber, SurvivesWhatDoesNotDecodeAndHandlersThatThrow) {
  lcm::LCM lcm("memq://");
  Listener listener(lcm);
  odometry_t message{};
  message.utime = 1;
  message.sequence = 13;
  lcm.publish("ODOMETRY", &message);
  lcm.publish("ODOMETRY", "rubbish", 7);
  message.sequence = 14;
  lcm.publish("ODOMETRY", &message);
  drain(lcm);
  EXPECT_EQ(listener.heard, 1);
  EXPECT_EQ(listener.subscriber.dropped(), 2);
}

TEST(Subscriber, SurvivesAHostileCount) {
  lcm::LCM lcm("memq://");
  Listener listener(lcm);
  hypotheses_t message{};
  message.utime = 1;
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  // the count stands behind fingerprint, utime and the empty floor
  for (std::size_t i = 8 + 8 + 5; i < 8 + 8 + 9; ++i) {
    bytes[i] = 0xFF;
  }
  lcm.publish("HYPOTHESES", bytes.data(), static_cast<unsigned>(bytes.size()));
  lcm.publish("HYPOTHESES", &message);
  drain(lcm);
  EXPECT_EQ(listener.heard, 1);
  EXPECT_EQ(listener.subscriber.dropped(), 1);
}

TEST(Subscriber, DropsStampsThatNoClockShows) {
  lcm::LCM lcm("memq://");
  Listener listener(lcm);
  odometry_t message{};
  for (const std::int64_t utime : {std::numeric_limits<std::int64_t>::min(), std::int64_t{-1}, std::int64_t{0},
                                   std::int64_t{1} << 53, std::numeric_limits<std::int64_t>::max()}) {
    message.utime = utime;
    lcm.publish("ODOMETRY", &message);
  }
  drain(lcm);
  EXPECT_EQ(listener.heard, 0);
  EXPECT_EQ(listener.subscriber.dropped(), 5);
  message.utime = (std::int64_t{1} << 53) - 1;
  lcm.publish("ODOMETRY", &message);
  drain(lcm);
  EXPECT_EQ(listener.heard, 1);
}

TEST(Subscriber, KnowsImpossibleStampsInsideOfAMessage) {
  constexpr std::int64_t kBeforeAllClocks = std::numeric_limits<std::int64_t>::min();
  sonar_t sonar{};
  sonar.utime = 1;
  sonar.count = 2;
  sonar.range_utime = {1, 0};
  EXPECT_TRUE(has_sound_stamps(sonar));
  sonar.range_utime[1] = kBeforeAllClocks;
  EXPECT_FALSE(has_sound_stamps(sonar));
  pose_t pose{};
  pose.utime = 1;
  EXPECT_TRUE(has_sound_stamps(pose));
  pose.fixture_utime = kBeforeAllClocks;
  EXPECT_FALSE(has_sound_stamps(pose));
}

TEST(Subscriber, TakesAStopWhateverItsStampAndNoReleaseWithoutOne) {
  struct Stopped {
    explicit Stopped(lcm::LCM& lcm) : subscriber(lcm) { subscriber.on("STOP", &Stopped::on_stop, this); }
    void on_stop(const stop_t& message) { engaged = message.engaged != 0; }
    Subscriber subscriber;
    bool engaged = false;
  };
  lcm::LCM lcm("memq://");
  Stopped stopped(lcm);
  stop_t message{};
  message.engaged = 1;
  lcm.publish("STOP", &message);
  drain(lcm);
  EXPECT_TRUE(stopped.engaged);
  message.engaged = 0;
  lcm.publish("STOP", &message);
  drain(lcm);
  EXPECT_TRUE(stopped.engaged);
}

TEST(Subscriber, NoLongerListensOnceItIsGone) {
  lcm::LCM lcm("memq://");
  { const Listener listener(lcm); }
  odometry_t message{};
  lcm.publish("ODOMETRY", &message);
  EXPECT_EQ(lcm.handleTimeout(0), 0);
}

TEST(AllFinite, FindsWhatIsNoNumber) {
  EXPECT_TRUE(all_finite({1.0, -2.0}));
  EXPECT_FALSE(all_finite({1.0, std::numeric_limits<double>::quiet_NaN()}));
  EXPECT_FALSE(all_finite({std::numeric_limits<double>::infinity()}));
}

}  // namespace
}  // namespace luminav
