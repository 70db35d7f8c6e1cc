#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/caretaker/lamp_ledger.hpp"
#include "services/common/building/building.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/process/command_line.hpp"

namespace luminav {

/// Where a report on the ceiling takes its visits from: the ledger that the caretaker keeps, or logs of drives.
struct ReportSource {
  std::string robot_file;
  std::string building_file;
  std::string state;
  std::vector<std::string> logs;

  void add_options(CommandLine& line);
};

/// Robot, building and what was seen.
struct CeilingRecord {
  RobotDescription robot;
  Building building;
  std::filesystem::path ledger_file;
  LampLedger ledger;
};

/// Throws std::runtime_error when a file cannot be read, ConfigurationError when robot or building is damaged.
CeilingRecord read_record(const ReportSource& source);

}  // namespace luminav
