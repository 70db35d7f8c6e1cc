// Drives with the desk behind a bad link: driver, camera and detector on one side, the rest on the other. Judged by the
// simulator's truth: no contact, all goals reached, at least half as fast as without loss.
#include <fmt/format.h>

#include <cstdlib>
#include <vector>

#include "services/common/process/channels.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/interrupts.hpp"
#include "services/launcher/sheriff/session.hpp"
#include "tests/evaluation/runs/mission.hpp"
#include "tests/system/faults/fleet.hpp"
#include "tests/system/faults/hosts/lossy_link.hpp"
#include "tests/system/faults/robot_watch.hpp"
#include "tests/system/faults/truth_watch.hpp"

namespace luminav {
namespace {

constexpr int kRobotPort = 7667;
constexpr int kDeskPort = 7669;

struct Condition {
  std::string name;
  LossyLinkParams link;
};

struct Outcome {
  bool arrived = false;
  int contacts = 0;
  double speed = 0.0;  // [m/s] way by time from the first goal's request to the last one's end
};

Outcome drive(const Scenario& scenario, const Condition& condition, const std::filesystem::path& folder) {
  const auto url = [](int port) { return fmt::format("udpm://239.255.76.67:{}?ttl=0", port); };
  // The camera's images do not cross the link, and the truth is not part of the robot.
  LossyLink link(kRobotPort, kDeskPort, condition.link, {channels::kSimTruth, channels::kCameraImage});
  Fleet fleet({.scenario = scenario,
               .folder = folder,
               .lcm_url = url(kRobotPort),
               .placed = {{"localizer", "desk"}, {"mapper", "desk"}, {"planner", "desk"}, {"controller", "desk"}},
               .preload = {}});
  fleet.add_host("robot", nullptr, {});
  fleet.add_host("desk", nullptr, {{"LUMINAV_LCM_URL", url(kDeskPort)}});
  TruthWatch truth(fleet.lcm());
  RobotWatch robot(fleet.lcm(), fleet.clock());
  Outcome outcome;
  if (!fleet.run_script("go")) {
    fmt::print("{}: does not start: {}\n", condition.name, fleet.failure());
    return outcome;
  }
  Mission mission(fleet.lcm(), scenario);
  fleet.pump_until([&] { return mission.request_poses().size() == 1; }, 10.0);
  const double driven_before = truth.driven();
  const double begun = truth.elapsed();
  const bool finished = fleet.pump_until([&] { return mission.is_finished(); }, scenario.duration);
  outcome.arrived = finished && mission.failure().empty();
  outcome.contacts = truth.contacts() + truth.hard_contacts();
  outcome.speed = (truth.driven() - driven_before) / std::max(1.0, truth.elapsed() - begun);
  fmt::print("{:<44} {:>6} messages, {:>5} lost; {:>5.1f} m in {:>4.0f} s = {:.2f} m/s, {} contacts, {}\n",
             condition.name, link.forwarded() + link.lost(), link.lost(), truth.driven() - driven_before,
             truth.elapsed() - begun, outcome.speed, outcome.contacts,
             outcome.arrived ? "all goals reached" : "FAILED: " + mission.failure() + "; " + robot.sentence());
  std::fflush(stdout);
  fleet.run_script("stop", 15.0);
  return outcome;
}

int run(int argc, char** argv) {
  std::string file = LUMINAV_SOURCE_DIR "/tests/system/faults/lossy_link.toml";
  bool quick = false;
  CommandLine line("lossy_drive", "Drives with the desk behind links that lose, delay, double and reorder messages.");
  line.text("--scenario", file, "scenario file").flag("--quick", quick, "only the worst link and none at all");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  catch_interrupts();
  const Scenario scenario = read_scenario(file);
  std::vector<Condition> conditions{
      {"without loss", {}},
      {"1 % lost", {.loss = 0.01}},
      {"10 % lost", {.loss = 0.1}},
      {"30 % lost", {.loss = 0.3}},
      {"30 % lost, 10 % doubled, 5 to 45 ms late", {.loss = 0.3, .duplicate = 0.1, .delay = 0.005, .jitter = 0.04}}};
  if (quick) {
    conditions = {conditions.front(), conditions.back()};
  }
  std::string folder = (std::filesystem::temp_directory_path() / "luminav-lossy-XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) {
    throw std::runtime_error(fmt::format("{}: cannot be made", folder));
  }
  bool good = true;
  double speed_without_loss = 0.0;
  try {
    for (std::size_t i = 0; i < conditions.size(); ++i) {
      const Outcome outcome = drive(scenario, conditions[i], std::filesystem::path(folder) / std::to_string(i));
      speed_without_loss = i == 0 ? outcome.speed : speed_without_loss;
      good = good && outcome.arrived && outcome.contacts == 0 && outcome.speed >= 0.5 * speed_without_loss;
    }
  } catch (const Interrupted&) {
    good = false;
    fmt::print("interrupted\n");
  }
  std::filesystem::remove_all(folder);
  fmt::print("{}\n", good ? "passed" : "FAILED");
  return good ? 0 : 1;
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  return luminav::run_guarded("lossy_drive", [&] { return luminav::run(argc, argv); });
}
