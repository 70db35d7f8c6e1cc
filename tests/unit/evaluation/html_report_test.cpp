#include "tests/evaluation/report/html_report.hpp"

#include <gmock/gmock.h>

#include <luminav/pose_t.hpp>

#include "tests/evaluation/report/evaluation_report.hpp"

namespace luminav {
namespace {

using testing::HasSubstr;
using testing::Not;

RunReport failed_run() {
  RunReport run;
  run.scenario = "laboratory";
  run.seed = 42;
  run.failure = "goal 2 <was> not reached";
  run.scenario_file = LUMINAV_SOURCE_DIR "/launch/scenarios/laboratory.toml";
  run.reproduce = "scripts/evaluate --scenario laboratory.toml --seeds 42";
  run.simulated_s = 20.0;
  run.log = {"   12.0 s  planner    STUCK: a & b"};
  for (int i = 0; i < 40; ++i) {
    TrailPoint point;
    point.truth = {2.0 + 0.1 * i, 7.0, 0.0};
    point.believed = {2.0 + 0.1 * i, 7.05, 0.0};
    point.odometry = {0.1 * i, 0.0, 0.0};
    point.state = i < 10 ? pose_t::STATE_AMBIGUOUS : pose_t::STATE_TRACKING;
    point.time = 0.5 * i;
    run.trail.push_back(point);
  }
  return run;
}

TEST(HtmlReport, ShowsAFailureWithItsCommandAndLog) {
  const std::vector<RunReport> runs{failed_run()};
  const std::string html = html_report({to_json("quick", "default", "rendered", runs), "", 3.0}, runs);
  EXPECT_THAT(html, HasSubstr("goal 2 &lt;was&gt; not reached"));
  EXPECT_THAT(html, HasSubstr("scripts/evaluate --scenario laboratory.toml --seeds 42"));
  EXPECT_THAT(html, HasSubstr("STUCK: a &amp; b"));
  EXPECT_THAT(html, Not(HasSubstr("<was>")));
}

TEST(HtmlReport, DrawsTheWayOverTheMapAndTheErrorOverTime) {
  const std::vector<RunReport> runs{failed_run()};
  const std::string html = html_report({to_json("quick", "default", "rendered", runs), "", 3.0}, runs);
  EXPECT_THAT(html, HasSubstr("data:image/png;base64,"));
  EXPECT_THAT(html, HasSubstr("class=\"truth\""));
  EXPECT_THAT(html, HasSubstr("class=\"error\""));
}

TEST(HtmlReport, NeedsNothingFromElsewhere) {
  const std::vector<RunReport> runs{failed_run()};
  const std::string html = html_report({to_json("quick", "default", "rendered", runs), "remark", 3.0}, runs);
  EXPECT_THAT(html, Not(HasSubstr("http://")));
  EXPECT_THAT(html, Not(HasSubstr("https://")));
  EXPECT_THAT(html, Not(HasSubstr("<script")));
  EXPECT_THAT(html, Not(HasSubstr("@import")));
}

}  // namespace
}  // namespace luminav
