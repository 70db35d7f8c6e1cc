#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "drivers/simulator/world/scenario.hpp"

namespace luminav {

/// A sense that dies: its name among the faults, and its event.
struct DeadSense {
  const char* name;
  const char* event;
  const char* process;  // that says so
};
/// Which of them an event of the scenario is; nullptr = none.
const DeadSense* sense_of(const ScenarioEvent& event);

/// Is there a sense whose death has such a name?
bool names_a_dead_sense(const std::string& only);

struct TortureScenario {
  std::uint64_t seed = 1;
  double minutes = 5.0;
  std::string only;  // only faults whose name holds this
};

/// Boxes and people, goals for hours, plugs that somebody pulls and senses that die.
void write_torture_scenario(const std::filesystem::path& file, const TortureScenario& plan);

}  // namespace luminav
