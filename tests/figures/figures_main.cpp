// Draws the paper's figures from runs of this system.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <luminav/camera_image_t.hpp>
#include <luminav/hypotheses_t.hpp>
#include <optional>

#include "drivers/simulator/world/scenario.hpp"
#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/command_line.hpp"
#include "services/launcher/pmd_file.hpp"
#include "services/planner/path/route_planner.hpp"
#include "services/surveyor/building_drawing.hpp"
#include "tests/evaluation/judge/map_canvas.hpp"
#include "tests/evaluation/judge/run_judge.hpp"
#include "tests/evaluation/judge/run_picture.hpp"
#include "tests/evaluation/runs/mission.hpp"
#include "tests/evaluation/runs/whole_robot.hpp"
#include "tests/figures/detection_picture.hpp"
#include "tests/figures/process_graph.hpp"

namespace luminav {
namespace {

namespace fs = std::filesystem;

const fs::path kSource = LUMINAV_SOURCE_DIR;
const cv::Scalar kParticle(60, 150, 30);
const cv::Scalar kTruth(40, 40, 220);
const cv::Scalar kPath(40, 40, 220);
const cv::Scalar kFixture(60, 190, 250);

void say(const fs::path& file) {
  fmt::print("{}\n", file.string());
}

/// Keeps the newest picture of the ceiling and the newest cloud of particles of a run.
class Onlooker {
 public:
  explicit Onlooker(lcm::LCM& lcm) : subscriber_(lcm) {
    subscriber_.on(channels::kCameraImage, &Onlooker::on_image, this);
    subscriber_.on(channels::kHypotheses, &Onlooker::on_hypotheses, this);
  }
  std::optional<camera_image_t> image;
  std::optional<hypotheses_t> hypotheses;

 private:
  void on_image(const camera_image_t& newest) { image = newest; }
  void on_hypotheses(const hypotheses_t& newest) { hypotheses = newest; }
  Subscriber subscriber_;
};

/// A run in simulated time that a figure looks into every 0.1 s; ends when `look` returns false or the mission is over.
class FigureRun {
 public:
  FigureRun(const fs::path& scenario_file, const std::string& mode)
      : scenario(read_scenario(scenario_file)),
        robot(scenario, {.mode = mode, .jpeg = false}),
        judge(robot.lcm(), scenario, robot.world()),
        mission(robot.lcm(), scenario),
        onlooker(robot.lcm()) {}

  void run(const std::function<bool()>& look) {
    for (int step = 0; judge.elapsed() < scenario.duration && !mission.is_finished(); ++step) {
      robot.step();
      if (step % 10 == 0 && !look()) {
        return;
      }
    }
  }

  Scenario scenario;
  WholeRobot robot;
  RunJudge judge;
  Mission mission;
  Onlooker onlooker;
};

void draw_workspace(const fs::path& folder) {
  const Building building = read_building(kSource / "launch/buildings/laboratory/building.toml");
  const PriorMap map = read_map(building.map_file);
  draw_building_png(folder / "figure-1-workspace.png", building, &map, {});
  say(folder / "figure-1-workspace.png");
}

/// The paper's chain on the frame of a drive in which it finds most.
void draw_detection(const fs::path& folder) {
  FigureRun run(kSource / "tests/replay/scenarios/loop.toml", "paper");
  DetectionPicture best(kSource / "launch/robots/p3dx.toml", run.scenario.building_file);
  run.run([&] {
    if (run.onlooker.image) {
      best.look_at(*run.onlooker.image);
    }
    return run.judge.elapsed() < 30.0;
  });
  best.write(folder / "figure-3-detection.jpg");
  say(folder / "figure-3-detection.jpg");
}

/// Fixtures, where the robot truly is, and arrows for what it holds possible.
MapCanvas canvas_of(const FigureRun& run) {
  MapCanvas canvas(run.robot.world().walls);
  for (const Fixture& fixture : run.robot.believed_building().fixtures) {
    canvas.rectangle(fixture.world_from_fixture, fixture.length, fixture.width, kFixture);
  }
  const Pose2 truth{run.judge.truth()->x, run.judge.truth()->y, run.judge.truth()->theta};
  canvas.dot(truth.position(), 10, kTruth, false);
  canvas.arrow(truth, 0.8, kTruth);
  canvas.text(truth.position(), "robot", kTruth);
  return canvas;
}

/// Runs until the first answer after `seconds` and draws it: particles of the paper's filter, or modern hypotheses.
void draw_beliefs(const std::string& mode, double seconds, const fs::path& file) {
  FigureRun run(kSource / "tests/replay/scenarios/loop.toml", mode);
  const bool draws_particles = mode == "paper";
  bool is_drawn = false;
  run.run([&] {
    if (run.judge.elapsed() < seconds || !run.onlooker.hypotheses || !run.judge.truth()) {
      return true;
    }
    const hypotheses_t& cloud = *run.onlooker.hypotheses;
    MapCanvas canvas = canvas_of(run);
    for (int i = 0; draws_particles && i < cloud.particle_count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      canvas.arrow({cloud.particle_x[at], cloud.particle_y[at], cloud.particle_theta[at]}, 0.25, kParticle);
    }
    for (int i = 0; !draws_particles && i < cloud.count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const Pose2 pose{cloud.x[at], cloud.y[at], cloud.theta[at]};
      canvas.arrow(pose, 0.6, kParticle);
      canvas.dot(pose.position(), 2 + static_cast<int>(20.0 * std::sqrt(cloud.weight[at])), kParticle, false);
    }
    canvas.write(file.string());
    say(file);
    is_drawn = true;
    return false;
  });
  if (!is_drawn) {
    throw std::runtime_error("figure 4: the localizer published no " +
                             std::string(draws_particles ? "particles" : "hypotheses"));
  }
}

/// What the sonars alone say: free white, occupied dark, never measured grey.
PriorMap evidence_map(const OccupancyGrid& grid) {
  PriorMap map;
  map.geometry = grid.geometry;
  map.cells.reserve(grid.evidence.size());
  for (const std::int8_t evidence : grid.evidence) {
    map.cells.push_back(evidence >= 17 ? Prior::kOccupied : evidence < 0 ? Prior::kFree : Prior::kUnknown);
  }
  return map;
}

void draw_loop_and_grid(const fs::path& folder) {
  FigureRun run(kSource / "tests/figures/loop.toml", "paper");
  run.run([] { return true; });
  draw_run((folder / "figure-5-loop-closure.png").string(), run.robot.world(), run.robot.believed_building(),
           run.judge.trail(), run.mission.final_results(), nullptr);
  say(folder / "figure-5-loop-closure.png");
  if (!run.judge.grid()) {
    throw std::runtime_error("figure 6: no grid was published");
  }
  MapCanvas(evidence_map(*run.judge.grid())).write((folder / "figure-6-occupancy-grid.png").string());
  say(folder / "figure-6-occupancy-grid.png");
}

/// A way through a building; `shows_space`: with the configuration space (light red) and the walls it was grown from.
void draw_path(const fs::path& building_file, const std::string& from, const std::string& to, bool shows_space,
               const fs::path& file) {
  const Building building = read_building(building_file);
  const PriorMap map = resample(read_map(building.map_file), 0.1);
  const auto place = [&](const std::string& name) {
    const auto found = std::find_if(building.places.begin(), building.places.end(),
                                    [&](const Place& candidate) { return candidate.name == name; });
    if (found == building.places.end()) {
      throw std::runtime_error(building_file.string() + ": has no place " + name);
    }
    return found->pose.position();
  };
  OccupancyGrid grid(map.geometry);
  grid.prior = map.cells;
  RoutePlannerParams params;
  params.mode = PlannerMode::kPaper;
  RoutePlanner planner(params);
  planner.set_grid(grid, {});
  const Route route = planner.plan({place(from), place(to), 0.2});
  if (route.points.empty()) {
    throw std::runtime_error(fmt::format("no way from {} to {}", from, to));
  }
  MapCanvas canvas(map);
  if (shows_space) {
    for (int row = 0; row < map.geometry.rows; ++row) {
      for (int column = 0; column < map.geometry.columns; ++column) {
        const Cell cell{column, row};
        if (planner.space().is_blocked(cell) && map.cells[map.geometry.index(cell)] == Prior::kFree) {
          const Eigen::Vector2d centre = map.geometry.centre_of(cell);
          canvas.rectangle({centre.x(), centre.y(), 0.0}, map.geometry.resolution, map.geometry.resolution,
                           cv::Scalar(190, 190, 250));
        }
      }
    }
  }
  for (std::size_t i = 1; i < route.points.size(); ++i) {
    const Eigen::Vector2d& a = route.points[i - 1];
    const Eigen::Vector2d& b = route.points[i];
    canvas.line({a.x(), a.y(), 0.0}, {b.x(), b.y(), 0.0}, kPath, 3);
  }
  canvas.text(place(from), from, kParticle);
  canvas.dot(place(from), 7, kParticle);
  canvas.text(place(to), to, {200, 80, 20});
  canvas.dot(place(to), 7, {200, 80, 20});
  canvas.write(file.string());
  say(file);
}

void draw_processes(const fs::path& folder) {
  std::vector<std::string> processes;
  for (const launcher::Command& command : launcher::read_pmd(kSource / "launch/demo.pmd").commands) {
    processes.push_back(command.name);
  }
  const fs::path file = folder / "figure-8-processes.svg";
  std::ofstream out(file);
  out << draw_process_graph(processes, read_channel_table(kSource / "lcmtypes/README.md"));
  out.close();
  if (!out) {
    throw std::runtime_error(file.string() + ": cannot be written");
  }
  say(file);
}

int draw_figures(const fs::path& folder, std::int64_t only) {
  if (only < 0 || only == 2 || only > 9) {
    throw ConfigurationError(fmt::format("--only {}: must be 1 or 3 to 9", only));
  }
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw std::runtime_error(folder.string() + ": cannot be made: " + error.message());
  }
  const auto is_wanted = [&](std::int64_t figure) { return only == 0 || only == figure; };
  if (is_wanted(1)) {
    draw_workspace(folder);
  }
  if (is_wanted(3)) {
    draw_detection(folder);
  }
  if (is_wanted(4)) {
    // one fixture was seen and many poses still explain it; the paper's detector waits until all of it is in view
    draw_beliefs("paper", 12.0, folder / "figure-4-particles.png");
    draw_beliefs("modern", 7.0, folder / "figure-4-hypotheses.png");
  }
  if (is_wanted(5) || is_wanted(6)) {
    draw_loop_and_grid(folder);
  }
  if (is_wanted(7)) {
    draw_path(kSource / "launch/buildings/laboratory/building.toml", "workbench", "office-3", true,
              folder / "figure-7-configuration-space.png");
  }
  if (is_wanted(8)) {
    draw_processes(folder);
  }
  if (is_wanted(9)) {
    const fs::path office = kSource / "launch/buildings/office/building.toml";
    const Building building = read_building(office);
    draw_path(office, building.places.front().name, building.places.back().name, false,
              folder / "figure-9-whole-path.png");
  }
  return 0;
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  using namespace luminav;
  std::string folder = "figures";
  std::int64_t only = 0;
  CommandLine line("figures", "Draws the paper's figures 1 and 3 to 9 from our own runs.");
  line.text("--out", folder, "folder for the pictures").integer("--only", only, "this figure alone; 0 = all");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  return run_guarded("figures", [&] { return draw_figures(folder, only); });
}
