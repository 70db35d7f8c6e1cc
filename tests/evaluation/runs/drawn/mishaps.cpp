#include "tests/evaluation/runs/drawn/mishaps.hpp"

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "services/common/configuration/whole_file.hpp"
#include "services/common/geometry/angle.hpp"
#include "tests/evaluation/runs/drawn/drawing.hpp"
#include "tests/evaluation/runs/drawn/drawn_buildings.hpp"

namespace luminav {
namespace {

namespace fs = std::filesystem;

std::string house_text() {
  return drawn_scenario("building.toml", 1200.0, {"study", "parlour", "kitchen"});
}
std::string ward_text() {
  return drawn_scenario("building.toml", 1500.0, {"room-2", "station", "day-room"});
}
std::string laboratory_text() {
  return drawn_scenario(fs::path(LUMINAV_SOURCE_DIR) / "launch/buildings/laboratory/building.toml", 900.0,
                        {"workbench", "office-3", "east-corridor"});
}

/// The fixture hangs so far [m, deg] from where the file has it.
std::string moved(int id, double dx, double dy, double dtheta_deg = 0.0) {
  return fmt::format("\n[[event]]\nkind = \"lamp\"\nat = 0\nid = {}\ndx = {}\ndy = {}\ndtheta = {:.4f}\n", id, dx, dy,
                     radians(dtheta_deg));
}

std::string every(double period, double duration, std::string_view event) {
  std::string text;
  for (double at = period; at < duration; at += period) {
    text += fmt::format("\n[[event]]\nat = {:.0f}\n{}", at, event);
  }
  return text;
}

}  // namespace

std::vector<fs::path> make_mishaps(const fs::path& folder) {
  make_drawn_buildings(folder);
  const fs::path laboratory = folder / "laboratory-mishaps";
  fs::create_directories(laboratory);
  std::vector<fs::path> scenarios;
  const auto add = [&](const fs::path& home, const char* name, const std::string& text) {
    scenarios.push_back(home / fmt::format("{}.toml", name));
    write_whole_file(scenarios.back().string(), text);
  };
  std::string corridor_off;
  for (int id = 27; id <= 34; ++id) {
    corridor_off += moved(id, 0.2, 0.0);
  }
  add(folder / "old-house", "house-one-off", house_text() + moved(2, 0.4, 0.0));
  add(folder / "old-house", "house-four-off",
      house_text() + moved(3, 0.4, 0.0) + moved(5, 0.0, -0.4) + moved(7, -0.3, 0.25) + moved(10, 0.28, 0.28));
  add(folder / "ward", "ward-four-off",
      ward_text() + moved(7, 0.4, 0.0) + moved(18, 0.0, -0.4) + moved(36, -0.3, 0.25) + moved(44, 0.28, 0.28));
  add(laboratory, "laboratory-four-off",
      laboratory_text() + moved(7, 0.4, 0.0) + moved(22, -0.3, 0.25) + moved(28, 0.0, -0.4) + moved(31, 0.28, 0.28));
  add(laboratory, "laboratory-row-off", laboratory_text() + corridor_off);
  add(laboratory, "laboratory-turned", laboratory_text() + moved(29, 0.0, 0.0, 90.0));
  add(laboratory, "laboratory-slips",
      laboratory_text() + every(15.0, 900.0, "kind = \"slip\"\nfactor = 0.5\nduration = 3\n"));
  add(laboratory, "laboratory-bumps",
      laboratory_text() + every(25.0, 900.0, "kind = \"bump\"\ndx = 0.1\ndy = 0.1\ndtheta = 0.21\n"));
  return scenarios;
}

}  // namespace luminav
