#include "services/viewer/building/building_findings.hpp"

#include <algorithm>
#include <optional>
#include <regex>

#include "services/common/building/building_check.hpp"
#include "services/common/building/map_file.hpp"

namespace luminav {

std::vector<std::string> findings_of(const BuildingSource& source) {
  static const std::regex line(R"( \(line \d+\))");
  const std::string& file = source.building.map_file;
  const std::optional<PriorMap> map = file.empty() ? std::nullopt : std::optional(read_map(file));
  std::vector<std::string> texts;
  for (const BuildingFinding& finding : check_building(source, map ? &*map : nullptr)) {
    if (finding.kind != FindingKind::kNote) {
      texts.push_back(std::regex_replace(finding.text, line, ""));
    }
  }
  return texts;
}

std::vector<std::string> without(std::vector<std::string> found, const std::vector<std::string>& known) {
  std::erase_if(found, [&](const std::string& text) { return std::count(known.begin(), known.end(), text) > 0; });
  return found;
}

}  // namespace luminav
