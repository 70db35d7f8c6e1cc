#include "services/caretaker/lamp_ledger.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "services/common/configuration/whole_file.hpp"

namespace luminav {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxVisits = 80;      // of one fixture
constexpr std::size_t kMaxStrangers = 400;  // of all

json to_json(const FixtureVisit& visit) {
  return {{"begin", visit.begin},       {"end", visit.end},
          {"expected", visit.expected}, {"lit", visit.lit},
          {"half", visit.half},         {"unlit", visit.unlit},
          {"changes", visit.changes},   {"offset", {visit.offset.x, visit.offset.y, visit.offset.theta}},
          {"grey", visit.grey}};
}

Pose2 pose_of(const json& numbers) {
  return {numbers.at(0).get<double>(), numbers.at(1).get<double>(), numbers.at(2).get<double>()};
}

FixtureVisit fixture_visit(const json& entry) {
  FixtureVisit visit;
  visit.begin = entry.at("begin").get<std::int64_t>();
  visit.end = entry.at("end").get<std::int64_t>();
  visit.expected = entry.at("expected").get<int>();
  visit.lit = entry.at("lit").get<int>();
  visit.half = entry.at("half").get<int>();
  visit.unlit = entry.at("unlit").get<int>();
  visit.changes = entry.at("changes").get<int>();
  visit.offset = pose_of(entry.at("offset"));
  visit.grey = entry.at("grey").get<double>();
  return visit;
}

json to_json(const StrangerVisit& visit) {
  const Pose2& pose = visit.world_from_fixture;
  return {{"begin", visit.begin},
          {"end", visit.end},
          {"seen", visit.seen},
          {"shape", static_cast<int>(visit.shape)},
          {"pose", {pose.x, pose.y, pose.theta}},
          {"length", visit.length},
          {"width", visit.width}};
}

StrangerVisit stranger_visit(const json& entry) {
  StrangerVisit visit;
  visit.begin = entry.at("begin").get<std::int64_t>();
  visit.end = entry.at("end").get<std::int64_t>();
  visit.seen = entry.at("seen").get<int>();
  visit.shape = static_cast<FixtureShape>(std::clamp(entry.at("shape").get<int>(), 0, 2));
  visit.world_from_fixture = pose_of(entry.at("pose"));
  visit.length = entry.at("length").get<double>();
  visit.width = entry.at("width").get<double>();
  return visit;
}

template <typename Visit>
void keep_newest(std::vector<Visit>& visits, std::size_t count) {
  if (visits.size() > count) {
    visits.erase(visits.begin(), visits.end() - static_cast<std::ptrdiff_t>(count));
  }
}

}  // namespace

void LampLedger::add(const VisitRecorder::Result& ended, const std::vector<Fixture>& fixtures) {
  for (const auto& [index, visit] : ended.fixtures) {
    std::vector<FixtureVisit>& visits = fixtures_[fixtures.at(static_cast<std::size_t>(index)).id];
    visits.push_back(visit);
    keep_newest(visits, kMaxVisits);
    newest_ = std::max(newest_, visit.end);
  }
  strangers_.insert(strangers_.end(), ended.strangers.begin(), ended.strangers.end());
  keep_newest(strangers_, kMaxStrangers);
}

const std::vector<FixtureVisit>& LampLedger::visits(int id) const {
  static const std::vector<FixtureVisit> kNone;
  const auto found = fixtures_.find(id);
  return found == fixtures_.end() ? kNone : found->second;
}

std::size_t LampLedger::size() const {
  std::size_t count = 0;
  for (const auto& [id, visits] : fixtures_) {
    count += visits.size();
  }
  return count;
}

std::string LampLedger::to_json() const {
  json fixtures = json::array();
  for (const auto& [id, visits] : fixtures_) {
    json list = json::array();
    for (const FixtureVisit& visit : visits) {
      list.push_back(luminav::to_json(visit));
    }
    fixtures.push_back({{"id", id}, {"visits", list}});
  }
  json strangers = json::array();
  for (const StrangerVisit& visit : strangers_) {
    strangers.push_back(luminav::to_json(visit));
  }
  return json{{"building", building_}, {"newest", newest_}, {"fixtures", fixtures}, {"strangers", strangers}}.dump() +
         "\n";
}

LampLedger LampLedger::from_json(const std::string& text) {
  try {
    const json content = json::parse(text);
    LampLedger ledger(content.at("building").get<std::string>());
    ledger.newest_ = content.at("newest").get<std::int64_t>();
    for (const json& fixture : content.at("fixtures")) {
      std::vector<FixtureVisit>& visits = ledger.fixtures_[fixture.at("id").get<int>()];
      for (const json& visit : fixture.at("visits")) {
        visits.push_back(fixture_visit(visit));
      }
    }
    for (const json& visit : content.at("strangers")) {
      ledger.strangers_.push_back(stranger_visit(visit));
    }
    return ledger;
  } catch (const json::exception& error) {
    throw std::runtime_error(fmt::format("not a ledger of lamps: {}", error.what()));
  }
}

LampLedger load_ledger(const std::filesystem::path& file, const std::string& building) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) {
    return LampLedger(building);
  }
  try {
    LampLedger ledger = LampLedger::from_json(read_whole_file(file));
    return ledger.building() == building ? ledger : LampLedger(building);
  } catch (const std::runtime_error& why) {
    throw std::runtime_error(fmt::format("{}: {}", file.string(), why.what()));
  }
}

void save_ledger(const std::filesystem::path& file, const LampLedger& ledger) {
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  write_whole_file(file, ledger.to_json(), Durability::kRenamed);
}

}  // namespace luminav
