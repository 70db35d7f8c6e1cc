#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "services/common/building/building_check.hpp"
#include "services/common/building/map_file.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/common/process/command_line.hpp"
#include "services/surveyor/building_drawing.hpp"

namespace {

using namespace luminav;

const char* name_of(FindingKind kind) {
  switch (kind) {
    case FindingKind::kError:
      return "error";
    case FindingKind::kWarning:
      return "warning";
    case FindingKind::kNote:
      return "note";
  }
  return "error";
}

/// Fixtures that have a finding, for the drawing.
std::vector<int> marked_fixtures(const BuildingSource& source, const std::vector<BuildingFinding>& findings) {
  std::vector<int> ids;
  for (std::size_t i = 0; i < source.fixture_lines.size(); ++i) {
    const bool is_marked = std::any_of(findings.begin(), findings.end(), [&](const BuildingFinding& finding) {
      return finding.line == source.fixture_lines[i];
    });
    if (is_marked) {
      ids.push_back(source.building.fixtures[i].id);
    }
  }
  return ids;
}

int check(const std::string& file, const std::string& png, const std::string& svg) {
  const BuildingSource source = read_building_source(file);
  std::optional<PriorMap> map;
  if (!source.building.map_file.empty()) {
    map = read_map(source.building.map_file);
  }
  const std::vector<BuildingFinding> findings = check_building(source, map ? &*map : nullptr);
  int errors = 0;
  for (const BuildingFinding& finding : findings) {
    fmt::print("{}{}: {}: {}\n", file, finding.line > 0 ? fmt::format(":{}", finding.line) : "", name_of(finding.kind),
               finding.text);
    errors += finding.kind == FindingKind::kError ? 1 : 0;
  }
  fmt::print("{}: {} fixtures, {} elements, {} doors, {} places: {}\n", source.building.name,
             source.building.fixtures.size(), source.building.elements.size(), source.building.doors.size(),
             source.building.places.size(), errors == 0 ? "fit for driving" : fmt::format("{} errors", errors));
  const std::vector<int> marked = marked_fixtures(source, findings);
  if (!png.empty()) {
    draw_building_png(png, source.building, map ? &*map : nullptr, marked);
  }
  if (!svg.empty()) {
    write_whole_file(svg, draw_building_svg(source.building, map ? &*map : nullptr, marked));
  }
  return errors == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> files;
  std::string png;
  std::string svg;
  CommandLine line("check-building", "Checks a building's file as a surveyor would, and draws it.");
  line.positional("building", files, "building.toml, or its folder", true)
      .output_file("--png", png, "draw it: fixtures with a finding in red")
      .output_file("--svg", svg, "the same as SVG");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  return run_guarded("check-building", [&] {
    if (files.size() != 1) {
      throw std::runtime_error("needs one building.toml");
    }
    const std::filesystem::path file = files.front();
    return check((std::filesystem::is_directory(file) ? file / "building.toml" : file).string(), png, svg);
  });
}
