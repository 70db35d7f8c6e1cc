#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tests/evaluation/detector_score/detector_suite.hpp"
#include "tests/evaluation/report/run_report.hpp"

namespace luminav {

/// One of the parts an evaluation is cut into: of all its runs the I-th and every N-th after it.
struct Shard {
  int index = 1;  // from 1
  int count = 1;
};

/// Reads "I/N". Throws ConfigurationError, which names `--shard`.
Shard read_shard(const std::string& text);

/// What one machine measured of an evaluation; all of it where there is one shard.
struct ReportPart {
  Shard shard;
  std::string suite;
  std::string mode;
  std::string sensing;
  std::string sensing_remark;     // what is to be said of geometric sensing, "" = nothing
  std::vector<std::string> plan;  // "SCENARIO seed N" of all runs, whoever does them
  std::vector<RunReport> runs;
  std::vector<DetectorCondition> detector;  // in the first part only
};

/// The runs of a list that a shard does.
template <typename Run>
std::vector<Run> runs_of_shard(const std::vector<Run>& all, const Shard& shard) {
  std::vector<Run> runs;
  for (auto i = static_cast<std::size_t>(shard.index - 1); i < all.size(); i += static_cast<std::size_t>(shard.count)) {
    runs.push_back(all[i]);
  }
  return runs;
}

/// CBOR (RFC 8949): numbers come back bit by bit, infinite ones too.
std::string to_cbor(const ReportPart& part);
/// Throws std::runtime_error, which names the file as `name`, for what is no such part.
ReportPart part_of_cbor(const std::string& cbor, const std::string& name);

/// All runs in the order of one evaluation that was never cut. The parts come with their files' names. Throws
/// std::runtime_error for parts of different evaluations, and where one is missing or there twice.
ReportPart joined(const std::vector<std::pair<std::string, ReportPart>>& parts);

/// The report of the whole as `--json` writes it.
std::string to_json(const ReportPart& part);

}  // namespace luminav
