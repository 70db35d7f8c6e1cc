#include "tests/evaluation/report/compare_reports.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

namespace luminav {
namespace {

using nlohmann::json;

/// A report of runs with these figures; seeds count up from 1.
std::string report(const std::vector<double>& rms, const std::vector<bool>& passed = {}, const char* hash = "a") {
  json runs = json::array();
  for (std::size_t i = 0; i < rms.size(); ++i) {
    runs.push_back({{"scenario", "s"},
                    {"seed", i + 1},
                    {"passed", passed.empty() || passed[i]},
                    {"confident_wrong_s", 0.0},
                    {"in_view_position_rms_m", rms[i]},
                    {"world", {{"hash", hash}}}});
  }
  return json{{"suite", "x"}, {"runs", runs}}.dump();
}

ComparedFigure figure(const ReportComparison& comparison, const std::string& name) {
  for (const ComparedFigure& f : comparison.figures) {
    if (f.name == name) {
      return f;
    }
  }
  throw std::runtime_error("no figure " + name);
}

TEST(CompareReports, FindsNoDifferenceBetweenAReportAndItself) {
  const std::string same = report({0.01, 0.02, 0.03, 0.02, 0.01, 0.02});
  for (const ComparedFigure& f : compare_reports(same, same).figures) {
    EXPECT_EQ(f.verdict, Verdict::kSame) << f.name;
    EXPECT_EQ(f.low, 0.0);
    EXPECT_EQ(f.high, 0.0);
  }
}

TEST(CompareReports, SeesASmallShiftThatAllPairsShare) {
  // 2 mm on runs that differ by 20 mm: only the pairing shows it.
  const auto comparison = compare_reports(report({0.010, 0.020, 0.030, 0.040, 0.050, 0.060}),
                                          report({0.008, 0.018, 0.0279, 0.0381, 0.048, 0.058}));
  const ComparedFigure f = figure(comparison, "in_view_position_rms_m");
  EXPECT_EQ(f.verdict, Verdict::kBetter);
  EXPECT_NEAR(f.before, 0.035, 1e-9);
  EXPECT_NEAR(f.now, 0.033, 1e-9);
  EXPECT_LT(f.high, 0.0);
}

TEST(CompareReports, SaysWorseTheOtherWayRound) {
  const auto comparison = compare_reports(report({0.008, 0.018, 0.0279, 0.0381, 0.048, 0.058}),
                                          report({0.010, 0.020, 0.030, 0.040, 0.050, 0.060}));
  EXPECT_EQ(figure(comparison, "in_view_position_rms_m").verdict, Verdict::kWorse);
}

TEST(CompareReports, TakesScatterForNoise) {
  const auto comparison = compare_reports(report({0.010, 0.020, 0.030, 0.040, 0.050, 0.060}),
                                          report({0.014, 0.017, 0.033, 0.036, 0.053, 0.058}));
  EXPECT_EQ(figure(comparison, "in_view_position_rms_m").verdict, Verdict::kSame);
}

TEST(CompareReports, NeedsMoreThanAFewPairs) {
  const auto comparison = compare_reports(report({0.010, 0.020, 0.030}), report({0.005, 0.015, 0.025}));
  EXPECT_EQ(figure(comparison, "in_view_position_rms_m").verdict, Verdict::kSame);
}

TEST(CompareReports, CountsOnlyRunsThatDifferInTheSignTest) {
  const std::vector<double> rms(20, 0.01);
  std::vector<bool> five_failed(20, true);
  std::vector<bool> six_failed(20, true);
  std::fill_n(five_failed.begin(), 5, false);
  std::fill_n(six_failed.begin(), 6, false);
  // 2 * (1/2)^5 = 0.063, 2 * (1/2)^6 = 0.031
  EXPECT_EQ(figure(compare_reports(report(rms), report(rms, five_failed)), "passed").verdict, Verdict::kSame);
  EXPECT_EQ(figure(compare_reports(report(rms), report(rms, six_failed)), "passed").verdict, Verdict::kWorse);
  EXPECT_EQ(figure(compare_reports(report(rms, six_failed), report(rms)), "passed").verdict, Verdict::kBetter);
}

/// Runs that were localized, or never were.
std::string localized_report(const std::vector<bool>& localized) {
  json report = json::parse(luminav::report(std::vector<double>(localized.size(), 0.02)));
  for (std::size_t i = 0; i < localized.size(); ++i) {
    json& run = report["runs"][i];
    run["localized_s"] = localized[i] ? json(12.0) : json(nullptr);
    run["in_view_position_rms_m"] = localized[i] ? json(0.02) : json(nullptr);
    run["nees"] = localized[i] ? json(1.1) : json(nullptr);
    run["tracking_ratio"] = localized[i] ? 0.98 : 0.0;
  }
  return report.dump();
}

TEST(CompareReports, SeesRunsThatAreNoLongerLocalized) {
  const std::vector<bool> all(20, true);
  std::vector<bool> few = all;
  std::fill_n(few.begin(), 6, false);
  const auto comparison = compare_reports(localized_report(all), localized_report(few));
  const ComparedFigure localized = figure(comparison, "localized");
  EXPECT_EQ(localized.pairs, 20);
  EXPECT_NEAR(localized.now, 0.7, 1e-9);
  EXPECT_EQ(localized.verdict, Verdict::kWorse);
  const ComparedFigure tracking = figure(comparison, "tracking_ratio");
  EXPECT_EQ(tracking.pairs, 20);
  EXPECT_EQ(tracking.verdict, Verdict::kWorse);
  EXPECT_EQ(figure(comparison, "in_view_position_rms_m").pairs, 14);
  EXPECT_EQ(figure(comparison, "|log nees|").pairs, 14);
}

TEST(CompareReports, PairsByScenarioAndSeedAndCountsTheRest) {
  const auto comparison = compare_reports(report({0.01, 0.02, 0.03}), report({0.01, 0.02, 0.03, 0.04, 0.05}));
  EXPECT_EQ(comparison.common, 3);
  EXPECT_EQ(comparison.only_old, 0);
  EXPECT_EQ(comparison.only_new, 2);
  EXPECT_TRUE(comparison.same_worlds);
}

TEST(CompareReports, NoticesOtherWorlds) {
  const auto comparison = compare_reports(report({0.01}), report({0.01}, {}, "b"));
  EXPECT_FALSE(comparison.same_worlds);
  EXPECT_THAT(to_text(comparison), testing::HasSubstr("drawn worlds differ"));
}

TEST(CompareReports, RefusesWhatIsNoReport) {
  EXPECT_THROW(compare_reports("{}", report({0.01})), std::runtime_error);
  EXPECT_THROW(compare_reports("nonsense", report({0.01})), std::runtime_error);
  json twice = json::parse(report({0.01, 0.02}));
  twice["runs"][1]["seed"] = 1;
  EXPECT_THROW(compare_reports(twice.dump(), report({0.01})), std::runtime_error);
}

TEST(CompareReports, ComparesTheDetectorConditionByCondition) {
  const auto detector = [](double worse) {
    json conditions = json::array();
    for (const char* name : {"on", "dim", "half", "flicker", "glare", "moving"}) {
      conditions.push_back({{"condition", name}, {"recall", 0.95 - worse}, {"precision", 0.99}});
    }
    return json{{"suite", "detector"}, {"runs", json::array()}, {"detector", conditions}}.dump();
  };
  EXPECT_EQ(figure(compare_reports(detector(0.0), detector(0.02)), "recall").verdict, Verdict::kWorse);
  EXPECT_EQ(figure(compare_reports(detector(0.0), detector(0.02)), "precision").verdict, Verdict::kSame);
}

}  // namespace
}  // namespace luminav
