#pragma once

#include <string>
#include <vector>

namespace luminav {

enum class Verdict { kSame, kBetter, kWorse };

/// One figure in two evaluations, over the runs (scenario and seed) that both have and that both measured.
struct ComparedFigure {
  std::string name;
  int pairs = 0;
  double before = 0.0;  // mean over the pairs
  double now = 0.0;
  double low = 0.0;  // 95 % interval of the mean difference, now less before
  double high = 0.0;
  Verdict verdict = Verdict::kSame;
};

struct ReportComparison {
  int common = 0;  // runs in both
  int only_old = 0;
  int only_new = 0;
  bool same_worlds = true;  // the hashes of the drawn worlds agree
  std::vector<ComparedFigure> figures;
};

/// Compares two texts of `evaluate --json` run by run. For shares of runs: exact sign test on the runs that differ,
/// p < 0.05. For all else: paired bootstrap of the mean difference (Efron 1979), 10,000 seeded draws, better or worse
/// when the 95 % interval excludes zero and at least five pairs differ. Throws std::runtime_error for text that is no
/// report.
ReportComparison compare_reports(const std::string& old_json, const std::string& new_json);

/// Lines for people; says which test was used.
std::string to_text(const ReportComparison& comparison);

}  // namespace luminav
