#include "tests/evaluation/report/evaluation_report.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace luminav {
namespace {

using nlohmann::json;

RunReport run(bool passed, bool localized) {
  RunReport r;
  r.scenario = "s";
  r.passed = passed;
  r.localized = localized;
  r.localized_after_m = localized ? 4.0 : 0.0;
  r.in_view_position_rms_m = 0.02;
  r.tracking_ratio = 1.0;
  r.simulated_s = 100.0;
  r.cpu_s = 0.5;
  r.wall_s = 7.0;
  r.contacts = 1;
  r.min_clearance_m = 0.1;
  GoalResult reached;
  reached.reached = true;
  reached.error_m = 0.04;
  GoalResult refused;
  refused.refused = true;
  refused.expect_refused = true;
  r.goals = {reached, refused};
  return r;
}

json summary(const std::vector<RunReport>& runs, const std::vector<DetectorCondition>& detector = {}) {
  return json::parse(to_json("suite", "default", "rendered", runs, detector))["summary"];
}

TEST(RunReport, HasItsPartsInTheOrderThatReadersExpect) {
  const auto all = nlohmann::ordered_json::parse(to_json("quick", "paper", "geometric", {run(true, true)}));
  std::vector<std::string> keys;
  for (const auto& [key, value] : all.items()) {
    keys.push_back(key);
  }
  EXPECT_THAT(keys, testing::ElementsAre("suite", "mode", "sensing", "summary", "runs"));
  EXPECT_EQ(all["suite"], "quick");
  EXPECT_EQ(all["mode"], "paper");
  EXPECT_EQ(all["sensing"], "geometric");
}

TEST(RunReport, SumsUpEachScenarioWhereThereAreSeveral) {
  RunReport other = run(false, false);
  other.scenario = "elsewhere";
  const auto all =
      nlohmann::ordered_json::parse(to_json("custom", "modern", "rendered", {run(true, true), other, run(true, true)}));
  ASSERT_EQ(all["scenarios"].size(), 2U);
  EXPECT_EQ(all["scenarios"]["elsewhere"]["runs"], 1);
  EXPECT_EQ(all["scenarios"]["elsewhere"]["passed"], 0);
  EXPECT_EQ(all["summary"]["runs"], 3);
}

TEST(RunReport, SumsUpOverRuns) {
  const json s = summary({run(true, true), run(false, false)});
  EXPECT_EQ(s["runs"], 2);
  EXPECT_EQ(s["passed"], 1);
  EXPECT_EQ(s["localized_ratio"], 0.5);
  EXPECT_EQ(s["localized_after_m_median"], 4.0);
  EXPECT_EQ(s["in_view_position_rms_m"], 0.02);  // of those that were localized
  EXPECT_EQ(s["contacts"], 2);
  EXPECT_EQ(s["min_clearance_m"], 0.1);
}

TEST(RunReport, CountsGoalsToReachAndGoalsToRefuseApart) {
  const json s = summary({run(true, true), run(true, true)});
  EXPECT_EQ(s["goals"], 2);
  EXPECT_EQ(s["goals_reached"], 2);
  EXPECT_EQ(s["goals_to_refuse"], 2);
  EXPECT_EQ(s["refused_right"], 2);
}

TEST(RunReport, MeasuresSpeedPerCore) {
  EXPECT_EQ(summary({run(true, true), run(true, true)})["real_time_factor"], 200.0);
}

TEST(RunReport, LeavesOutWhatWasNotMeasured) {
  const json s = summary({run(false, false)});
  for (const char* key : {"localized_after_m_median", "tracking_ratio", "nees", "carries", "wall_median_m", "precision",
                          "mean_speed_m_s", "path_efficiency"}) {
    EXPECT_FALSE(s.contains(key)) << key;
  }
}

TEST(RunReport, LeavesOutTheErrorsOfARunThatWasNeverTracking) {
  RunReport lost = run(false, false);
  for (auto* figure : {&lost.in_view_position_rms_m, &lost.in_view_heading_rms_deg, &lost.mission_position_p95_m,
                       &lost.mission_heading_p95_deg, &lost.nees}) {
    figure->reset();
  }
  const json one = json::parse(to_json(lost));
  const json of_lost = summary({lost});
  for (const char* key : {"in_view_position_rms_m", "in_view_heading_rms_deg", "mission_position_p95_m",
                          "mission_heading_p95_deg", "nees"}) {
    EXPECT_TRUE(one.at(key).is_null()) << key;
    EXPECT_FALSE(of_lost.contains(key)) << key;
  }
  EXPECT_EQ(summary({lost, run(true, true)})["in_view_position_rms_m"], 0.02);
  EXPECT_THAT(to_text(lost), testing::Not(testing::HasSubstr("pose error")));
  EXPECT_THAT(scenario_table_text({lost}), testing::Not(testing::HasSubstr(" mm ")));
}

TEST(RunReport, SaysHowFarOffTheGoalOnlyWhereOneWasReached) {
  RunReport missed = run(false, true);
  missed.goals[0].reached = false;
  missed.goals[0].error_m = 5.0;
  const json s = summary({missed});
  EXPECT_EQ(s["goals_reached"], 0);
  EXPECT_FALSE(s.contains("goal_error_p95_m"));
  EXPECT_EQ(summary({missed, run(true, true)})["goal_error_p95_m"], 0.04);
}

TEST(RunReport, TakesHeadingsOnlyOfGoalsThatAskedForOne) {
  EXPECT_FALSE(summary({run(true, true)}).contains("goal_heading_p95_deg"));
  EXPECT_TRUE(json::parse(to_json(run(true, true)))["goals"][0]["heading_error_deg"].is_null());
  RunReport asked = run(true, true);
  asked.goals[0].heading_error_deg = 3.0;
  EXPECT_EQ(summary({asked, run(true, true)})["goal_heading_p95_deg"], 3.0);
}

TEST(RunReport, TakesTheDetectorsFiguresFromTheWholeMatrix) {
  const json s = summary(
      {}, {{.name = "lit", .precision = 1.0, .recall = 0.9, .centre_rms_px = 0.2, .orientation_rms_deg = 0.1},
           {.name = "matrix", .precision = 0.99, .recall = 0.8, .centre_rms_px = 0.3, .orientation_rms_deg = 0.2}});
  EXPECT_EQ(s["precision"], 0.99);
  EXPECT_EQ(s["recall"], 0.8);
  EXPECT_EQ(s["centre_rms_px"], 0.3);
  EXPECT_EQ(s["orientation_rms_deg"], 0.2);
}

TEST(RunReport, ComparesTheWayUntilLocalizedWithTheLeastThatTellsThePose) {
  RunReport near = run(true, true);  // 4 m
  near.resolvable_after_m = 2.0;
  RunReport at_once = near;
  at_once.resolvable_after_m = 0.0;  // counts as the audit's grid, 0.25 m
  RunReport never = near;
  never.resolvable_after_m = std::numeric_limits<double>::infinity();
  const json s = summary({near, near, at_once, never, run(true, true), run(false, false)});
  EXPECT_EQ(s["way_ratio_median"], 2.0);
  EXPECT_NEAR(s["way_ratio_p95"].get<double>(), 14.6, 1e-9);
  EXPECT_EQ(s["resolvable_after_m_median"], 2.0);
  EXPECT_TRUE(json::parse(to_json(never))["resolvable_after_m"].is_null());
}

TEST(RunReport, NamesWhatTheDesignNames) {
  const json r = json::parse(to_json(run(true, true)));
  for (const char* key : {"scenario",
                          "seed",
                          "passed",
                          "simulated_s",
                          "wall_s",
                          "world",
                          "localized_s",
                          "localized_after_m",
                          "resolvable_after_m",
                          "tracking_ratio",
                          "confident_wrong_s",
                          "in_view_position_rms_m",
                          "in_view_heading_rms_deg",
                          "mission_position_p95_m",
                          "mission_heading_p95_deg",
                          "mean_speed_m_s",
                          "path_efficiency",
                          "goals",
                          "contacts",
                          "min_clearance_m",
                          "map",
                          "processes"}) {
    EXPECT_TRUE(r.contains(key)) << key;
  }
}

}  // namespace
}  // namespace luminav
