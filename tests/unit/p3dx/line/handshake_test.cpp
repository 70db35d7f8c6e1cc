#include "drivers/p3dx/line/handshake.hpp"

#include <gtest/gtest.h>

#include "drivers/p3dx/arcos/arcos_commands.hpp"

namespace luminav {
namespace {

using Bytes = std::vector<std::uint8_t>;

void hear(Handshake& handshake, const Bytes& frame, std::int64_t now) {
  PacketParser parser;
  parser.push(frame);
  while (const auto packet = parser.next()) {
    handshake.on_packet(*packet, now);
  }
}

const Bytes kIdentity = encode_identity({"a", "Pioneer", "p3dx-sh"});

TEST(Handshake, SendsThreeSyncsAndLearnsWhoAnswers) {
  Handshake handshake;
  handshake.start(0);
  EXPECT_EQ(handshake.poll(0), encode_packet(0));
  EXPECT_EQ(handshake.poll(1), std::nullopt);  // waits for the answer
  hear(handshake, encode_packet(0), 2);
  EXPECT_EQ(handshake.poll(2), encode_packet(1));
  hear(handshake, encode_packet(1), 3);
  EXPECT_EQ(handshake.poll(3), encode_packet(2));
  hear(handshake, kIdentity, 4);
  ASSERT_TRUE(handshake.complete());
  EXPECT_EQ(handshake.identity().subclass, "p3dx-sh");
}

TEST(Handshake, RepeatsASyncThatIsNotAnsweredAndGivesUp) {
  Handshake handshake;
  handshake.start(0);
  int sent = 0;
  for (std::int64_t now = 0; now < 10'000'000 && !handshake.exhausted(); now += 10'000) {
    sent += handshake.poll(now) ? 1 : 0;
  }
  EXPECT_TRUE(handshake.exhausted());
  EXPECT_FALSE(handshake.heard());
  EXPECT_EQ(sent, 4);
}

TEST(Handshake, ClosesASessionThatIsStillOpenAndStartsAgain) {
  Handshake handshake;
  handshake.start(0);
  EXPECT_EQ(handshake.poll(0), encode_packet(0));
  hear(handshake, encode_information({}), 10'000);
  EXPECT_EQ(handshake.poll(10'000), encode_command(ArcosCommand::kClose));
  hear(handshake, encode_information({}), 20'000);  // the last one of the old session
  EXPECT_EQ(handshake.poll(20'000), std::nullopt);
  EXPECT_EQ(handshake.poll(400'000), encode_packet(0));
  hear(handshake, encode_packet(0), 410'000);
  EXPECT_EQ(handshake.poll(410'000), encode_packet(1));
}

TEST(Handshake, StartsAgainWhenTheRobotCountsDifferently) {
  Handshake handshake;
  handshake.start(0);
  handshake.poll(0);
  hear(handshake, encode_packet(0), 1);
  EXPECT_EQ(handshake.poll(1), encode_packet(1));
  hear(handshake, encode_packet(0xFF), 2);
  EXPECT_EQ(handshake.poll(3), std::nullopt);
  EXPECT_EQ(handshake.poll(500'000), encode_packet(0));
}

TEST(Handshake, DoesNotTakeAnEchoForAnIdentity) {
  Handshake handshake;
  handshake.start(0);
  handshake.poll(0);
  hear(handshake, encode_packet(0), 1);
  handshake.poll(1);
  hear(handshake, encode_packet(1), 2);
  handshake.poll(2);
  hear(handshake, encode_packet(2), 3);
  EXPECT_FALSE(handshake.complete());
}

TEST(Handshake, IgnoresLateEchoes) {
  Handshake handshake;
  handshake.start(0);
  handshake.poll(0);
  hear(handshake, encode_packet(0), 1);
  handshake.poll(1);
  hear(handshake, encode_packet(0), 2);  // of a SYNC0 sent twice
  EXPECT_EQ(handshake.poll(3), std::nullopt);
  hear(handshake, encode_packet(1), 4);
  EXPECT_EQ(handshake.poll(4), encode_packet(2));
}

}  // namespace
}  // namespace luminav
