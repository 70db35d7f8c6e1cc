#include "services/caretaker/changed_building.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/configuration_error.hpp"
#include "services/common/configuration/file_versions.hpp"
#include "services/common/configuration/toml_lines.hpp"
#include "services/common/configuration/whole_file.hpp"

namespace luminav {
namespace {

TomlLines::Table find_fixture(const TomlLines& lines, const BuildingSource& source, int id,
                              const std::filesystem::path& file) {
  const std::vector<Fixture>& fixtures = source.building.fixtures;
  const auto fixture = std::find_if(fixtures.begin(), fixtures.end(), [id](const Fixture& f) { return f.id == id; });
  if (fixture == fixtures.end()) {
    throw ConfigurationError(fmt::format("{}: has no fixture {}", file.string(), id));
  }
  const int line = source.fixture_lines[static_cast<std::size_t>(fixture - fixtures.begin())];
  const auto header = static_cast<std::size_t>(std::max(1, line)) - 1;
  if (header >= lines.size() || !lines.is_header(header)) {
    throw ConfigurationError(fmt::format("{}:{}: fixture {} is not a table of its own, must begin with [[fixture]]",
                                         file.string(), line, id));
  }
  return lines.table_at(header);
}

void move(TomlLines& lines, const BuildingSource& source, const CeilingChange& change,
          const std::filesystem::path& file) {
  const Pose2& pose = change.fixture.world_from_fixture;
  const auto set = [&](const std::string& key, const std::string& value) {
    lines.set_key(find_fixture(lines, source, change.id, file), key, value);
  };
  // the table's last key first: lines are counted in the file as it was, and only theta may be new
  set("x", fmt::format("{:.3f}", pose.x));
  set("y", fmt::format("{:.3f}", pose.y));
  set("theta", fmt::format("{:.4f}", pose.theta));
}

/// Later tables first, so that the lines of earlier ones stay what they were.
std::vector<CeilingChange> last_first(std::vector<CeilingChange> changes, const BuildingSource& source) {
  const auto line = [&](const CeilingChange& change) {
    for (std::size_t i = 0; i < source.building.fixtures.size(); ++i) {
      if (source.building.fixtures[i].id == change.id) {
        return source.fixture_lines[i];
      }
    }
    return 0;
  };
  std::stable_sort(changes.begin(), changes.end(),
                   [&](const CeilingChange& a, const CeilingChange& b) { return line(a) > line(b); });
  return changes;
}

}  // namespace

std::string with_changes(const std::filesystem::path& file, const std::vector<CeilingChange>& changes) {
  const BuildingSource source = read_building_source(file);
  TomlLines lines(read_whole_file(file));
  std::string appended;
  for (const CeilingChange& change : last_first(changes, source)) {
    switch (change.kind) {
      case ChangeKind::kMoved:
        move(lines, source, change, file);
        break;
      case ChangeKind::kRemoved:
        lines.erase(find_fixture(lines, source, change.id, file));
        break;
      case ChangeKind::kNew:
        appended += fixture_table(change.fixture, source.building.ceiling_height);
        break;
    }
  }
  return lines.text() + appended;
}

std::filesystem::path change_building(const std::filesystem::path& file, const std::vector<CeilingChange>& changes,
                                      std::int64_t utime) {
  const FileVersions versions(file);
  const FileVersions::Lock lock(file);
  const std::string text = with_changes(file, changes);
  const FileVersions::Draft draft(file, text);
  read_building(draft.file());
  return versions.replace(text, utime);
}

}  // namespace luminav
