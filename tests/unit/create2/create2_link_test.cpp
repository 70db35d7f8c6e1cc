#include "drivers/create2/line/create2_link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace luminav {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::int64_t kStart = 1'000'000;  // [us]
constexpr std::int64_t kPoll = 20'000;      // [us]

Bytes frame(std::uint16_t left_count) {
  SensorReading reading;
  reading.left_count = left_count;
  return encode_stream_frame(encode_readings(reading, wanted_readings()));
}

/// A link at one end of a line and the test at the other.
struct Bench {
  /// What the link has said since.
  Bytes heard() {
    Bytes all(1024);
    all.resize(robot->read(all));
    return all;
  }
  /// Polls for so long [us]; the last events.
  Create2Events wait(std::int64_t time) {
    Create2Events events;
    for (const std::int64_t end = now + time; now < end;) {
      now += kPoll;
      events = link.poll(now);
    }
    return events;
  }

  MemoryPipe pipe;
  std::unique_ptr<ByteStream> robot = pipe.open_robot_end();
  Create2Link link{pipe.driver_opener()};
  std::int64_t now = kStart;
};

Bytes request() {
  Bytes bytes = encode_opcode(OiOpcode::kStart);
  const Bytes stream = encode_stream_request(wanted_readings());
  bytes.insert(bytes.end(), stream.begin(), stream.end());
  return bytes;
}

TEST(Create2Link, AsksForTheStreamUntilItComes) {
  Bench bench;
  bench.link.poll(bench.now);
  EXPECT_EQ(bench.heard(), request());
  bench.wait(2'000'000);
  EXPECT_FALSE(bench.link.connected());
  EXPECT_THAT(bench.link.trouble(), testing::HasSubstr("is it switched on?"));
  EXPECT_EQ(bench.heard(), request()) << "it may be switched on later";
  bench.robot->write(frame(7));
  const Create2Events events = bench.wait(kPoll);
  EXPECT_TRUE(events.connected);
  ASSERT_EQ(events.readings.size(), 1U);
  EXPECT_EQ(events.readings[0].reading.left_count, 7);
  EXPECT_TRUE(bench.link.connected());
}

TEST(Create2Link, StampsReadingsThatComeTogetherAFramePeriodApart) {
  Bench bench;
  bench.link.poll(bench.now);
  for (const auto count : {std::uint16_t{1}, std::uint16_t{2}, std::uint16_t{3}}) {
    bench.robot->write(frame(count));
  }
  const Create2Events events = bench.wait(kPoll);
  ASSERT_EQ(events.readings.size(), 3U);
  EXPECT_EQ(events.readings[2].utime, bench.now);
  EXPECT_EQ(events.readings[0].utime, bench.now - 30'000);
}

TEST(Create2Link, NoticesARobotThatFallsSilentAndOpensTheLineAnew) {
  Bench bench;
  bench.link.poll(bench.now);
  bench.robot->write(frame(1));
  bench.wait(kPoll);
  bench.wait(400'000);
  EXPECT_FALSE(bench.link.connected());
  EXPECT_EQ(bench.link.openings(), 1);
  bench.wait(6'000'000);
  EXPECT_EQ(bench.link.openings(), 2);
}

TEST(Create2Link, DropsWhatWaitsWhenTheLineIsLost) {
  Bench bench;
  bench.link.poll(bench.now);
  bench.pipe.unplug();
  bench.wait(kPoll);
  EXPECT_FALSE(bench.link.trouble().empty());
  bench.link.send(encode_drive_direct(200, 200));
  EXPECT_TRUE(bench.link.is_idle()) << "a command of before is not done later";
  bench.pipe.plug_in();
  bench.robot = bench.pipe.open_robot_end();
  bench.wait(1'000'000);
  EXPECT_EQ(bench.heard(), request());
}

TEST(Create2Link, LeavesTheLineToTheGuardianForAWhile) {
  Bench bench;
  bench.link.poll(bench.now);
  bench.heard();
  bench.link.begin_anew(bench.now, 500'000, "the guardian was here");
  bench.wait(400'000);
  EXPECT_EQ(bench.link.descriptor(), -1);
  EXPECT_EQ(bench.link.trouble(), "the guardian was here");
  EXPECT_TRUE(bench.heard().empty());
  bench.wait(200'000);
  EXPECT_EQ(bench.heard(), request());
}

TEST(Create2Link, SaysFarewellBeforeItCloses) {
  Bench bench;
  bench.link.poll(bench.now);
  bench.heard();
  bench.link.close_with(encode_halt());
  EXPECT_EQ(bench.heard(), encode_halt());
  EXPECT_FALSE(bench.link.connected());
}

}  // namespace
}  // namespace luminav
