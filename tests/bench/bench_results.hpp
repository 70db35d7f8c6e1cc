#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace luminav {

/// One benchmark: what it took.
struct BenchResult {
  std::string name;
  double time = 0.0;  // median of the repetitions: CPU time of the thread, or wall clock where that is what is measured
  std::string unit;   // ns; "% of a core" for processes
  double noise = 0.0;  // coefficient of variation over the repetitions, 0 = one run only
  std::vector<std::pair<std::string, double>> counters;
};

/// Results of a whole run of `scripts/bench`, in the order they ran.
struct BenchResults {
  std::string machine;       // in general terms: cores and clock
  double load_before = 0.0;  // share of the processors' time that others took when it began
  std::vector<BenchResult> results;

  [[nodiscard]] bool is_busy() const { return load_before > 0.1; }  // nothing can be trusted then
  [[nodiscard]] const BenchResult* find(const std::string& name) const;
};

/// Takes a JSON file that Google Benchmark wrote. Throws std::runtime_error naming the file when it is another one.
void add_google_results(const std::filesystem::path& file, BenchResults& results);
/// CPU and memory of each process from a demo's report.
void add_demo_report(const std::filesystem::path& file, BenchResults& results);

BenchResults read_bench_results(const std::filesystem::path& file);
void write_bench_results(const std::filesystem::path& file, const BenchResults& results);

/// The benchmark that `name` is compared with in the same run (detector/opencv for detector/modern, cspace_opencv/N
/// for cspace/N, NAME_mrpt for NAME, ...), if it ran.
const BenchResult* peer_of(const BenchResults& results, const std::string& name);

/// A table: time, noise, how many times faster than the peer, counters; with `old`, what got faster or slower by more
/// than 5 % and three times the noise of both.
std::string bench_table(const BenchResults& results, const BenchResults* old);

}  // namespace luminav
