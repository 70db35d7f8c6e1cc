#include "drivers/base/safety/guardian.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <vector>

#include "drivers/p3dx/arcos/arcos_commands.hpp"
#include "drivers/p3dx/arcos/information_packet.hpp"
#include "drivers/p3dx/safety/arcos_guard.hpp"

namespace luminav {
namespace {

constexpr GuardianParams kParams{.silence = 0.3, .brake_time = 0.1};

/// The robot's side of a line.
struct Line {
  Line() { socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()); }
  ~Line() {
    close(ends[0]);
    hang_up();
  }
  void hang_up() {
    if (ends[1] >= 0) {
      close(ends[1]);
      ends[1] = -1;
    }
  }
  /// Commands heard until everybody has let go of the other end; the robot answers each as it likes.
  std::vector<ArcosCommand> hear_all(const std::function<void(ArcosCommand)>& answer = [](ArcosCommand) {}) {
    hang_up();
    PacketParser parser;
    std::vector<ArcosCommand> heard;
    std::array<std::uint8_t, 256> bytes;
    while (true) {
      pollfd readable{ends[0], POLLIN, 0};
      if (poll(&readable, 1, 10'000) <= 0) {
        ADD_FAILURE() << "nobody speaks and nobody lets go";
        return heard;
      }
      const ssize_t count = read(ends[0], bytes.data(), bytes.size());
      if (count <= 0) {
        return heard;
      }
      parser.push(std::span(bytes).first(static_cast<std::size_t>(count)));
      while (const auto packet = parser.next()) {
        heard.push_back(static_cast<ArcosCommand>(packet->type));
        answer(heard.back());
      }
    }
  }
  /// What the robot says of its wheels.
  void tell_speed(int mm_s) {
    InformationPacket information;
    information.left_mm_s = information.right_mm_s = mm_s;
    const std::vector<std::uint8_t> packet = encode_information(information);
    EXPECT_EQ(write(ends[0], packet.data(), packet.size()), static_cast<ssize_t>(packet.size()));
  }
  std::array<int, 2> ends{-1, -1};
};

void expect_farewell(const std::vector<ArcosCommand>& heard) {
  ASSERT_GE(heard.size(), 6U);
  EXPECT_THAT(heard, testing::Contains(ArcosCommand::kStop));
  EXPECT_THAT(heard, testing::Contains(ArcosCommand::kVelocity));
  EXPECT_THAT(heard, testing::Contains(ArcosCommand::kTurnRate));
  EXPECT_THAT(heard, testing::Contains(ArcosCommand::kEnable));
  EXPECT_EQ(heard.back(), ArcosCommand::kClose);
  // brakes first, and only then takes the power away
  const auto stop = std::find(heard.begin(), heard.end(), ArcosCommand::kStop);
  const auto enable = std::find(heard.begin(), heard.end(), ArcosCommand::kEnable);
  EXPECT_LT(stop, enable);
}

TEST(Guardian, StopsTheRobotWhenTheDriverFallsSilent) {
  Line line;
  Guardian guardian(kParams, guarded_arcos());
  guardian.watch_line(line.ends[1]);
  expect_farewell(line.hear_all());
}

TEST(Guardian, StopsTheRobotWhenTheDriverDies) {
  Line line;
  const pid_t driver = fork();
  if (driver == 0) {
    auto* guardian = new Guardian(kParams, guarded_arcos());  // dies without a farewell
    guardian->watch_line(line.ends[1]);
    _exit(0);
  }
  expect_farewell(line.hear_all());
  waitpid(driver, nullptr, 0);
}

TEST(Guardian, GetsThroughAFrameThatWasCutInTheMiddle) {
  Line line;
  const std::array<std::uint8_t, 5> cut = {0xFA, 0xFB, 0x06, 0x0B, 0x3B};
  ASSERT_EQ(write(line.ends[1], cut.data(), cut.size()), 5);
  Guardian guardian(kParams, guarded_arcos());
  guardian.watch_line(line.ends[1]);
  expect_farewell(line.hear_all());
}

TEST(Guardian, LetsGoAsSoonAsTheWheelsStandAndNotBefore) {
  Line line;
  Guardian guardian({.silence = 0.1, .brake_time = 60.0}, guarded_arcos());
  guardian.watch_line(line.ends[1]);
  constexpr int kStopsWhileItRolls = 30;
  int stops = 0;
  int speed = 400;
  expect_farewell(line.hear_all([&](ArcosCommand command) {
    if (command == ArcosCommand::kStop) {
      ++stops;
      speed = stops < kStopsWhileItRolls ? 400 : 0;
      line.tell_speed(speed);
    }
    EXPECT_FALSE(command == ArcosCommand::kEnable && speed > 0) << "power taken away from a robot that rolls";
  }));
  EXPECT_LT(stops, 500) << "one each 0.03 s: it has not waited for the longest time to brake";
}

TEST(Guardian, DoesNotBelieveWhatTheRobotSaidBeforeTheStop) {
  Line line;
  line.tell_speed(0);
  Guardian guardian({.silence = 0.1, .brake_time = 1.0}, guarded_arcos());
  guardian.watch_line(line.ends[1]);
  int stops = 0;
  expect_farewell(line.hear_all([&](ArcosCommand command) { stops += command == ArcosCommand::kStop ? 1 : 0; }));
  EXPECT_GT(stops, 1);
}

TEST(Guardian, SaysNothingWhileTheDriverBeats) {
  using Clock = std::chrono::steady_clock;
  constexpr auto kSafelyBelowSilence = std::chrono::milliseconds(200);
  // Where the machine keeps this process from beating in time, what the guardian does then proves nothing.
  for (bool kept_time = false; !kept_time;) {
    Line line;
    Guardian guardian(kParams, guarded_arcos());
    guardian.watch_line(line.ends[1]);
    kept_time = true;
    bool silent = true;
    for (int i = 0; i < 10 && kept_time; ++i) {
      const auto before = Clock::now();
      pollfd readable{line.ends[0], POLLIN, 0};
      silent = poll(&readable, 1, 50) == 0 && silent;  // half a second in all
      guardian.beat();
      kept_time = Clock::now() - before < kSafelyBelowSilence;
    }
    const auto before = Clock::now();
    guardian.watch_line(-1);
    kept_time = kept_time && Clock::now() - before < kSafelyBelowSilence;
    const std::vector<ArcosCommand> heard = line.hear_all();
    if (kept_time) {
      EXPECT_TRUE(silent);
      EXPECT_TRUE(heard.empty());  // released in peace
    }
  }
}

TEST(Guardian, LeavesALineThatWasReleasedAlone) {
  Line line;
  {
    Guardian guardian({.silence = 60.0, .brake_time = 0.1}, guarded_arcos());
    guardian.watch_line(line.ends[1]);
  }
  EXPECT_TRUE(line.hear_all().empty());
}

}  // namespace
}  // namespace luminav
