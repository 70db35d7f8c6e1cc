#include "tests/evaluation/report/compare_reports.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <random>

#include "tests/evaluation/report/report_runs.hpp"

namespace luminav {
namespace {

using nlohmann::json;

constexpr int kDraws = 10'000;
constexpr int kMinDifferent = 5;
constexpr double kSignificance = 0.05;

struct Figure {
  std::string name;
  int better;  // +1: more is better, -1: less is better
  bool is_yes_or_no;
  std::function<std::optional<double>(const json&)> value;
};

std::function<std::optional<double>(const json&)> field(const std::string& name) {
  return [name](const json& run) -> std::optional<double> {
    const auto found = run.find(name);
    return found != run.end() && found->is_number() ? std::optional<double>(found->get<double>()) : std::nullopt;
  };
}

/// Fields that are null, or 0 in older reports, when nothing was measured.
std::function<std::optional<double>(const json&)> measured(const std::string& name) {
  return [get = field(name)](const json& run) -> std::optional<double> {
    const auto value = get(run);
    return value && *value > 0.0 ? value : std::nullopt;
  };
}

std::function<std::optional<double>(const json&)> map_field(const std::string& name) {
  return [get = field(name)](const json& run) -> std::optional<double> {
    const auto map = run.find("map");
    return map != run.end() && map->is_object() ? get(*map) : std::nullopt;
  };
}

std::vector<Figure> figures() {
  const auto passed = [](const json& run) -> std::optional<double> { return run.value("passed", false) ? 1.0 : 0.0; };
  const auto confident_wrong = [](const json& run) -> std::optional<double> {
    return run.value("confident_wrong_s", 0.0) > 0.0 ? 1.0 : 0.0;
  };
  const auto goal_time = [](const json& run) -> std::optional<double> {
    double sum = 0.0;
    int reached = 0;
    for (const json& goal : run.value("goals", json::array())) {
      if (goal.value("reached", false)) {
        sum += goal.value("time_s", 0.0);
        ++reached;
      }
    }
    return reached > 0 ? std::optional<double>(sum / reached) : std::nullopt;
  };
  const auto in_precision = [nees = measured("nees")](const json& run) -> std::optional<double> {
    const auto value = nees(run);
    return value ? std::optional<double>(std::abs(std::log(*value))) : std::nullopt;
  };
  // localized_s is null where it never was
  const auto localized = [](const json& run) -> std::optional<double> {
    const auto found = run.find("localized_s");
    return found == run.end() ? std::nullopt : std::optional<double>(found->is_number() ? 1.0 : 0.0);
  };
  return {
      {"passed", 1, true, passed},
      {"confident_wrong_runs", -1, true, confident_wrong},
      {"contacts", -1, false, field("contacts")},
      {"localized", 1, true, localized},
      {"localized_s", -1, false, field("localized_s")},
      {"localized_after_m", -1, false, field("localized_after_m")},
      {"tracking_ratio", 1, false, field("tracking_ratio")},
      {"in_view_position_rms_m", -1, false, measured("in_view_position_rms_m")},
      {"in_view_heading_rms_deg", -1, false, measured("in_view_heading_rms_deg")},
      {"mission_position_p95_m", -1, false, measured("mission_position_p95_m")},
      {"mission_heading_p95_deg", -1, false, measured("mission_heading_p95_deg")},
      {"|log nees|", -1, false, in_precision},
      {"goal time_s", -1, false, goal_time},
      {"mean_speed_m_s", 1, false, measured("mean_speed_m_s")},
      {"path_efficiency", 1, false, measured("path_efficiency")},
      {"wall_median_m", -1, false, map_field("wall_median_m")},
      {"wall_recall", 1, false, map_field("wall_recall")},
      {"free_precision", 1, false, map_field("free_precision")},
      {"explored", 1, false, map_field("explored")},
      {"precision", 1, false, field("precision")},
      {"recall", 1, false, field("recall")},
      {"centre_rms_px", -1, false, field("centre_rms_px")},
      {"orientation_rms_deg", -1, false, field("orientation_rms_deg")},
  };
}

/// Two-sided probability of at least as uneven a split of `n` fair coins.
double sign_test(int heads, int n) {
  const int tail = std::min(heads, n - heads);
  double probability = 0.0;
  for (int k = 0; k <= tail; ++k) {
    probability += std::exp(std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) - n * std::log(2.0));
  }
  return std::min(1.0, 2.0 * probability);
}

ComparedFigure compare(const Figure& figure, const std::vector<std::pair<double, double>>& pairs) {
  ComparedFigure result;
  result.name = figure.name;
  result.pairs = static_cast<int>(pairs.size());
  std::vector<double> differences;
  int different = 0;
  int more = 0;
  for (const auto& [before, now] : pairs) {
    result.before += before / result.pairs;
    result.now += now / result.pairs;
    differences.push_back(now - before);
    different += now != before ? 1 : 0;
    more += now > before ? 1 : 0;
  }
  std::mt19937_64 rng(1);  // any seed; the same inputs give the same verdict
  std::vector<double> means;
  for (int draw = 0; draw < kDraws && different > 0; ++draw) {
    double sum = 0.0;
    for (std::size_t i = 0; i < differences.size(); ++i) {
      sum += differences[rng() % differences.size()];
    }
    means.push_back(sum / static_cast<double>(differences.size()));
  }
  if (!means.empty()) {
    std::sort(means.begin(), means.end());
    result.low = means[static_cast<std::size_t>(0.025 * kDraws)];
    result.high = means[static_cast<std::size_t>(0.975 * kDraws) - 1];
  }
  const bool beyond_noise = figure.is_yes_or_no ? sign_test(more, different) < kSignificance
                                                : different >= kMinDifferent && result.low * result.high > 0.0;
  if (beyond_noise) {
    result.verdict = (result.now - result.before) * figure.better > 0.0 ? Verdict::kBetter : Verdict::kWorse;
  }
  return result;
}

}  // namespace

ReportComparison compare_reports(const std::string& old_json, const std::string& new_json) {
  const ReportRuns old_runs = parts_of_report(old_json, "the old");
  const ReportRuns new_runs = parts_of_report(new_json, "the new");
  ReportComparison comparison;
  for (const auto& [key, run] : old_runs) {
    const auto found = new_runs.find(key);
    if (found == new_runs.end()) {
      ++comparison.only_old;
      continue;
    }
    ++comparison.common;
    const auto hash = [](const json& r) { return r.contains("world") ? r["world"].value("hash", "") : ""; };
    comparison.same_worlds = comparison.same_worlds && hash(run) == hash(found->second);
  }
  comparison.only_new = static_cast<int>(new_runs.size()) - comparison.common;
  for (const Figure& figure : figures()) {
    std::vector<std::pair<double, double>> pairs;
    for (const auto& [key, run] : old_runs) {
      const auto found = new_runs.find(key);
      if (found == new_runs.end()) {
        continue;
      }
      const auto before = figure.value(run);
      const auto now = figure.value(found->second);
      if (before && now) {
        pairs.emplace_back(*before, *now);
      }
    }
    if (!pairs.empty()) {
      comparison.figures.push_back(compare(figure, pairs));
    }
  }
  return comparison;
}

std::string to_text(const ReportComparison& comparison) {
  std::string text = fmt::format(
      "compared one by one: {} runs and conditions of the detector in both, {} only in the old report, {} only in the "
      "new one\n",
      comparison.common, comparison.only_old, comparison.only_new);
  if (!comparison.same_worlds) {
    text += "the drawn worlds differ: the truth's spread or the scenarios have changed in between\n";
  }
  text += fmt::format("  {:<26} {:>5} {:>10} {:>10}  {:<24} {}\n", "", "runs", "before", "now",
                      "95 % of the difference", "verdict");
  for (const ComparedFigure& f : comparison.figures) {
    text += fmt::format("  {:<26} {:>5} {:>10.4g} {:>10.4g}  {:<24} {}\n", f.name, f.pairs, f.before, f.now,
                        fmt::format("{:+.3g} .. {:+.3g}", f.low, f.high),
                        f.verdict == Verdict::kBetter  ? "better"
                        : f.verdict == Verdict::kWorse ? "WORSE"
                                                       : "no difference beyond noise");
  }
  return text +
         "passed, confident_wrong_runs and localized: exact sign test, p < 0.05; all else: paired bootstrap of the "
         "mean difference, 10,000 draws, 95 %\n";
}

}  // namespace luminav
