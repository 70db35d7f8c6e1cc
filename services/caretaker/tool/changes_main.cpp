// Lists what hangs otherwise than the building's file says, and writes what a person accepts: scripts/changes runs it.

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string>

#include "services/caretaker/changed_building.hpp"
#include "services/caretaker/tool/report_source.hpp"
#include "services/common/configuration/configuration_error.hpp"

namespace {

using namespace luminav;

std::vector<CeilingChange> open_changes(const CeilingRecord& record, const std::vector<CeilingChange>& refusals) {
  std::vector<CeilingChange> changes = propose_changes(record.ledger, record.building);
  std::erase_if(changes, [&](const CeilingChange& change) {
    return std::any_of(refusals.begin(), refusals.end(),
                       [&](const CeilingChange& refused) { return is_same(change, refused); });
  });
  return changes;
}

/// The proposals with these numbers, as listed.
std::vector<CeilingChange> chosen(const std::vector<CeilingChange>& changes, const std::vector<std::string>& numbers) {
  std::vector<CeilingChange> list;
  for (const std::string& text : numbers) {
    const bool is_number =
        !text.empty() && text.size() < 6 && text.find_first_not_of("0123456789") == std::string::npos;
    const std::size_t number = is_number ? std::stoul(text) : 0;
    if (number < 1 || number > changes.size()) {
      throw ConfigurationError(
          fmt::format("found {}, must be the number of a proposal, 1 to {}", text, changes.size()));
    }
    list.push_back(changes[number - 1]);
  }
  if (list.empty()) {
    throw ConfigurationError("which proposals? Give their numbers, as listed");
  }
  return list;
}

int run(const ReportSource& source, const std::vector<std::string>& words) {
  CeilingRecord record = read_record(source);
  const std::filesystem::path refusals_file = record.ledger_file.parent_path() / "refused_changes.json";
  std::vector<CeilingChange> refusals = load_refusals(refusals_file);
  const std::vector<CeilingChange> changes = open_changes(record, refusals);
  const std::string action = words.empty() ? "list" : words.front();
  const std::vector<std::string> numbers(words.begin() + (words.empty() ? 0 : 1), words.end());
  if (action == "list") {
    for (std::size_t i = 0; i < changes.size(); ++i) {
      fmt::print("{}: {}\n", i + 1, describe(changes[i], record.building));
    }
    fmt::print("{} proposals\n", changes.size());
  } else if (action == "accept") {
    const std::vector<CeilingChange> accepted = chosen(changes, numbers);
    const auto kept = change_building(source.building_file, accepted, record.ledger.newest());
    fmt::print("{}: written; as it was: {}. Restart the services to use it.\n", source.building_file, kept.string());
  } else if (action == "refuse") {
    const std::vector<CeilingChange> refused = chosen(changes, numbers);
    refusals.insert(refusals.end(), refused.begin(), refused.end());
    save_refusals(refusals_file, refusals);
    fmt::print("{} refused: not proposed again\n", refused.size());
  } else {
    throw ConfigurationError(fmt::format("found {}, must be list, accept or refuse", action));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  ReportSource source;
  std::vector<std::string> words;
  CommandLine line("changes", "Proposes changes to a building's file, by what the robot saw; writes what is accepted.");
  source.add_options(line);
  line.positional("action", words, "list (default), accept N... or refuse N...");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  return run_guarded("changes", [&] { return run(source, words); });
}
