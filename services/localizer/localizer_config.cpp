#include "services/localizer/localizer_config.hpp"

#include <malloc.h>

#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/localizer/robot_errors.hpp"

namespace luminav {
namespace {

void read_rules(const TomlTable& table, TrackingRules& rules) {
  table.read("first_margin", rules.first_margin, {0.0, 100.0});
  table.read("enter_margin", rules.enter_margin, {0.0, 100.0});
  table.read("min_without_sonar", rules.min_without_sonar, {-100.0, 100.0});
  table.read("leave_margin", rules.leave_margin, {0.0, 100.0});
  table.read("enter_fixtures", rules.enter_fixtures, {1, 16});
  table.read("enter_position_sigma", rules.enter_position_sigma, {0.01, 5.0});
  table.read("enter_heading_sigma", rules.enter_heading_sigma, {0.01, 3.0});
  table.read("leave_position_sigma", rules.leave_position_sigma, {0.01, 5.0});
  table.read("leave_heading_sigma", rules.leave_heading_sigma, {0.01, 3.0});
  table.read("doubt", rules.doubt, {0.1, 1000.0});
  table.reject_unknown();
}

void read_particles(const TomlTable& table, ParticleParams& params) {
  params.count = table.count("count", params.count, {0.0, 1e6});
  params.density = table.number("density", params.density, {0.1, 1e5});
  params.scoring = table.choice("scoring", "equation_one", {"equation_one", "gaussian"}) == "gaussian"
                       ? ParticleScoring::kGaussian
                       : ParticleScoring::kEquationOne;
  params.resampling = table.choice("resampling", "churn", {"churn", "systematic"}) == "systematic"
                          ? ParticleResampling::kSystematic
                          : ParticleResampling::kReplaceWorst;
  params.position_sigma = table.number("position_sigma", params.position_sigma, {0.001, 10.0});
  params.heading_sigma = table.number("heading_sigma", params.heading_sigma, {0.001, 10.0});
  params.distance_gain = table.number("distance_gain", params.distance_gain, {0.01, 1000.0});
  params.angle_gain = table.number("angle_gain", params.angle_gain, {0.0, 1000.0});
  table.reject_unknown();
}

}  // namespace

std::unique_ptr<Localizer> make_localizer(const LocalizerConfig& config) {
  if (config.mode == LocalizerMode::kPaper) {
    return std::make_unique<PaperLocalizer>(config.building, config.walls, config.robot, config.errors, config.paper,
                                            config.seed);
  }
  return std::make_unique<ModernLocalizer>(config.building, config.walls, config.robot, config.errors, config.modern);
}

LocalizerConfig read_localizer_config(const std::filesystem::path& robot_file,
                                      const std::filesystem::path& building_file) {
  LocalizerConfig config;
  const TomlTable root = TomlTable::load(robot_file);
  config.robot = read_robot(root);
  config.building = read_building(building_file);
  malloc_trim(0);  // the text of 4,000 fixtures took 16 MB, which nobody needs again
  if (!config.building.map_file.empty()) {
    config.walls = read_map(config.building.map_file);
  }
  const TomlTable table = root.table("localizer");
  config.mode = table.choice("mode", config.robot.mode, {"paper", "modern"}) == "paper" ? LocalizerMode::kPaper
                                                                                        : LocalizerMode::kModern;
  config.seed = static_cast<std::uint64_t>(table.integer("seed", 1, {0.0, 1e15}));
  const RobotErrors errors = read_robot_errors(table);
  config.wheels = errors.wheels;
  config.errors = errors.errors;
  read_rules(table.table("rules"), config.modern.rules);
  read_particles(table.table("particles"), config.paper.particles);
  table.reject_unknown();
  return config;
}

}  // namespace luminav
