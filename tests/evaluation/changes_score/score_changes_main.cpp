// Compares what the caretaker proposes, visit after visit, with how the building was changed.

#include <algorithm>
#include <lcm/lcm-cpp.hpp>
#include <stdexcept>

#include "services/caretaker/caretaker_node.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/common/process/command_line.hpp"
#include "tests/evaluation/changes_score/change_score.hpp"

namespace luminav {
namespace {

/// Plays a log to the caretaker and looks at its proposals whenever a visit has ended.
void play(const std::string& file, lcm::LCM& lcm, CaretakerNode& node, ChangeScore& score) {
  lcm::LogFile log(file, "r");
  if (!log.good()) {
    throw std::runtime_error(file + ": cannot be read as an LCM log");
  }
  const std::vector<std::string>& channels = node.channels();
  const auto newest = [&] { return std::pair(node.ledger().size(), node.ledger().newest()); };
  auto looked = newest();
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    if (std::find(channels.begin(), channels.end(), event->channel) == channels.end()) {
      continue;
    }
    lcm.publish(event->channel, event->data, static_cast<unsigned>(event->datalen));
    lcm.handleTimeout(0);
    if (newest() != looked) {
      looked = newest();
      score.look(node.ledger());
    }
  }
  node.finish();
  score.look(node.ledger());
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  std::string robot;
  std::string told;
  std::string truth;
  std::vector<std::string> logs;
  std::string figures;
  luminav::CommandLine line("score_changes", "Compares what the caretaker proposes with how the building was changed.");
  line.robot_file(robot);
  line.text("--told", told, "building.toml of the robot", true)
      .text("--truth", truth, "building.toml that it drove in", true)
      .output_file("--figures", figures, "where the figures are written, as JSON");
  line.list("--log", logs, "of a drive; several times for several drives, one ledger for all");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  return luminav::run_guarded("score_changes", [&] {
    const luminav::Building building = luminav::read_building(told);
    lcm::LCM lcm("memq://");
    luminav::CaretakerNode node(lcm, luminav::read_robot(robot), building, "");
    luminav::ChangeScore score(building, luminav::read_building(truth));
    for (const std::string& log : logs) {
      luminav::play(log, lcm, node, score);
    }
    luminav::write_whole_file(figures, score.to_json());
    return 0;
  });
}
