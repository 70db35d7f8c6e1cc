#include "tests/evaluation/sensing/sensing_agreement.hpp"

#include <fmt/format.h>

#include <cmath>

#include "tests/evaluation/report/report_runs.hpp"

namespace luminav {
namespace {

using nlohmann::json;

constexpr double kTolerance = 0.20;
constexpr int kEnoughRuns = 100;

bool is_near(double value, double reference) {
  return std::abs(value - reference) <= kTolerance * reference;
}

struct Sums {
  double passed = 0.0;
  double square = 0.0;
  double heading_square = 0.0;
  double nees = 0.0;
  int measured = 0;
  void add(const json& run) {
    // null, or 0 in older reports, where it was never TRACKING with a fixture in view
    const auto number = [&run](const char* key) {
      const auto found = run.find(key);
      return found != run.end() && found->is_number() ? found->get<double>() : 0.0;
    };
    passed += run.value("passed", false) ? 1.0 : 0.0;
    if (number("in_view_position_rms_m") > 0.0) {
      square += std::pow(number("in_view_position_rms_m"), 2);
      heading_square += std::pow(number("in_view_heading_rms_deg"), 2);
      nees += number("nees");
      ++measured;
    }
  }
  [[nodiscard]] double mean(double sum) const { return measured > 0 ? sum / measured : 0.0; }
};

}  // namespace

bool SensingAgreement::agrees() const {
  return runs > 0 && is_near(geometric_success, rendered_success) && is_near(geometric_rms, rendered_rms);
}

SensingAgreement compare_sensings(const std::string& rendered_json, const std::string& geometric_json) {
  const ReportRuns rendered = runs_of_report(rendered_json, "the rendered");
  const ReportRuns geometric = runs_of_report(geometric_json, "the geometric");
  Sums r;
  Sums g;
  SensingAgreement result;
  for (const auto& [key, run] : rendered) {
    if (const auto found = geometric.find(key); found != geometric.end()) {
      ++result.runs;
      r.add(run);
      g.add(found->second);
    }
  }
  if (result.runs > 0) {
    result.rendered_success = r.passed / result.runs;
    result.geometric_success = g.passed / result.runs;
    result.rendered_rms = std::sqrt(r.mean(r.square));
    result.geometric_rms = std::sqrt(g.mean(g.square));
    result.rendered_heading_rms = std::sqrt(r.mean(r.heading_square));
    result.geometric_heading_rms = std::sqrt(g.mean(g.heading_square));
    result.rendered_nees = r.mean(r.nees);
    result.geometric_nees = g.mean(g.nees);
  }
  return result;
}

std::string to_text(const SensingAgreement& a) {
  return fmt::format(
      "geometric sensing against rendered on {} common runs: passed {:.1f} % against {:.1f} %, RMS in view {:.1f} mm "
      "against {:.1f} mm and {:.2f} against {:.2f} degrees, NEES {:.2f} against {:.2f}.\n{}\n",
      a.runs, 100.0 * a.geometric_success, 100.0 * a.rendered_success, 1e3 * a.geometric_rms, 1e3 * a.rendered_rms,
      a.geometric_heading_rms, a.rendered_heading_rms, a.geometric_nees, a.rendered_nees,
      !a.agrees()            ? "They do NOT agree within 20 %: geometric figures may not be quoted."
      : a.runs < kEnoughRuns ? "Success and RMS agree within 20 %, but on fewer than 100 runs: not to be quoted yet."
                             : "Success and RMS agree within 20 %: geometric figures may be quoted.");
}

}  // namespace luminav
