#include "services/launcher/sheriff/script_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/configuration/toml_table.hpp"
#include "tests/node/launcher/launcher_world.hpp"

namespace luminav::launcher {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using Progress = ScriptRun::Progress;

constexpr const char* kFile = R"(
  group "drivers" { cmd "camera" { deputy = "d"; exec = "$LUMINAV_BIN/camera"; auto_respawn = "true"; } }
  cmd "mapper" { deputy = "d"; exec = "$LUMINAV_BIN/mapper"; }
  cmd "once" { deputy = "d"; exec = "tool"; }
  script "go" { start group "drivers" wait "running"; start cmd "mapper" wait "running"; }
  script "pause" { wait ms 500; start cmd "mapper"; }
  script "once" { start cmd "once" wait "running"; }
  script "both" { run_script "go"; stop cmd "camera" wait "stopped"; wait cmd "mapper" status "running"; })";

class ScriptRunTest : public ::testing::Test {
 protected:
  ScriptRunTest() : file(parse_pmd(kFile, "f.pmd")), sheriff(world.add_sheriff(file, "h:1:1")) {}
  void add_deputy() {
    world.add_deputy(file.commands);
    world.run(1.0);
  }
  Progress run(ScriptRun& script, double seconds) {
    Progress progress = script.step(world.now.steady);
    for (int i = 0; i < static_cast<int>(seconds * 20.0 + 0.5) && progress == Progress::kGoingOn; ++i) {
      world.run(0.05);
      progress = script.step(world.now.steady);
    }
    return progress;
  }
  LauncherWorld world;
  PmdFile file;
  Sheriff& sheriff;
};

TEST_F(ScriptRunTest, StartsOneAfterTheOtherWhenEachIsReady) {
  add_deputy();
  ScriptRun script(sheriff, file, "go");
  EXPECT_EQ(run(script, 2.0), Progress::kGoingOn);
  EXPECT_THAT(world.runner.running, SizeIs(1)) << "the mapper waits for the camera's word";
  EXPECT_THAT(script.message(), HasSubstr("camera"));
  world.say_ready("camera");
  EXPECT_EQ(run(script, 1.0), Progress::kGoingOn);
  EXPECT_THAT(world.runner.running, SizeIs(2));
  world.say_ready("mapper");
  EXPECT_EQ(run(script, 1.0), Progress::kSucceeded);
  EXPECT_THAT(script.started(), SizeIs(2));
}

TEST_F(ScriptRunTest, GoesOnWhenAProcessWorksWithAShortcoming) {
  add_deputy();
  ScriptRun script(sheriff, file, "go");
  run(script, 0.2);
  world.say_ready("camera", node_status_t::STATE_FAULT);
  EXPECT_EQ(run(script, 1.0), Progress::kGoingOn);
  EXPECT_THAT(world.runner.running, SizeIs(1)) << "a camera at fault sees nothing";
  world.say_ready("camera", node_status_t::STATE_DEGRADED);
  EXPECT_EQ(run(script, 1.0), Progress::kGoingOn);
  EXPECT_THAT(world.runner.running, SizeIs(2));
  world.say_ready("mapper", node_status_t::STATE_DEGRADED);
  EXPECT_EQ(run(script, 1.0), Progress::kSucceeded);
}

TEST_F(ScriptRunTest, FailsWhenAWaitTakesTooLong) {
  add_deputy();
  ScriptRun script(sheriff, file, "go", 3.0);
  EXPECT_EQ(run(script, 2.9), Progress::kGoingOn);
  EXPECT_EQ(run(script, 0.3), Progress::kFailed);
  EXPECT_THAT(script.message(), HasSubstr("waited 3 s for group \"drivers\""));
  EXPECT_THAT(script.message(), HasSubstr("not yet ready"));
}

TEST_F(ScriptRunTest, SaysThatADeputyIsMissing) {
  ScriptRun script(sheriff, file, "go", 3.0);
  EXPECT_EQ(run(script, 4.0), Progress::kFailed);
  EXPECT_THAT(script.message(), HasSubstr("deputy d is not heard"));
}

TEST_F(ScriptRunTest, FailsAtOnceWhenAProcessFails) {
  add_deputy();
  ScriptRun script(sheriff, file, "pause");
  EXPECT_EQ(run(script, 1.0), Progress::kSucceeded);
  Action wait;
  wait.kind = Action::Kind::kStart;
  wait.target = {Target::Kind::kCommand, "mapper"};
  wait.await = AwaitedStatus::kRunning;
  ScriptRun start(sheriff, wait);
  EXPECT_EQ(run(start, 0.2), Progress::kGoingOn);
  world.runner.end(world.runner.last_pid, 3 << 8);
  EXPECT_EQ(run(start, 0.2), Progress::kFailed);
  EXPECT_THAT(start.message(), HasSubstr("mapper: failed (exit 3)"));
}

TEST_F(ScriptRunTest, WaitsForATime) {
  add_deputy();
  ScriptRun script(sheriff, file, "pause");
  EXPECT_EQ(run(script, 0.4), Progress::kGoingOn);
  EXPECT_THAT(world.runner.running, IsEmpty());
  EXPECT_EQ(run(script, 0.2), Progress::kSucceeded);
}

TEST_F(ScriptRunTest, TakesAProgramThatDidItsWorkForSuccess) {
  add_deputy();
  ScriptRun script(sheriff, file, "once");
  EXPECT_EQ(run(script, 0.2), Progress::kGoingOn);
  world.runner.end(world.runner.last_pid, 0);
  EXPECT_EQ(run(script, 0.2), Progress::kSucceeded);
}

TEST_F(ScriptRunTest, RunsScriptsWithinScriptsAndWaitsForTheEnd) {
  add_deputy();
  world.runner.stubborn.insert("$LUMINAV_BIN/camera");
  ScriptRun script(sheriff, file, "both");
  run(script, 0.2);
  world.say_ready("camera");
  run(script, 0.2);
  world.say_ready("mapper");
  EXPECT_EQ(run(script, 2.0), Progress::kGoingOn) << "the camera is stubborn";
  world.say_ready("mapper");
  EXPECT_EQ(run(script, 5.5), Progress::kGoingOn) << "the mapper has fallen silent";
  world.say_ready("mapper");
  EXPECT_EQ(run(script, 0.2), Progress::kSucceeded);
}

TEST_F(ScriptRunTest, FailsForAProcessThatIsGivenUp) {
  add_deputy();
  ScriptRun script(sheriff, file, "go", 120.0);
  Progress progress = run(script, 0.2);
  for (int i = 0; i < 2000 && progress == Progress::kGoingOn; ++i) {
    world.runner.end(world.runner.last_pid, 1 << 8);
    progress = run(script, 0.05);
  }
  EXPECT_EQ(progress, Progress::kFailed);
  EXPECT_THAT(script.message(), HasSubstr("gave up"));
}

TEST_F(ScriptRunTest, RefusesAScriptThatIsNotThere) {
  EXPECT_THROW(ScriptRun(sheriff, file, "nothing"), ConfigurationError);
}

}  // namespace
}  // namespace luminav::launcher
