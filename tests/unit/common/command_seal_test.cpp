#include "services/common/network/command_seal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <luminav/goal_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/stop_t.hpp>
#include <luminav/velocity_command_t.hpp>

#include "services/common/configuration/toml_table.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/subscriber.hpp"

namespace luminav {
namespace {

using ::testing::HasSubstr;

constexpr std::int64_t kNow = 1'700'000'000'000'000;  // [us]

CommandKey key_of(std::uint8_t byte) {
  CommandKey key;
  key.bytes.fill(byte);
  key.read_at = kNow;
  return key;
}

/// A network in one program that keeps what is said on it.
class Wire {
 public:
  Wire() { lcm.subscribe(".*", &Wire::on_bytes, this); }
  void on_bytes(const lcm::ReceiveBuffer* buffer, const std::string&) {
    const auto* data = static_cast<const std::uint8_t*>(buffer->data);
    said.assign(data, data + buffer->data_size);
  }
  template <typename Message>
  std::vector<std::uint8_t> bytes_of(CommandPublisher& publisher, const char* channel, const Message& message) {
    publisher.publish(channel, message);
    while (lcm.handleTimeout(0) > 0) {
    }
    return said;
  }

  lcm::LCM lcm{"memq://"};
  std::vector<std::uint8_t> said;
};

stop_t stop(bool engaged) {
  stop_t message{};
  message.utime = message.id = kNow;
  message.engaged = engaged;
  message.sender = "me";
  return message;
}

goal_t goal() {
  goal_t message{};
  message.utime = message.id = kNow;
  return message;
}

TEST(CommandSeal, LetsOnlyTheKeyMoveOrChangeSomething) {
  Wire wire;
  CommandPublisher ours(wire.lcm, key_of(1));
  CommandPublisher strangers(wire.lcm, key_of(2));
  CommandPublisher open(wire.lcm);
  SealGuard guard(key_of(1));
  for (const char* channel : {channels::kVelocityCommand, channels::kMotorsCommand, channels::kGoal,
                              channels::kInitialPose, channels::kMapCommand, channels::kTeleopCommand,
                              channels::kSupervision, channels::kSpeedLimit, channels::kProcmanOrders}) {
    EXPECT_EQ(guard.judge(channel, wire.bytes_of(ours, channel, goal())), "") << channel;
    EXPECT_THAT(guard.judge(channel, wire.bytes_of(strangers, channel, goal())), HasSubstr("another key")) << channel;
    EXPECT_THAT(guard.judge(channel, wire.bytes_of(open, channel, goal())), HasSubstr("without a key")) << channel;
  }
  EXPECT_EQ(guard.judge(channels::kPose, wire.bytes_of(open, channels::kPose, pose_t{})), "");
}

TEST(CommandSeal, LetsEverybodyStopAndOnlyTheKeyRelease) {
  Wire wire;
  CommandPublisher ours(wire.lcm, key_of(1));
  CommandPublisher open(wire.lcm);
  SealGuard guard(key_of(1));
  EXPECT_EQ(guard.judge(channels::kStop, wire.bytes_of(open, channels::kStop, stop(true))), "");
  EXPECT_NE(guard.judge(channels::kStop, wire.bytes_of(open, channels::kStop, stop(false))), "");
  EXPECT_EQ(guard.judge(channels::kStop, wire.bytes_of(ours, channels::kStop, stop(false))), "");
}

TEST(CommandSeal, IsBrokenByAnyChangedBit) {
  Wire wire;
  CommandPublisher ours(wire.lcm, key_of(1));
  const std::vector<std::uint8_t> whole = wire.bytes_of(ours, channels::kGoal, goal());
  SealGuard guard(key_of(1));
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    std::vector<std::uint8_t> changed = whole;
    changed[bit / 8] = static_cast<std::uint8_t>(changed[bit / 8] ^ 1U << bit % 8);
    EXPECT_NE(guard.judge(channels::kGoal, changed), "") << bit;
  }
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_NE(guard.judge(channels::kGoal, std::span(whole).first(size)), "") << size;
  }
  EXPECT_NE(guard.judge(channels::kMapCommand, whole), "") << "on another channel";
  EXPECT_EQ(guard.judge(channels::kGoal, whole), "");
}

TEST(CommandSeal, CountsOnce) {
  Wire wire;
  CommandPublisher first(wire.lcm, key_of(1), [] { return kNow + 7; });
  CommandPublisher second(wire.lcm, key_of(1), [] { return kNow + 3; });
  SealGuard guard(key_of(1));
  const auto early = wire.bytes_of(first, channels::kGoal, goal());
  const auto late = wire.bytes_of(first, channels::kGoal, goal());
  const auto other = wire.bytes_of(second, channels::kGoal, goal());
  EXPECT_EQ(guard.judge(channels::kGoal, late), "");
  EXPECT_THAT(guard.judge(channels::kGoal, late), HasSubstr("heard before"));
  EXPECT_THAT(guard.judge(channels::kGoal, early), HasSubstr("heard before"));
  EXPECT_EQ(guard.judge(channels::kGoal, other), "") << "each sender counts for itself";
}

TEST(CommandSeal, RefusesRecordingsAfterARestartOfTheReceiver) {
  Wire wire;
  std::int64_t now = kNow - 3'600'000'000;
  CommandPublisher sender(wire.lcm, key_of(1), [&] { return now; });
  const auto an_hour_ago = wire.bytes_of(sender, channels::kGoal, goal());
  SealGuard restarted(key_of(1));
  EXPECT_THAT(restarted.judge(channels::kGoal, an_hour_ago), HasSubstr("3600 s before this process started"));
  now = kNow - 30'000'000;  // of a machine whose clock is half a minute behind
  EXPECT_EQ(restarted.judge(channels::kGoal, wire.bytes_of(sender, channels::kGoal, goal())), "");
}

TEST(CommandSeal, ForgetsTheLongestSilentSenderAndTakesNoOldWordOfHis) {
  Wire wire;
  SealGuard guard(key_of(1));
  std::int64_t now = kNow;
  std::vector<std::uint8_t> first;
  for (int i = 0; i < 100; ++i) {
    now += 1'000'000;
    CommandPublisher sender(wire.lcm, key_of(1), [&] { return now; });
    const auto said = wire.bytes_of(sender, channels::kGoal, goal());
    first = i == 0 ? said : first;
    EXPECT_EQ(guard.judge(channels::kGoal, said), "") << i;
  }
  EXPECT_NE(guard.judge(channels::kGoal, first), "");
}

struct Listener {
  Listener(lcm::LCM& lcm, std::optional<CommandKey> key) : subscriber(lcm, key) {
    subscriber.on(channels::kGoal, &Listener::on_goal, this);
  }
  void on_goal(const goal_t&) { ++heard; }
  Subscriber subscriber;
  int heard = 0;
};

TEST(CommandSeal, IsLookedAtByEverySubscriberWithAKeyAndOverlookedByOneWithout) {
  lcm::LCM lcm("memq://");
  Listener keyed(lcm, key_of(1));
  Listener open(lcm, std::nullopt);
  CommandPublisher(lcm, key_of(1)).publish(channels::kGoal, goal());
  CommandPublisher(lcm, key_of(2)).publish(channels::kGoal, goal());
  CommandPublisher(lcm).publish(channels::kGoal, goal());
  while (lcm.handleTimeout(0) > 0) {
  }
  EXPECT_EQ(keyed.heard, 1);
  EXPECT_EQ(keyed.subscriber.dropped(), 2);
  EXPECT_EQ(open.heard, 3);
}

class KeyFile : public ::testing::Test {
 protected:
  KeyFile() { std::filesystem::remove(file_); }
  ~KeyFile() override { std::filesystem::remove(file_); }
  void write(const std::string& text, mode_t mode = 0600) {
    std::ofstream(file_) << text;
    chmod(file_.c_str(), mode);
  }
  std::string complaint() {
    try {
      read_command_key(file_);
    } catch (const ConfigurationError& error) {
      return error.what();
    }
    return "";
  }
  std::filesystem::path file_ = std::filesystem::path(LUMINAV_BINARY_DIR) / "command_seal_test.key";
};

TEST_F(KeyFile, IsReadWhereOnlyItsOwnerMay) {
  write(std::string(64, 'a') + "\n");
  EXPECT_EQ(read_command_key(file_).bytes[31], 0xAA);
  write(std::string(64, 'a') + "\n", 0640);
  EXPECT_THAT(complaint(), HasSubstr("chmod 600"));
}

TEST_F(KeyFile, IsRefusedWhenItHoldsNoKey) {
  EXPECT_THAT(complaint(), HasSubstr("--make-key"));
  for (const std::string& text : {std::string(), std::string(63, 'a'), std::string(66, 'a'), std::string(64, 'x')}) {
    write(text);
    EXPECT_THAT(complaint(), HasSubstr("64 hexadecimal")) << text;
  }
}

}  // namespace
}  // namespace luminav
