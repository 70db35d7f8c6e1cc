// Drives a synthetic robot through a building many times and reports how well it finds and keeps its pose.
// Not part of the test run: localizer_trials --building launch/buildings/laboratory/building.toml --runs 200

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "services/common/process/command_line.hpp"
#include "services/localizer/localizer_config.hpp"
#include "tests/unit/localizer/trial.hpp"

namespace luminav::testing {
namespace {

double quantile(std::vector<double> values, double share) {
  if (values.empty()) {
    return 0.0;
  }
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

int run(int argc, char** argv) {
  std::string robot = std::string(LUMINAV_SOURCE_DIR) + "/launch/robots/p3dx.toml";
  std::string building = std::string(LUMINAV_SOURCE_DIR) + "/launch/buildings/laboratory/building.toml";
  std::int64_t runs = 20;
  std::int64_t seed = 1;
  std::int64_t carries = 0;
  std::int64_t corridor = 0;
  std::int64_t clutter = 1;
  std::int64_t boxes = 4;
  double duration = 120.0;
  double off = 0.0;
  bool calibrated = false;
  bool trace = false;
  bool paper = false;
  std::string without;
  CommandLine line("localizer_trials",
                   "Drives a synthetic robot many times and reports how well it finds and keeps its pose.");
  line.text("--robot", robot, "robot file").text("--building", building, "building file");
  line.integer("--runs", runs, "drives")
      .integer("--seed", seed, "first seed")
      .integer("--carries", carries, "per drive");
  line.integer("--corridor", corridor, "fixtures of a symmetric corridor to drive in instead")
      .integer("--clutter", clutter, "false fixtures")
      .integer("--boxes", boxes, "things on the floor that the map does not know");
  line.number("--duration", duration, "[s] of a drive").number("--off", off, "share of the fixtures that are off");
  line.flag("--calibrated", calibrated, "constant errors a tenth").flag("--trace", trace, "print changes of state");
  line.flag("--paper", paper, "the paper's localizer");
  line.text("--without", without,
            "letters of errors to leave out: w(heels) c(amera) t(ime) f(ixtures) l (floor) o(dometry noise)");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  LocalizerConfig config = read_localizer_config(robot, building);
  config.mode = paper ? LocalizerMode::kPaper : config.mode;
  if (corridor > 0) {
    const TestBuilding test = symmetric_corridor(static_cast<int>(corridor), 3.0);
    config.building = test.building;
    config.walls = test.walls;
  }
  TrialResult sum;
  std::vector<double> ways;
  std::vector<double> times;
  std::vector<double> resolvable;
  std::vector<double> recovery;
  std::vector<double> positions;
  std::vector<double> headings;
  long localized = 0, correct = 0, at_end = 0, wrong_runs = 0;
  double recovered = 0;
  double seconds = 0.0;
  for (std::int64_t i = seed; i < seed + runs; ++i) {
    SyntheticOptions options;
    options.seed = static_cast<std::uint64_t>(i);
    options.calibrated = calibrated;
    options.off_ratio = off;
    options.clutter = static_cast<int>(clutter);
    options.unknown_boxes = static_cast<int>(boxes);
    const auto has = [&](char letter) { return without.find(letter) == std::string::npos; };
    options.wheel_errors = has('w');
    options.camera_errors = has('c');
    options.time_errors = has('t');
    options.fixture_errors = has('f');
    options.floor_errors = has('l');
    options.odometry_noise = has('o');
    SyntheticWorld world(config.building, config.walls, config.robot, options);
    config.seed = static_cast<std::uint64_t>(i);
    const std::unique_ptr<Localizer> localizer = make_localizer(config);
    TrialPlan plan;
    plan.duration = duration;
    plan.trace = trace;
    for (std::int64_t c = 1; c <= carries; ++c) {
      plan.carries.push_back(duration * static_cast<double>(c) / static_cast<double>(carries + 1));
    }
    const auto begin = std::chrono::steady_clock::now();
    const TrialResult r = run_trial(world, *localizer, plan);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (r.localized) {
      ++localized;
      ways.push_back(r.localized_after);
      times.push_back(r.localized_time);
    }
    if (r.resolvable) {
      resolvable.push_back(r.resolvable_after);
    }
    correct += r.correct_first ? 1 : 0;
    at_end += r.tracking_at_end ? 1 : 0;
    recovered += r.recovered;
    recovery.insert(recovery.end(), r.recovery_way.begin(), r.recovery_way.end());
    positions.insert(positions.end(), r.position_errors.begin(), r.position_errors.end());
    headings.insert(headings.end(), r.heading_errors.begin(), r.heading_errors.end());
    sum.confident_wrong += r.confident_wrong;
    const auto add_times = [](StepTimes& to, const StepTimes& from) {
      to.sum += from.sum;
      to.worst = std::max(to.worst, from.worst);
      to.count += from.count;
    };
    add_times(sum.search_steps, r.search_steps);
    add_times(sum.tracking_steps, r.tracking_steps);
    sum.tracking += r.tracking;
    sum.after_first += r.after_first;
    sum.position_square += r.position_square;
    sum.heading_square += r.heading_square;
    sum.in_view += r.in_view;
    sum.nees += r.nees;
    sum.nees_forward += r.nees_forward;
    sum.nees_left += r.nees_left;
    sum.nees_heading += r.nees_heading;
    if (r.confident_wrong > 0.0 || !r.localized || (r.localized && !r.correct_first) ||
        r.recovered < static_cast<double>(r.localized ? carries : 0)) {
      ++wrong_runs;
      std::printf("seed %ld: localized %d correct %d after %.1f m, confident wrong %.1f s, recovered %.0f of %ld\n",
                  static_cast<long>(i), r.localized, r.correct_first, r.localized_after, r.confident_wrong, r.recovered,
                  static_cast<long>(carries));
    }
  }
  const double in_view = std::max<double>(1.0, static_cast<double>(sum.in_view));
  std::printf("runs %ld  localized %ld  correct %ld  tracking at end %ld  confident wrong %.1f s in all\n",
              static_cast<long>(runs), localized, correct, at_end, sum.confident_wrong);
  std::printf("localized after m: median %.2f p95 %.2f max %.2f; s: median %.1f p95 %.1f\n", quantile(ways, 0.5),
              quantile(ways, 0.95), quantile(ways, 1.0), quantile(times, 0.5), quantile(times, 0.95));
  std::printf("resolvable after m: median %.2f p95 %.2f in %zu runs; localized / resolvable: median %.2f p95 %.2f\n",
              quantile(resolvable, 0.5), quantile(resolvable, 0.95), resolvable.size(),
              quantile(ways, 0.5) / std::max(0.01, quantile(resolvable, 0.5)),
              quantile(ways, 0.95) / std::max(0.01, quantile(resolvable, 0.95)));
  std::printf("tracking ratio %.4f  in view rms %.1f mm %.2f deg  p95 %.1f mm %.2f deg  max %.0f mm  nees/dof %.2f\n",
              sum.tracking / std::max(0.1, sum.after_first), 1e3 * std::sqrt(sum.position_square / in_view),
              degrees(std::sqrt(sum.heading_square / in_view)), 1e3 * quantile(positions, 0.95),
              degrees(quantile(headings, 0.95)), 1e3 * quantile(positions, 1.0),
              sum.nees / std::max<double>(1.0, static_cast<double>(positions.size())));
  const double samples = std::max<double>(1.0, static_cast<double>(positions.size()));
  std::printf("squared error / variance: forward %.2f left %.2f heading %.2f\n", sum.nees_forward / samples,
              sum.nees_left / samples, sum.nees_heading / samples);
  if (carries > 0) {
    std::printf("carries recovered %.0f of %ld, after m: median %.2f p95 %.2f\n", recovered,
                static_cast<long>(carries * localized), quantile(recovery, 0.5), quantile(recovery, 0.95));
  }
  const double search = 1e6 * sum.search_steps.sum / std::max(1.0, static_cast<double>(sum.search_steps.count));
  const double follow = 1e6 * sum.tracking_steps.sum / std::max(1.0, static_cast<double>(sum.tracking_steps.count));
  std::printf("step us: %s %.1f (worst %.0f)  Kalman filter %.1f (worst %.0f)  ratio %.1f\n",
              paper ? "particle filter" : "hypotheses", search, 1e6 * sum.search_steps.worst, follow,
              1e6 * sum.tracking_steps.worst, search / std::max(1e-3, follow));
  std::printf("%.2f s of computing for %.0f s of driving\n", seconds, duration * static_cast<double>(runs));
  return wrong_runs > 0 ? 1 : 0;
}

}  // namespace
}  // namespace luminav::testing

int main(int argc, char** argv) {
  return luminav::run_guarded("localizer_trials", [&] { return luminav::testing::run(argc, argv); });
}
