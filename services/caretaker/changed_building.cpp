#include "services/caretaker/changed_building.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <sstream>

#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/configuration_error.hpp"
#include "services/common/configuration/whole_file.hpp"

namespace luminav {
namespace {

using Lines = std::vector<std::string>;

Lines lines_of(const std::string& text) {
  Lines lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    lines.push_back(line);
  }
  return lines;
}

std::string code_of(const std::string& line) {
  const std::size_t first = line.find_first_not_of(" \t");
  return first == std::string::npos ? "" : line.substr(first);
}

bool is_header(const std::string& line) {
  return code_of(line).rfind('[', 0) == 0 && line.find('=') == std::string::npos;
}

bool sets_key(const std::string& line, const std::string& key) {
  const std::string code = code_of(line);
  return code.rfind(key, 0) == 0 && code_of(code.substr(key.size())).rfind('=', 0) == 0;
}

/// The lines of a fixture's table: its header up to the last one that is not empty before the next table.
struct Block {
  Lines::iterator begin;
  Lines::iterator end;
};

Block find_fixture(Lines& lines, const BuildingSource& source, int id, const std::filesystem::path& file) {
  const std::vector<Fixture>& fixtures = source.building.fixtures;
  const auto fixture = std::find_if(fixtures.begin(), fixtures.end(), [id](const Fixture& f) { return f.id == id; });
  if (fixture == fixtures.end()) {
    throw ConfigurationError(fmt::format("{}: has no fixture {}", file.string(), id));
  }
  const int line = source.fixture_lines[static_cast<std::size_t>(fixture - fixtures.begin())];
  auto begin = lines.begin() + std::clamp<std::ptrdiff_t>(line - 1, 0, static_cast<std::ptrdiff_t>(lines.size()) - 1);
  if (!is_header(*begin)) {
    throw ConfigurationError(fmt::format("{}:{}: fixture {} is not a table of its own, must begin with [[fixture]]",
                                         file.string(), line, id));
  }
  auto end = std::find_if(begin + 1, lines.end(), is_header);
  while (end != begin + 1 && (code_of(*(end - 1)).empty() || code_of(*(end - 1)).front() == '#')) {
    --end;
  }
  return {begin, end};
}

void set_number(Lines& lines, const Block& block, const std::string& key, const std::string& value) {
  const auto old = std::find_if(block.begin, block.end, [&](const std::string& line) { return sets_key(line, key); });
  if (old == block.end) {
    lines.insert(block.end, key + " = " + value);
    return;
  }
  const std::size_t comment = old->find('#');
  *old = key + " = " + value + (comment == std::string::npos ? "" : "  " + old->substr(comment));
}

void move(Lines& lines, const BuildingSource& source, const CeilingChange& change, const std::filesystem::path& file) {
  const Pose2& pose = change.fixture.world_from_fixture;
  const auto set = [&](const std::string& key, const std::string& value) {
    set_number(lines, find_fixture(lines, source, change.id, file), key, value);
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

std::string joined(const Lines& lines) {
  std::string text;
  for (const std::string& line : lines) {
    text += line + "\n";
  }
  return text;
}

}  // namespace

std::string with_changes(const std::filesystem::path& file, const std::vector<CeilingChange>& changes) {
  const BuildingSource source = read_building_source(file);
  Lines lines = lines_of(read_whole_file(file));
  std::string appended;
  for (const CeilingChange& change : last_first(changes, source)) {
    switch (change.kind) {
      case ChangeKind::kMoved:
        move(lines, source, change, file);
        break;
      case ChangeKind::kRemoved: {
        const Block block = find_fixture(lines, source, change.id, file);
        lines.erase(block.begin, block.end);
        break;
      }
      case ChangeKind::kNew:
        appended += fixture_table(change.fixture, source.building.ceiling_height);
        break;
    }
  }
  return joined(lines) + appended;
}

std::filesystem::path change_building(const std::filesystem::path& file, const std::vector<CeilingChange>& changes,
                                      std::int64_t utime) {
  const std::string text = with_changes(file, changes);
  const std::string before = read_whole_file(file);
  const std::filesystem::path draft = file.parent_path() / ("." + file.filename().string() + ".draft");
  write_whole_file(draft, text);
  try {
    read_building(draft);
  } catch (...) {
    std::error_code error;
    std::filesystem::remove(draft, error);
    throw;
  }
  std::error_code error;
  std::filesystem::remove(draft, error);
  const std::string date = fmt::format("{:%Y-%m-%d-%H%M%S}", fmt::gmtime(static_cast<std::time_t>(utime / 1'000'000)));
  std::filesystem::path kept = file.parent_path() / (file.stem().string() + "-before-" + date + ".toml");
  for (int i = 2; std::filesystem::exists(kept); ++i) {
    kept = file.parent_path() / fmt::format("{}-before-{}-{}.toml", file.stem().string(), date, i);
  }
  write_whole_file(kept, before);
  write_whole_file(file, text);
  return kept;
}

}  // namespace luminav
