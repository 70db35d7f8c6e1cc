// Lets lamps fail in many drawn buildings and says how soon the report tells, and what it tells wrongly. Not part of
// the test run: lamp_trials --runs 100 --seed 1000

#include <fmt/format.h>

#include <algorithm>

#include "services/common/process/command_line.hpp"
#include "tests/unit/caretaker/hundred_days.hpp"

int main(int argc, char** argv) {
  std::int64_t runs = 20;
  std::int64_t seed = 1;
  luminav::CommandLine line("lamp_trials", "Judges the report on lamps in drawn hundred days.");
  line.integer("--runs", runs, "of a hundred days").integer("--seed", seed, "first seed");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  return luminav::run_guarded("lamp_trials", [&] {
    luminav::HundredDays sum;
    std::size_t false_reports = 0;
    std::size_t most = 0;
    for (std::int64_t run = 0; run < runs; ++run) {
      const luminav::HundredDays outcome = luminav::simulate_hundred_days(static_cast<std::uint64_t>(seed + run));
      sum.failures += outcome.failures;
      sum.late += outcome.late;
      sum.latest = std::max(sum.latest, outcome.latest);
      sum.changes += outcome.changes;
      false_reports += outcome.false_reports.size();
      most = std::max(most, outcome.false_reports.size());
    }
    fmt::print(
        "{} runs of 100 days, {} failures: {} not reported within three passes in light that shows them, the latest "
        "after {}; {} false reports, {} in one run at most; {} changes proposed\n",
        runs, sum.failures, sum.late, sum.latest, false_reports, most, sum.changes);
    return 0;
  });
}
