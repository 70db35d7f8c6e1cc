#include "drivers/p3dx/line/send_queue.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace luminav {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Takes so many bytes in all.
struct NarrowLine final : ByteStream {
  std::size_t read(std::span<std::uint8_t>) override { return 0; }
  std::size_t write(std::span<const std::uint8_t> bytes) override {
    const std::size_t count = std::min(bytes.size(), room);
    room -= count;
    written.insert(written.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
  }
  [[nodiscard]] int descriptor() const override { return -1; }
  [[nodiscard]] bool is_open() const override { return open; }
  void close() override { open = false; }

  std::size_t room = 1000;
  Bytes written;
  bool open = true;
};

TEST(SendQueue, SendsABurstThenAtTheRobotsPace) {
  SendQueue queue;
  NarrowLine line;
  for (std::uint8_t i = 0; i < 8; ++i) {
    queue.push({i});
  }
  queue.flush(nullptr, 900'000);
  EXPECT_EQ(queue.size(), 8U);
  queue.flush(&line, 1'000'000);
  EXPECT_THAT(line.written, testing::ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(queue.last_sent(), 1'000'000);
  queue.flush(&line, 1'005'000);
  EXPECT_EQ(line.written.size(), 5U);
  queue.flush(&line, 1'015'000);
  EXPECT_EQ(line.written.size(), 7U);
}

TEST(SendQueue, DropsAllButTheRestOfAFrameThatHasLeftInPart) {
  SendQueue queue;
  NarrowLine line;
  line.room = 2;
  queue.push({1, 2, 3});
  queue.push({4});
  queue.flush(&line, 1'000'000);
  queue.drop_waiting(&line);
  queue.push({5});
  line.room = 1000;
  queue.flush(&line, 2'000'000);
  EXPECT_THAT(line.written, testing::ElementsAre(1, 2, 3, 5));
}

TEST(SendQueue, FinishesAFrameAtOnceAndForgetsItWithTheLine) {
  SendQueue queue;
  NarrowLine line;
  line.room = 1;
  queue.push({1, 2});
  queue.flush(&line, 1'000'000);
  line.room = 1000;
  queue.finish_frame(line);
  EXPECT_THAT(line.written, testing::ElementsAre(1, 2));
  line.close();
  queue.drop_waiting(&line);
  EXPECT_EQ(queue.size(), 0U);
}

TEST(SendQueue, LosesTheNewestOfTooManyFrames) {
  SendQueue queue;
  for (std::uint8_t i = 0; i < 100; ++i) {
    queue.push({i});
  }
  EXPECT_EQ(queue.size(), 64U);
}

}  // namespace
}  // namespace luminav
