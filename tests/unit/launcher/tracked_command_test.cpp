#include "services/launcher/sheriff/tracked_command.hpp"

#include <gtest/gtest.h>
#include <signal.h>

#include <limits>

#include "services/launcher/exit_status.hpp"
#include "services/launcher/instant.hpp"

namespace luminav::launcher {
namespace {

Command a_command(bool auto_respawn = false) {
  Command command;
  command.name = "camera";
  command.exec = "$LUMINAV_BIN/camera";
  command.deputy = "d";
  command.auto_respawn = auto_respawn;
  return command;
}

luminav_procman::procman_command_status_t status(int pid, int runid, int exit_code = 0) {
  luminav_procman::procman_command_status_t status{};
  status.cmd.command_id = "camera";
  status.pid = pid;
  status.actual_runid = runid;
  status.exit_code = exit_code;
  return status;
}

node_status_t says(std::int8_t state) {
  node_status_t message{};
  message.process = "camera";
  message.state = state;
  return message;
}

Condition condition_of(const TrackedCommand& command, std::int64_t now = 0) {
  return command.state(true, now).condition;
}

TEST(TrackedCommand, AdoptsWhatRunsWithoutRestartingIt) {
  TrackedCommand command(a_command());
  command.start();
  command.update(status(77, 5), 0);
  EXPECT_EQ(command.desired_runid, 5);
  EXPECT_FALSE(command.force_quit);
}

TEST(TrackedCommand, StartsWhatDoesNotRun) {
  TrackedCommand command(a_command());
  command.start();
  EXPECT_TRUE(command.update(std::nullopt, 0));
  EXPECT_EQ(command.desired_runid, 1);
  TrackedCommand stopped(a_command());
  stopped.start();
  EXPECT_TRUE(stopped.update(status(0, 5, 2), 0));
  EXPECT_EQ(stopped.desired_runid, 6);
  EXPECT_FALSE(stopped.force_quit);
}

TEST(TrackedCommand, DoesNotStartTwiceWhatWasJustOrdered) {
  TrackedCommand command(a_command());
  command.update(std::nullopt, 0);
  command.start();
  command.start();
  EXPECT_EQ(command.desired_runid, 1);
  command.update(status(0, 0), 0);
  command.start();
  EXPECT_EQ(command.desired_runid, 1);
}

TEST(TrackedCommand, RestartsWithTheNextRunIdAndStopsByForceQuit) {
  TrackedCommand command(a_command());
  command.update(status(77, 5), 0);
  command.restart();
  EXPECT_EQ(command.desired_runid, 6);
  EXPECT_EQ(condition_of(command), Condition::kRestarting);
  command.stop();
  EXPECT_TRUE(command.force_quit);
  EXPECT_EQ(command.desired_runid, 6);
}

TEST(TrackedCommand, WrapsRunIdsToOne) {
  TrackedCommand command(a_command());
  command.update(status(77, std::numeric_limits<std::int32_t>::max()), 0);
  command.restart();
  EXPECT_EQ(command.desired_runid, 1);
}

TEST(TrackedCommand, DoesNotRunAgainWhatEndedByItself) {
  TrackedCommand once(a_command(false));
  once.start();
  once.update(std::nullopt, 0);
  once.update(status(77, 1), 0);
  EXPECT_FALSE(once.force_quit);
  EXPECT_TRUE(once.update(status(0, 1, 0), 0));
  EXPECT_TRUE(once.force_quit);
  EXPECT_TRUE(once.state(true, 0).finished);

  TrackedCommand respawning(a_command(true));
  respawning.start();
  respawning.update(std::nullopt, 0);
  respawning.update(status(77, 1), 0);
  EXPECT_FALSE(respawning.update(status(0, 1, 256), 0));
  EXPECT_FALSE(respawning.force_quit);
  EXPECT_EQ(condition_of(respawning), Condition::kRestarting);
  EXPECT_TRUE(respawning.update(status(0, 1, kGaveUpStatus), 0));
  EXPECT_TRUE(respawning.force_quit);
  EXPECT_EQ(condition_of(respawning), Condition::kGaveUp);
}

TEST(TrackedCommand, LeavesACrashedProcessThatIsAboutToRestartAlone) {
  TrackedCommand command(a_command(true));
  command.update(status(0, 5, 256), 0);
  EXPECT_FALSE(command.force_quit);
  command.update(status(78, 5), kSecond);
  command.update(status(0, 5, 256), 8 * kSecond);
  EXPECT_FALSE(command.force_quit) << "it was restarted, so it was wanted";

  TrackedCommand stopped(a_command(true));
  stopped.update(status(0, 5, 2), 0);
  EXPECT_TRUE(stopped.update(status(0, 5, 2), 7 * kSecond));
  EXPECT_TRUE(stopped.force_quit) << "nobody restarted it, so it had been stopped";
}

TEST(TrackedCommand, TakesWhatEndedWellForStoppedWhereNobodyCommands) {
  for (const int ended_well : {0, SIGINT, SIGTERM}) {
    TrackedCommand command(a_command(true));
    command.update(status(0, 5, ended_well), 0);
    EXPECT_EQ(condition_of(command), Condition::kStopped) << "wait status " << ended_well;
  }
  TrackedCommand crashed(a_command(true));
  crashed.update(status(0, 5, SIGSEGV), 0);
  EXPECT_EQ(condition_of(crashed), Condition::kRestarting);
}

TEST(TrackedCommand, IsReadyOnlyByItsOwnWord) {
  TrackedCommand command(a_command());
  command.start();
  command.update(std::nullopt, 0);
  EXPECT_EQ(condition_of(command), Condition::kStarting);
  command.update(status(77, 1), 0);
  EXPECT_EQ(condition_of(command, 10 * kSecond), Condition::kStarting) << "a pid is not enough";
  command.update(says(node_status_t::STATE_STARTING), 0);
  EXPECT_EQ(condition_of(command), Condition::kStarting);
  command.update(says(node_status_t::STATE_READY), 0);
  EXPECT_EQ(condition_of(command), Condition::kReady);
  command.update(says(node_status_t::STATE_DEGRADED), 0);
  EXPECT_EQ(condition_of(command), Condition::kDegraded);
  command.update(says(node_status_t::STATE_FAULT), 0);
  EXPECT_EQ(condition_of(command), Condition::kFault);
  EXPECT_EQ(condition_of(command, 4 * kSecond), Condition::kSilent);
}

TEST(TrackedCommand, ForgetsTheWordOfTheProcessBefore) {
  TrackedCommand command(a_command(true));
  command.update(status(77, 1), 0);
  command.update(says(node_status_t::STATE_READY), 0);
  command.update(status(78, 1), 0);
  EXPECT_EQ(condition_of(command), Condition::kStarting);
  EXPECT_EQ(command.state(true, 0).restarts, 1);
}

TEST(TrackedCommand, TakesAForeignProgramForReadyWhenItHasLived) {
  Command foreign = a_command();
  foreign.exec = "lcm-logger x";
  TrackedCommand command(foreign);
  command.update(status(77, 1), 0);
  EXPECT_EQ(condition_of(command, kSecond / 2), Condition::kStarting);
  EXPECT_EQ(condition_of(command, kSecond), Condition::kReady);
}

TEST(TrackedCommand, TellsHowItEnded) {
  const auto after = [](int exit_code, bool ordered) {
    TrackedCommand command(a_command());
    command.update(status(77, 1), 0);
    if (ordered) {
      command.stop();
    }
    command.update(status(0, 1, exit_code), 0);
    return condition_of(command);
  };
  EXPECT_EQ(after(0, false), Condition::kStopped);
  EXPECT_EQ(after(2, true), Condition::kStopped);
  EXPECT_EQ(after(9, true), Condition::kStopped);
  EXPECT_EQ(after(3 << 8, false), Condition::kFailed);
  EXPECT_EQ(after(11, true), Condition::kFailed) << "a crash is no answer to a stop signal";
  EXPECT_EQ(after(kRefusedStatus, false), Condition::kRefused);
}

TEST(TrackedCommand, IsUnknownWithoutItsDeputy) {
  const TrackedCommand command(a_command());
  const CommandState state = command.state(false, 0);
  EXPECT_EQ(state.condition, Condition::kUnknown);
  EXPECT_NE(state.detail.find("deputy d"), std::string::npos);
}

}  // namespace
}  // namespace luminav::launcher
