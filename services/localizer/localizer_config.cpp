#include "services/localizer/localizer_config.hpp"

#include <malloc.h>

#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/localizer/robot_errors.hpp"

namespace luminav {
namespace {

void read_hypotheses(const TomlTable& table, HypothesisParams& params) {
  table.read("gate", params.gate, {1.0, 1000.0});
  table.read("misfit", params.misfit, {-50.0, -0.1});
  table.read("miss_probability", params.miss_probability, {0.001, 0.999});
  table.read("miss_margin", params.miss_margin, {0.0, 2.0});
  table.read("sonar_weight", params.sonar_weight, {0.0, 1000.0});
  table.read("sonar_surface", params.sonar_surface, {0.05, 10.0});
  table.read("sonar_looks", params.sonar_looks, {1, 1000});
  table.read("sonar_cap", params.sonar_cap, {0.0, 1000.0});
  table.read("prune", params.prune, {1.0, 1000.0});
  table.read("max", params.max, {1, 1e6});
  table.reject_unknown();
}

void read_rules(const TomlTable& table, TrackingRules& rules) {
  table.read("first_margin", rules.first_margin, {0.0, 100.0});
  table.read("enter_margin", rules.enter_margin, {0.0, 100.0});
  table.read("min_without_sonar", rules.min_without_sonar, {-100.0, 100.0});
  table.read("leave_margin", rules.leave_margin, {0.0, 100.0});
  table.read("enter_fixtures", rules.enter_fixtures, {1, 16});
  table.read("enter_position_sigma", rules.enter_position_sigma, {0.01, 5.0});
  table.read("leave_position_sigma", rules.leave_position_sigma, {0.01, 5.0});
  table.read("leave_heading_sigma", rules.leave_heading_sigma, {0.01, 3.0});
  table.read("doubt", rules.doubt, {0.1, 1000.0});
  table.read("pause_frames", rules.pause_frames, {1, 1000});
  table.read("displacement", rules.displacement, {0.0, 10.0});
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
  params.outlier = table.number("outlier", params.outlier, {1e-4, 1.0});
  params.distance_gain = table.number("distance_gain", params.distance_gain, {0.01, 1000.0});
  params.angle_gain = table.number("angle_gain", params.angle_gain, {0.0, 1000.0});
  params.weight_jitter = table.number("weight_jitter", params.weight_jitter, kFraction);
  params.unknown_free = table.number("unknown_free", params.unknown_free, kFraction);
  params.min_free = table.number("min_free", params.min_free, kFraction);
  params.noise.turn_by_turn = table.number("turn_by_turn", params.noise.turn_by_turn, {0.0, 10.0});
  params.noise.turn_by_distance = table.number("turn_by_distance", params.noise.turn_by_distance, {0.0, 10.0});
  params.noise.distance_by_distance =
      table.number("distance_by_distance", params.noise.distance_by_distance, {0.0, 10.0});
  params.noise.distance_by_turn = table.number("distance_by_turn", params.noise.distance_by_turn, {0.0, 10.0});
  params.redraws = table.count("redraws", params.redraws, {0.0, 100.0});
  params.drawn_weight = table.number("drawn_weight", params.drawn_weight, {0.0, 100.0});
  params.facing_share = table.number("facing_share", params.facing_share, kFraction);
  params.copied_share = table.number("copied_share", params.copied_share, {0.0, 0.45});
  params.random_share = table.number("random_share", params.random_share, {0.0, 0.5});
  table.reject_unknown();
}

void read_clusters(const TomlTable& table, ClusterParams& params) {
  params.radius_factor = table.number("radius_factor", params.radius_factor, {0.01, 1.0});
  params.heading_gate = table.number("heading_gate", params.heading_gate, {0.01, 3.2});
  params.starting_share = table.number("starting_share", params.starting_share, {0.001, 1.0});
  params.max = table.count("max", params.max, {1.0, 1000.0});
  table.reject_unknown();
}

void read_handover(const TomlTable& table, HandoverParams& params) {
  params.step = table.number("step", params.step, {0.0, 10.0});
  params.turn = table.number("turn", params.turn, {0.0, 10.0});
  params.share = table.number("share", params.share, kFraction);
  params.spread = table.number("spread", params.spread, {0.001, 100.0});
  params.heading_spread = table.number("heading_spread", params.heading_spread, {0.001, 4.0});
  params.gate = table.number("gate", params.gate, {0.1, 1000.0});
  params.view_margin = table.number("view_margin", params.view_margin, {0.0, 2.0});
  params.images_per_view = table.number("images_per_view", params.images_per_view, {1.0, 1000.0});
  params.blind_distance = table.number("blind_distance", params.blind_distance, {0.1, 10000.0});
  params.gathered_share = table.number("gathered_share", params.gathered_share, kFraction);
  table.reject_unknown();
}

void read_confidence(const TomlTable& table, ConfidenceParams& params) {
  constexpr Range kProbability{0.001, 0.999};
  params.fit_if_right = table.number("fit_if_right", params.fit_if_right, kProbability);
  params.fit_if_wrong = table.number("fit_if_wrong", params.fit_if_wrong, kProbability);
  params.seen_if_right = table.number("seen_if_right", params.seen_if_right, kProbability);
  params.seen_if_wrong = table.number("seen_if_wrong", params.seen_if_wrong, kProbability);
  params.wall_if_right = table.number("wall_if_right", params.wall_if_right, kProbability);
  params.wall_if_wrong = table.number("wall_if_wrong", params.wall_if_wrong, kProbability);
  params.independence = table.number("independence", params.independence, {0.01, 1.0});
  params.sure = table.number("sure", params.sure, {0.0, 100.0});
  params.refuted = table.number("refuted", params.refuted, {-100.0, 0.0});
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
  read_hypotheses(table.table("hypotheses"), config.modern.hypotheses);
  read_rules(table.table("rules"), config.modern.rules);
  read_particles(table.table("particles"), config.paper.particles);
  read_clusters(table.table("clusters"), config.paper.clusters);
  read_handover(table.table("handover"), config.paper.handover);
  read_confidence(table.table("confidence"), config.paper.confidence);
  table.reject_unknown();
  return config;
}

}  // namespace luminav
