#include "tests/evaluation/detector_score/detector_suite.hpp"

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <thread>
#include <utility>

#include "tests/evaluation/detector_score/detector_score.hpp"
#include "tests/evaluation/detector_score/tolerance_suite.hpp"

namespace luminav {
namespace {

/// Lamps of one and of two tubes, in rows and alone.
constexpr std::array kBuildings = {"laboratory", "office"};

DetectorCondition condition_of(const std::string& name, const score::DetectorScore& score) {
  return {name,
          score.frames,
          score.precision(),
          score.recall(),
          score.centre_rms_px(),
          score.heading_rms_deg(),
          score.milliseconds()};
}

}  // namespace

std::vector<DetectorCondition> measure_detector(const std::string& mode, int threads) {
  score::DetectorScoreOptions options;
  options.mode = mode == "paper" ? DetectorMode::kPaper : DetectorMode::kModern;
  options.first_seed = 1000;
  // Some fixtures in a hundred hold half of the error squared, those whose ends lie in dark joints of the ceiling:
  // their places are drawn once per world.
  options.worlds = 5;
  options.frames = 24;
  const auto scenarios = std::filesystem::path(LUMINAV_SOURCE_DIR) / "launch/scenarios";
  const std::vector<score::Condition>& matrix = score::lighting_matrix();
  std::vector<score::DetectorScore> scores(matrix.size());
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < matrix.size(); i = next++) {
      for (const char* building : kBuildings) {
        score::DetectorScoreOptions there = options;
        there.scenario = scenarios / fmt::format("{}.toml", building);
        scores[i].add(score::score_detector(there, matrix[i]));
      }
      fmt::print(stderr, "detector: {}\n", score::score_table_row(matrix[i].name, scores[i]));
    }
  };
  fmt::print(stderr, "detector: {}\n", score::score_table_header());
  std::vector<std::thread> workers;
  for (int i = 1; i < threads; ++i) {
    workers.emplace_back(work);
  }
  work();
  for (std::thread& worker : workers) {
    worker.join();
  }
  std::vector<DetectorCondition> conditions;
  score::DetectorScore lit;
  score::DetectorScore all;
  for (std::size_t i = 0; i < matrix.size(); ++i) {
    conditions.push_back(condition_of(matrix[i].name, scores[i]));
    all.add(scores[i]);
    if (matrix[i].lamps_on) {
      lit.add(scores[i]);
    }
  }
  for (const auto& [name, score] : {std::pair{"with lamps on", lit}, std::pair{"matrix", all}}) {
    fmt::print(stderr, "detector: {}\n", score::score_table_row(name, score));
    conditions.push_back(condition_of(name, score));
  }
  return conditions;
}

std::vector<DetectorCondition> measure_tolerance(int threads) {
  std::array<std::vector<score::DetectorScore>, kBuildings.size()> parts;
  const auto work = [&](std::size_t i) {
    score::DetectorScoreOptions options;
    options.scenario =
        std::filesystem::path(LUMINAV_SOURCE_DIR) / fmt::format("launch/scenarios/{}.toml", kBuildings[i]);
    options.first_seed = 1000;
    options.worlds = 5;
    options.frames = 24;
    parts[i] = score::score_mistakes(options);
  };
  std::vector<std::thread> workers;
  for (std::size_t i = 0; i < kBuildings.size(); ++i) {
    if (threads > 1) {
      workers.emplace_back(work, i);
    } else {
      work(i);
    }
  }
  for (std::thread& worker : workers) {
    worker.join();
  }
  std::vector<DetectorCondition> conditions;
  for (std::size_t i = 0; i < score::mistakes().size(); ++i) {
    score::DetectorScore sum;
    for (const std::vector<score::DetectorScore>& part : parts) {
      sum.add(part[i]);
    }
    conditions.push_back(condition_of(score::mistakes()[i].name, sum));
    fmt::print(stderr, "tolerance: {:<28} precision {:.3f}, recall {:.3f} ({:+.3f}), of whole ones {:.3f}\n",
               score::mistakes()[i].name, sum.precision(), sum.recall(), sum.recall() - conditions.front().recall,
               sum.whole_recall());
  }
  return conditions;
}

}  // namespace luminav
