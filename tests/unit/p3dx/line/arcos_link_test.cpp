#include "drivers/p3dx/line/arcos_link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "drivers/p3dx/arcos/arcos_commands.hpp"
#include "tests/node/p3dx/simulated_base.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kStep = 10'000;  // [us]

void garble(std::span<std::uint8_t> bytes) {
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>((byte << 3) ^ (byte >> 2) ^ 0xA5);
  }
}

/// The driver's end of a serial line whose other end has a rate of its own.
class RatedStream final : public ByteStream {
 public:
  RatedStream(std::unique_ptr<ByteStream> line, int baud, const int& robots_baud, std::vector<int>& rates)
      : line_(std::move(line)), robots_baud_(robots_baud), rates_(rates) {
    RatedStream::set_baud(baud);
  }
  std::size_t read(std::span<std::uint8_t> bytes) override {
    const std::size_t count = line_->read(bytes);
    if (baud_ != robots_baud_) {
      garble(bytes.first(count));
    }
    return count;
  }
  std::size_t write(std::span<const std::uint8_t> bytes) override {
    std::vector<std::uint8_t> sent(bytes.begin(), bytes.end());
    if (baud_ != robots_baud_) {
      garble(sent);
    }
    return line_->write(sent);
  }
  [[nodiscard]] int descriptor() const override { return -1; }
  [[nodiscard]] bool is_open() const override { return line_->is_open(); }
  void close() override { line_->close(); }
  bool set_baud(int bits_per_second) override {
    baud_ = bits_per_second;
    rates_.push_back(bits_per_second);
    return true;
  }
  [[nodiscard]] int baud() const override { return baud_; }

 private:
  std::unique_ptr<ByteStream> line_;
  const int& robots_baud_;
  std::vector<int>& rates_;
  int baud_ = 0;
};

/// A link and a robot on a serial line, in virtual time.
struct SerialBench {
  explicit SerialBench(const LinkParams& params)
      : link(
            [this]() -> std::unique_ptr<ByteStream> {
              opened.push_back(now);
              if (refuses) {
                throw std::runtime_error("no such line");
              }
              return std::make_unique<RatedStream>(pipe.open_driver_end(), 9600, robots_baud, rates);
            },
            params) {}

  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(100.0 * seconds)); ++i) {
      now += kStep;
      if (robot_listens) {
        base.step(robot.get());
      }
      if (follows) {
        robots_baud = base.controller().baud();
      }
      link.poll(now);
    }
  }

  MemoryPipe pipe;
  std::unique_ptr<ByteStream> robot = pipe.open_robot_end();
  SimulatedBase base;
  int robots_baud = 9600;
  bool follows = true;  // does what HOSTBAUD says
  bool robot_listens = true;
  bool refuses = false;
  std::int64_t now = 1'000'000;
  std::vector<int> rates;            // that the driver has set, in order
  std::vector<std::int64_t> opened;  // [us]
  ArcosLink link;
};

TEST(ArcosLink, StaysAtTheConfiguredRateUnlessAskedToChange) {
  SerialBench bench({.baud = 9600});
  bench.run(3.0);
  EXPECT_TRUE(bench.link.connected());
  EXPECT_THAT(bench.rates, testing::ElementsAre(9600));
}

TEST(ArcosLink, SwitchesToTheFastRateAndStaysConnected) {
  SerialBench bench({.baud = 9600, .fast_baud = 115200});
  bench.run(3.0);
  EXPECT_TRUE(bench.link.connected());
  EXPECT_EQ(bench.robots_baud, 115200);
  EXPECT_THAT(bench.rates, testing::ElementsAre(9600, 115200));
  bench.run(60.0);
  EXPECT_TRUE(bench.link.connected());
  EXPECT_EQ(bench.link.parser().bad_packets(), 0);
}

TEST(ArcosLink, GoesBackWhenTheRobotDoesNotFollowToTheFastRate) {
  SerialBench bench({.baud = 9600, .fast_baud = 115200});
  bench.follows = false;
  bench.run(5.0);
  EXPECT_TRUE(bench.link.connected());
  EXPECT_THAT(bench.rates, testing::ElementsAre(9600, 115200, 9600));
  EXPECT_EQ(bench.opened.size(), 1U);
}

TEST(ArcosLink, FindsARobotAtWhateverRateAnEarlierSessionHasLeft) {
  for (const int left : {19200, 38400, 57600, 115200}) {
    SerialBench bench({.baud = 9600});
    bench.follows = false;
    bench.robots_baud = left;
    bench.run(20.0);
    EXPECT_TRUE(bench.link.connected()) << left;
    EXPECT_EQ(bench.rates.front(), 9600) << "the configured rate is tried first";
    EXPECT_EQ(bench.rates.back(), left);
  }
}

TEST(ArcosLink, WaitsPastTheRobotsWatchdogBetweenRoundsOfRates) {
  SerialBench bench({.baud = 9600});
  bench.robot_listens = false;
  bench.run(40.0);
  ASSERT_GE(bench.opened.size(), 2U);
  EXPECT_THAT(std::vector(bench.rates.begin(), bench.rates.begin() + 6),
              testing::ElementsAre(9600, 38400, 19200, 115200, 57600, 9600));
  bench.robot_listens = true;
  bench.run(20.0);
  EXPECT_TRUE(bench.link.connected());
}

TEST(ArcosLink, TriesALineThatIsNotThereWithGrowingDelays) {
  SerialBench bench({});
  bench.refuses = true;
  bench.run(60.0);
  ASSERT_GE(bench.opened.size(), 50U);  // for a second at once, then with delays that double up to 2 s
  EXPECT_LE(bench.opened.size(), 57U);
  EXPECT_LE(bench.opened[5] - bench.opened[0], 600'000) << "at first soon: a driver that died may have left it";
  std::int64_t last = 0;
  for (std::size_t i = 1; i < bench.opened.size(); ++i) {
    const std::int64_t delay = bench.opened[i] - bench.opened[i - 1];
    EXPECT_GE(delay, last - kStep);
    EXPECT_LE(delay, 2'000'000 + kStep);
    last = delay;
  }
  EXPECT_EQ(bench.link.trouble(), "no such line");
  bench.refuses = false;
  bench.run(8.0);
  EXPECT_TRUE(bench.link.connected());
}

TEST(ArcosLink, KeepsAnIdleSessionAlive) {
  SerialBench bench({});
  bench.run(3.0);
  bench.base.heard.clear();
  bench.run(60.0);
  EXPECT_TRUE(bench.link.connected());
  EXPECT_GE(bench.base.heard.size(), 120U);
  EXPECT_THAT(bench.base.heard, testing::Each(encode_command(ArcosCommand::kPulse)));
}

TEST(ArcosLink, ChangesNothingOnALineThatIsFullOfNoise) {
  SerialBench bench({});
  bench.robot_listens = false;
  std::mt19937 rng(3);
  for (int i = 0; i < 3000; ++i) {
    std::vector<std::uint8_t> noise(40);
    std::generate(noise.begin(), noise.end(), [&] { return static_cast<std::uint8_t>(rng()); });
    bench.robot->write(noise);
    bench.run(0.01);
    ASSERT_FALSE(bench.link.connected());
  }
  bench.robot_listens = true;
  bench.run(20.0);
  EXPECT_TRUE(bench.link.connected());
}

}  // namespace
}  // namespace luminav
