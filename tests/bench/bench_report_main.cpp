#include <fmt/format.h>

#include <optional>

#include "services/common/process/command_line.hpp"
#include "tests/bench/bench_results.hpp"

int main(int argc, char** argv) {
  using namespace luminav;
  std::vector<std::string> inputs;
  std::string json;
  std::string old_file;
  std::string demo;
  double load = 0.0;
  CommandLine line("bench_report",
                   "Merges what the benchmarks wrote, prints it as a table, compares it with an older run.");
  line.positional("inputs", inputs, "JSON files of Google Benchmark", true)
      .text("--demo", demo, "report of a demo: CPU and memory of its processes")
      .output_file("--json", json, "write all results here")
      .text("--compare", old_file, "results of an older run (--json)")
      .number("--load", load, "share of the processors' time that others took before the benchmarks began");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  return run_guarded("bench", [&] {
    BenchResults results;
    results.load_before = load;
    std::optional<BenchResults> old;
    if (!old_file.empty()) {
      old = read_bench_results(old_file);
    }
    for (const std::string& input : inputs) {
      add_google_results(input, results);
    }
    if (!demo.empty()) {
      add_demo_report(demo, results);
    }
    fmt::print("{}", bench_table(results, old ? &*old : nullptr));
    if (!json.empty()) {
      write_bench_results(json, results);
    }
    return 0;
  });
}
