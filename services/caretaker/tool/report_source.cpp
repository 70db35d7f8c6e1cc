#include "services/caretaker/tool/report_source.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "services/caretaker/caretaker_node.hpp"
#include "services/common/configuration/building_file.hpp"

namespace luminav {
namespace {

/// Plays the messages of a log that the caretaker hears.
void play(const std::string& file, lcm::LCM& lcm, const std::vector<std::string>& channels) {
  lcm::LogFile log(file, "r");
  if (!log.good()) {
    throw std::runtime_error(fmt::format("{}: cannot be read as an LCM log", file));
  }
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    for (const std::string& channel : channels) {
      if (event->channel == channel) {
        lcm.publish(channel, event->data, static_cast<unsigned>(event->datalen));
        lcm.handleTimeout(0);
      }
    }
  }
}

}  // namespace

void ReportSource::add_options(CommandLine& line) {
  line.robot_file(robot_file).building_file(building_file).state_folder(state);
  line.list("--log", logs, "LCM log of a drive, instead of the ledger; several times for several drives");
}

CeilingRecord read_record(const ReportSource& source) {
  CeilingRecord record{read_robot(source.robot_file), read_building(source.building_file), {}, LampLedger("")};
  record.ledger_file = ledger_file(source.state, record.robot.name);
  if (source.logs.empty()) {
    record.ledger = load_ledger(record.ledger_file, record.building.name);
    return record;
  }
  lcm::LCM lcm("memq://");
  CaretakerNode node(lcm, record.robot, record.building, "");
  for (const std::string& log : source.logs) {
    play(log, lcm, node.channels());
    node.finish();
  }
  record.ledger = node.ledger();
  return record;
}

}  // namespace luminav
