#include "tests/evaluation/detector_score/detector_suite.hpp"

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <thread>
#include <utility>

#include "tests/evaluation/detector_score/detector_score.hpp"
#include "tests/evaluation/detector_score/luminaire_scenes.hpp"
#include "tests/evaluation/detector_score/tolerance_suite.hpp"

namespace luminav {
namespace {

/// Lamps of one and of two tubes, in rows and alone.
constexpr std::array kBuildings = {"laboratory", "office"};

DetectorCondition condition_of(const std::string& name, const score::DetectorScore& score) {
  return {name,
          score.frames,
          score.precision(),
          score.visible == 0 ? 1.0 : score.recall(),
          score.visible == 0 ? 1.0 : static_cast<double>(score.plain) / score.visible,
          score.plain_recall(),
          score.frames == 0 ? 0.0 : 100.0 * score.wrong / score.frames,
          score.centre_rms_px(),
          score.heading_rms_deg(),
          score.milliseconds()};
}

/// Calls `measure` with 0 .. count - 1, on several threads.
void measure_each(std::size_t count, int threads, const std::function<void(std::size_t)>& measure) {
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      measure(i);
    }
  };
  std::vector<std::thread> workers;
  for (int i = 1; i < threads; ++i) {
    workers.emplace_back(work);
  }
  work();
  for (std::thread& worker : workers) {
    worker.join();
  }
}

score::DetectorScoreOptions options_for(const std::string& mode, int worlds, int frames) {
  score::DetectorScoreOptions options;
  options.mode = mode == "paper" ? DetectorMode::kPaper : DetectorMode::kModern;
  options.first_seed = 1000;
  options.worlds = worlds;
  options.frames = frames;
  return options;
}

std::filesystem::path scenario_of(const char* building) {
  return std::filesystem::path(LUMINAV_SOURCE_DIR) / fmt::format("launch/scenarios/{}.toml", building);
}

}  // namespace

std::vector<DetectorCondition> measure_detector(const std::string& mode, int threads) {
  // Some fixtures in a hundred hold half of the error squared, those whose ends lie in dark joints of the ceiling:
  // their places are drawn once per world.
  const score::DetectorScoreOptions options = options_for(mode, 5, 24);
  const std::vector<score::Condition>& matrix = score::lighting_matrix();
  std::vector<score::DetectorScore> scores(matrix.size());
  fmt::print(stderr, "detector: {}\n", score::score_table_header());
  measure_each(matrix.size(), threads, [&](std::size_t i) {
    for (const char* building : kBuildings) {
      score::DetectorScoreOptions there = options;
      there.scenario = scenario_of(building);
      scores[i].add(score::score_detector(there, matrix[i]));
    }
    fmt::print(stderr, "detector: {}\n", score::score_table_row(matrix[i].name, scores[i]));
  });
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

std::vector<DetectorCondition> measure_luminaires(const std::string& mode, int threads) {
  score::DetectorScoreOptions options = options_for(mode, 4, 15);
  options.scenario = scenario_of("laboratory");
  const std::vector<score::LuminaireScene>& scenes = score::luminaire_scenes();
  std::vector<score::DetectorScore> scores(scenes.size());
  measure_each(scenes.size(), threads, [&](std::size_t i) {
    scores[i] = score::score_scene(options, scenes[i]);
    fmt::print(stderr, "luminaires: [{}/{}] {}, {}\n", i + 1, scenes.size(), scenes[i].name, scenes[i].state);
  });
  std::vector<DetectorCondition> conditions;
  score::DetectorScore all;
  std::map<std::string, score::DetectorScore> by_state;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    conditions.push_back(condition_of(scenes[i].name + ", " + scenes[i].state, scores[i]));
    by_state[scenes[i].state].add(scores[i]);
    if (!scenes[i].is_clutter) {
      all.add(scores[i]);
    }
  }
  for (const auto& [state, score] : by_state) {
    conditions.push_back(condition_of("all, " + state, score));
  }
  conditions.push_back(condition_of("all luminaires", all));
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
    fmt::print(
        stderr,
        "tolerance: {:<28} precision {:.3f}, recall {:.3f} ({:+.3f}), of whole ones {:.3f}, of the {:.0f} % that a "
        "person sees {:.3f}\n",
        score::mistakes()[i].name, sum.precision(), sum.recall(), sum.recall() - conditions.front().recall,
        sum.whole_recall(), 100.0 * conditions.back().plain, sum.plain_recall());
  }
  return conditions;
}

}  // namespace luminav
