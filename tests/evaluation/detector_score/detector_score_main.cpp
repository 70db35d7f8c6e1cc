// The detector against rendered truth, as a table: detector_score --help.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "services/common/process/command_line.hpp"
#include "services/detector/tool/debug_picture.hpp"
#include "tests/evaluation/detector_score/detector_score.hpp"
#include "tests/evaluation/detector_score/luminaire_scenes.hpp"

namespace luminav::score {
namespace {

/// Pictures and words for each frame that something is to be said against.
FrameListener dump_to(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  return [folder](const ScoredFrame& frame) {
    if (frame.complaints.empty()) {
      return;
    }
    std::string name = frame.name;
    std::replace(name.begin(), name.end(), ' ', '_');
    cv::imwrite((folder / (name + ".png")).string(),
                draw_debug_picture(frame.image->view(), frame.trace, frame.detections));
    for (const std::string& complaint : frame.complaints) {
      std::printf("  %s: %s\n", name.c_str(), complaint.c_str());
    }
    for (std::size_t i = 0; i < frame.trace.verdicts.size(); ++i) {
      const auto& corners = frame.trace.rectangles[i];
      const Eigen::Vector2d centre = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
      std::printf("      tried %.0f x %.0f px at %.0f %.0f: %s\n", (corners[0] - corners[1]).norm(),
                  (corners[1] - corners[2]).norm(), centre.x(), centre.y(), frame.trace.verdicts[i].c_str());
    }
  };
}

/// One frame of each condition, the first in which something was found.
FrameListener keep_first(ContactSheet& sheet, const std::string& condition) {
  return [&sheet, condition, kept = false](const ScoredFrame& frame) mutable {
    if (!kept && !frame.detections.empty()) {
      sheet.add(draw_debug_picture(frame.image->view(), frame.trace, frame.detections), condition);
      kept = true;
    }
  };
}

int draw_conditions(const DetectorScoreOptions& options, const std::string& sheet_file) {
  ContactSheet sheet;
  DetectorScoreOptions few = options;
  few.worlds = 1;
  for (const Condition& condition : lighting_matrix()) {
    score_detector(few, condition, keep_first(sheet, condition.name));
  }
  if (!cv::imwrite(sheet_file, sheet.draw(), {cv::IMWRITE_JPEG_QUALITY, 75})) {
    throw std::runtime_error(sheet_file + ": cannot be written");
  }
  return 0;
}

std::string title_of(const LuminaireScene& scene) {
  return scene.name + ", " + scene.state;
}

/// One picture of each kind of luminaire in each state and of each thing that is none.
int draw_scenes(const DetectorScoreOptions& options, const std::string& sheet_file) {
  ContactSheet sheet;
  DetectorScoreOptions one = options;
  one.worlds = 1;
  one.frames = 1;
  for (const LuminaireScene& scene : luminaire_scenes()) {
    score_scene(one, scene, [&](const ScoredFrame& frame) {
      sheet.add(draw_debug_picture(frame.image->view(), {}, frame.detections), title_of(scene));
    });
  }
  if (!cv::imwrite(sheet_file, sheet.draw())) {
    throw std::runtime_error(sheet_file + ": cannot be written");
  }
  return 0;
}

int run_scenes(const DetectorScoreOptions& options, const std::string& only, const std::string& folder) {
  for (const LuminaireScene& scene : luminaire_scenes()) {
    if (only.empty() || title_of(scene).starts_with(only)) {
      const DetectorScore score = score_scene(options, scene, folder.empty() ? FrameListener{} : dump_to(folder));
      std::printf(
          "%-32s %4d frames, precision %.3f, recall %.3f, whole %.3f, false per 100 frames %.1f, wrong state %d\n",
          title_of(scene).c_str(), score.frames, score.precision(), score.recall(), score.whole_recall(),
          100.0 * score.wrong / std::max(1, score.frames), score.wrong_state);
      std::fflush(stdout);
    }
  }
  return 0;
}

int run(const DetectorScoreOptions& options, const std::string& only, const std::string& folder) {
  std::printf("%s\n", score_table_header().c_str());
  DetectorScore all;
  DetectorScore lit;
  for (const Condition& condition : lighting_matrix()) {
    if (!only.empty() && condition.name != only) {
      continue;
    }
    const DetectorScore score = score_detector(options, condition, folder.empty() ? FrameListener{} : dump_to(folder));
    std::printf("%s\n", score_table_row(condition.name, score).c_str());
    std::fflush(stdout);
    all.add(score);
    if (condition.lamps_on) {
      lit.add(score);
    }
  }
  std::printf("%s\n", score_table_row("with lamps on", lit).c_str());
  std::printf("%s\n", score_table_row("matrix", all).c_str());
  return 0;
}

}  // namespace
}  // namespace luminav::score

int main(int argc, char** argv) {
  return luminav::run_guarded("detector_score", [&] {
    luminav::score::DetectorScoreOptions options;
    std::string scenario = LUMINAV_SOURCE_DIR "/launch/scenarios/laboratory.toml";
    std::string mode = "modern";
    std::int64_t seed = 1;
    std::int64_t worlds = 2;
    std::int64_t frames = 40;
    std::string only;
    std::string folder;
    std::string sheet;
    bool raw = false;
    bool luminaires = false;
    luminav::CommandLine command_line("detector_score", "Measures the detector on rendered frames against the truth.");
    command_line.text("--scenario", scenario, "whose building and robot are taken")
        .text("--mode", mode, "paper or modern")
        .integer("--seed", seed, "of the first world; 1000 and above are for measuring only")
        .integer("--worlds", worlds, "how many, each with the next seed")
        .integer("--frames", frames, "per world and condition")
        .text("--only", only, "one condition of the matrix")
        .text("--dump", folder, "folder for the frames that something is to be said against")
        .text("--sheet", sheet, "write a picture of one frame per condition there, and measure nothing")
        .flag("--luminaires", luminaires, "each kind of luminaire and clutter instead of the matrix")
        .flag("--raw", raw, "without JPEG")
        .flag("--believed", options.believed_camera, "with the mounting and ceiling of the files, not the true ones");
    if (const auto status = command_line.parse(argc, argv)) {
      return *status;
    }
    options.scenario = scenario;
    options.mode = mode == "paper" ? luminav::DetectorMode::kPaper : luminav::DetectorMode::kModern;
    options.first_seed = static_cast<std::uint64_t>(seed);
    options.worlds = static_cast<int>(worlds);
    options.frames = static_cast<int>(frames);
    options.jpeg = !raw;
    if (luminaires) {
      return sheet.empty() ? luminav::score::run_scenes(options, only, folder)
                           : luminav::score::draw_scenes(options, sheet);
    }
    return sheet.empty() ? luminav::score::run(options, only, folder) : luminav::score::draw_conditions(options, sheet);
  });
}
