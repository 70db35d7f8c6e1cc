#include "services/launcher/deputy/processes/posix_runner.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "services/launcher/deputy/processes/proc_files.hpp"
#include "services/launcher/exit_status.hpp"
#include "tests/node/launcher/launcher_world.hpp"
#include "tests/support/temporary_folder.hpp"

// Real children. Nothing here depends on how long anything takes: the tests wait for events, and ctest's own limit ends
// a test whose event never comes.
namespace luminav::launcher {
namespace {

using ::testing::HasSubstr;

bool is_alive(int pid) {
  const auto stat = read_process_stat(pid);
  return stat.has_value() && stat->state != 'Z';
}

class PosixRunnerTest : public ::testing::Test {
 protected:
  int start(const std::string& line) {
    return runner.start(split_command(line, [](const std::string&) { return std::nullopt; }));
  }
  void await_event() {
    pollfd descriptor{runner.event_descriptor(), POLLIN, 0};
    poll(&descriptor, 1, 20);
    for (const ProcessOutput& output : runner.take_output()) {
      printed[output.pid] += output.text;
    }
    for (const ProcessExit& ended : runner.take_exits()) {
      ends[ended.pid] = ended.status;
    }
    for (const ProcessOutput& output : runner.take_output()) {
      printed[output.pid] += output.text;
    }
  }
  void await_text(int pid, const std::string& text) {
    while (printed[pid].find(text) == std::string::npos) {
      ASSERT_FALSE(ends.contains(pid)) << "ended first, after printing: " << printed[pid];
      await_event();
    }
  }
  int await_end(int pid) {
    while (!ends.contains(pid)) {
      await_event();
    }
    return ends[pid];
  }
  TemporaryFolder folder;
  PosixRunner runner{"/nowhere"};
  std::map<int, std::string> printed;
  std::map<int, int> ends;
};

TEST_F(PosixRunnerTest, TellsExitStatusAndOutput) {
  const int pid = start("sh -c 'echo out; echo err >&2; exit 3'");
  EXPECT_EQ(await_end(pid), 3 << 8);
  EXPECT_EQ(printed[pid], "out\nerr\n");
}

TEST_F(PosixRunnerTest, RunsAProgramWithoutShellInASessionOfItsOwnBehindATerminal) {
  const int pid =
      start("sh -c 'echo session $(cut -d\" \" -f6 /proc/self/stat) pid $$; test -t 0 && test -t 1 && echo terminal'");
  await_end(pid);
  EXPECT_THAT(printed[pid], HasSubstr("session " + std::to_string(pid)));
  EXPECT_THAT(printed[pid], HasSubstr("terminal"));
}

TEST_F(PosixRunnerTest, ReportsAProgramThatDoesNotExistOrMayNotRunAsExit255) {
  const int missing = start("no-such-program-anywhere");
  EXPECT_EQ(await_end(missing), 255 << 8);
  EXPECT_THAT(printed[missing], HasSubstr("no-such-program-anywhere: no such program"));
  const int forbidden = start("/etc/passwd");
  EXPECT_EQ(await_end(forbidden), 255 << 8);
  EXPECT_THAT(printed[forbidden], HasSubstr("no permission"));
}

TEST_F(PosixRunnerTest, SetsVariablesAndPutsItsFolderInFrontOfThePath) {
  const int pid = start("COLOUR=red sh -c 'echo $COLOUR $PATH'");
  await_end(pid);
  EXPECT_THAT(printed[pid], HasSubstr("red /nowhere:"));
}

TEST_F(PosixRunnerTest, GivesChildrenACleanSignalState) {
  struct sigaction ignore {
  }, before{};
  ignore.sa_handler = SIG_IGN;
  sigaction(SIGINT, &ignore, &before);
  const int pid = start("sh -c 'grep -E \"Sig(Blk|Ign)\" /proc/self/status; echo end'");
  sigaction(SIGINT, &before, nullptr);
  await_end(pid);
  EXPECT_THAT(printed[pid], HasSubstr("SigBlk:\t0000000000000000"));
  EXPECT_THAT(printed[pid], HasSubstr("SigIgn:\t0000000000000000"));
}

TEST_F(PosixRunnerTest, StopsAChildBySignal) {
  const int pid = start("sleep 1000");
  runner.signal(pid, SIGINT);
  EXPECT_EQ(await_end(pid), SIGINT);
}

TEST_F(PosixRunnerTest, KillsAChildThatIgnoresItsStopSignal) {
  const int pid = start("sh -c 'trap \"\" INT; echo armed; while :; do sleep 1000; done'");
  await_text(pid, "armed");
  runner.signal(pid, SIGINT);
  runner.signal(pid, SIGKILL);
  EXPECT_EQ(await_end(pid), SIGKILL);
}

TEST_F(PosixRunnerTest, LeavesNoGrandchildBehindNotEvenOneInASessionOfItsOwn) {
  const int pid = start("sh -c 'sleep 1000 & echo first $!; setsid sleep 1000 & echo second $!; wait'");
  await_text(pid, "second ");
  await_text(pid, "\n");
  // the shell says the second's number before that has its session, and would end well if it lost both at once
  const auto has_session = [](int descendant) { return getsid(descendant) == descendant; };
  std::vector<int> descendants;
  while (descendants.size() < 2 || std::none_of(descendants.begin(), descendants.end(), has_session)) {
    await_event();
    descendants = descendants_of(pid);
  }
  EXPECT_EQ(descendants.size(), 2U);
  runner.signal(pid, SIGKILL);
  EXPECT_EQ(await_end(pid), SIGKILL);
  for (const int descendant : descendants) {
    while (is_alive(descendant)) {
      await_event();
    }
  }
}

TEST_F(PosixRunnerTest, LetsADescendantInASessionOfItsOwnFinishWhatItHasToDo) {
  // as the guardian of a robot's driver does: it sees its parent die, ignores SIGTERM and works on
  const int pid = start(
      "sh -c 'mkfifo $0/pipe; exec 3<>$0/pipe; "
      "setsid sh -c \"trap \\\"\\\" INT TERM HUP; echo guards; cat; touch $0/done\" <$0/pipe 3>&- & wait' " +
      folder.path().string());
  await_text(pid, "guards");
  runner.signal(pid, SIGKILL);
  EXPECT_EQ(await_end(pid), SIGKILL);
  while (!std::filesystem::exists(folder.path() / "done")) {
    await_event();
  }
}

TEST_F(PosixRunnerTest, MeasuresAChildWithItsDescendants) {
  const int pid = start("sh -c 'sh -c \"while :; do :; done\" & wait'");
  // the child itself does next to nothing: this much can only be the grandchild's
  constexpr std::int64_t kMuch = 50'000;  // [us]
  while (runner.usage(pid).cpu < kMuch) {
    await_event();
  }
  EXPECT_LT(read_process_stat(pid)->cpu, kMuch);
  EXPECT_GT(runner.usage(pid).resident_bytes, read_process_stat(pid)->resident_bytes);
}

TEST(PosixRunner, ChildrenDoNotOutliveADeputyThatIsKilled) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t deputy = fork();
  if (deputy == 0) {
    PosixRunner runner{"/nowhere"};
    // the first dies at SIGTERM, the second only at SIGKILL
    const auto none = [](const std::string&) -> std::optional<std::string> { return std::nullopt; };
    const int pids[2] = {runner.start(split_command("sleep 1000", none)),
                         runner.start(split_command("sh -c 'trap \"\" TERM HUP; while :; do sleep 1000; done'", none))};
    [[maybe_unused]] const ssize_t written = write(ends[1], pids, sizeof pids);
    while (true) {
      pause();
    }
  }
  int pids[2] = {0, 0};
  ASSERT_EQ(read(ends[0], pids, sizeof pids), static_cast<ssize_t>(sizeof pids));
  kill(deputy, SIGKILL);
  waitpid(deputy, nullptr, 0);
  for (const int pid : pids) {
    while (is_alive(pid)) {
      sched_yield();
    }
  }
  close(ends[0]);
  close(ends[1]);
}

/// A deputy with real children and a sheriff, on the clock of the wall but judged by events only.
class RealDeputyTest : public ::testing::Test {
 protected:
  void run_until(const std::function<bool()>& done) {
    while (!done()) {
      pollfd descriptor{runner.event_descriptor(), POLLIN, 0};
      poll(&descriptor, 1, 10);
      const Instant now = Instant::read();
      deputy->tick(now);
      sheriff->tick(now);
      while (lcm.handleTimeout(0) > 0) {
      }
    }
  }
  Condition condition(const std::string& name) {
    return sheriff->states({Target::Kind::kCommand, name}).at(0).condition;
  }
  void launch(const std::string& text, const RespawnParams& respawn = {}) {
    const PmdFile file = parse_pmd(text, "test.pmd");
    DeputyConfig config;
    config.id = "d";
    config.allowed = file.commands;
    config.respawn = respawn;
    deputy = std::make_unique<Deputy>(lcm, config, runner);
    sheriff = std::make_unique<Sheriff>(lcm, file, SheriffConfig{.id = "h:1:1"});
  }
  PosixRunner runner{"/nowhere"};
  lcm::LCM lcm{"memq://"};
  std::unique_ptr<Deputy> deputy;
  std::unique_ptr<Sheriff> sheriff;
};

TEST_F(RealDeputyTest, StartsRestartsAndStopsRealProcesses) {
  launch(R"(cmd "sleeper" { exec = "sleep 1000"; deputy = "d"; }
            cmd "stubborn" { exec = "sh -c 'trap \"\" INT; while :; do sleep 1000; done'"; deputy = "d"; stop_time_allowed = 1; })");
  sheriff->start({});
  run_until([&] { return sheriff->all_ready({}); });
  const int first = sheriff->states()[0].pid;
  sheriff->restart({Target::Kind::kCommand, "sleeper"});
  run_until([&] { return sheriff->states()[0].pid != first && condition("sleeper") == Condition::kReady; });
  EXPECT_FALSE(is_alive(first));
  sheriff->stop({});
  run_until([&] { return sheriff->all_stopped({}); });
  EXPECT_TRUE(deputy->all_stopped());
  EXPECT_EQ(sheriff->states()[0].exit_code, SIGINT);
}

TEST_F(RealDeputyTest, GivesUpACrasher) {
  launch(R"(cmd "crasher" { exec = "sh -c 'exit 3'"; deputy = "d"; auto_respawn = "true"; })",
         {.first_delay = 0.001, .longest_delay = 0.01, .settled_after = 10.0, .limit = 5});
  sheriff->start({});
  run_until([&] { return condition("crasher") == Condition::kGaveUp; });
  EXPECT_EQ(sheriff->states()[0].exit_code, kGaveUpStatus);
  EXPECT_EQ(sheriff->states()[0].pid, 0);
}

}  // namespace
}  // namespace luminav::launcher
