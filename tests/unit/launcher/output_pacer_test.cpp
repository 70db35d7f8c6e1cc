#include "services/launcher/deputy/output_pacer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace luminav::launcher {
namespace {

std::string text_of(const std::vector<luminav_procman::procman_output_t>& messages, const std::string& id) {
  std::string text;
  for (const auto& message : messages) {
    EXPECT_EQ(message.num_commands, static_cast<int>(message.text.size()));
    EXPECT_EQ(message.command_ids.size(), message.text.size());
    for (std::size_t i = 0; i < message.text.size(); ++i) {
      text += message.command_ids[i] == id ? message.text[i] : "";
    }
  }
  return text;
}

TEST(OutputPacer, SendsWhatWasPrintedOnce) {
  OutputPacer pacer({});
  pacer.add("a", "one\n", 0);
  pacer.add("b", "other\n", 0);
  pacer.add("a", "two\n", 0);
  const auto messages = pacer.take(0);
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(text_of(messages, "a"), "one\ntwo\n");
  EXPECT_EQ(text_of(messages, "b"), "other\n");
  EXPECT_TRUE(pacer.take(0).empty());
}

TEST(OutputPacer, KeepsEveryMessageWithinADatagramAndLosesNothingByIt) {
  OutputPacer pacer({.command_rate = 1e6, .command_burst = 1e6, .largest = 1000});
  std::string all;
  for (int i = 0; i < 500; ++i) {
    all += std::to_string(i) + "\n";
  }
  pacer.add("a", all, 0);
  pacer.add("b", all, 0);
  const auto messages = pacer.take(0);
  EXPECT_EQ(text_of(messages, "a"), all);
  EXPECT_EQ(text_of(messages, "b"), all);
  for (const auto& message : messages) {
    EXPECT_LE(message.getEncodedSize(), 1000 + 40);
  }
}

TEST(OutputPacer, CutsAFloodAndSaysSoWhileOthersAreHeard) {
  OutputPacer pacer({.command_rate = 1000, .command_burst = 2000, .largest = 60'000});
  pacer.add("noisy", std::string(10'000, 'x'), 0);
  pacer.add("quiet", "hello\n", 0);
  const auto flood = pacer.take(0);
  EXPECT_EQ(text_of(flood, "noisy").size(), 2000U);
  EXPECT_EQ(text_of(flood, "quiet"), "hello\n");
  pacer.add("noisy", std::string(10'000, 'x'), 1'000'000);
  EXPECT_THAT(text_of(pacer.take(1'000'000), "noisy"), ::testing::SizeIs(1000)) << "one second's allowance";
  EXPECT_THAT(text_of(pacer.take(3'000'000), "noisy"), ::testing::HasSubstr("17000 bytes left out"));
  EXPECT_TRUE(pacer.take(4'000'000).empty());
}

TEST(OutputPacer, SendsNoZeroBytes) {
  OutputPacer pacer({});
  pacer.add("a", std::string("x\0y", 3), 0);
  EXPECT_EQ(text_of(pacer.take(0), "a"), "x?y");
}

}  // namespace
}  // namespace luminav::launcher
