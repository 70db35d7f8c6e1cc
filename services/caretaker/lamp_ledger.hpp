#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "services/caretaker/visit_recorder.hpp"

namespace luminav {

/// What was seen of a building's ceiling, visit after visit. Keeps the newest ones.
class LampLedger {
 public:
  explicit LampLedger(std::string building) : building_(std::move(building)) {}

  /// `fixtures` tells the ids of the indices.
  void add(const VisitRecorder::Result& ended, const std::vector<Fixture>& fixtures);

  [[nodiscard]] const std::string& building() const { return building_; }
  /// Visits of a fixture by its id, oldest first.
  [[nodiscard]] const std::vector<FixtureVisit>& visits(int id) const;
  /// Visits of what no fixture explains, oldest first.
  [[nodiscard]] const std::vector<StrangerVisit>& strangers() const { return strangers_; }
  /// The end of the newest visit [us]; 0 = none.
  [[nodiscard]] std::int64_t newest() const { return newest_; }
  [[nodiscard]] std::size_t size() const;

  [[nodiscard]] std::string to_json() const;
  /// Throws std::runtime_error when it is not what to_json writes.
  static LampLedger from_json(const std::string& text);

 private:
  std::string building_;
  std::map<int, std::vector<FixtureVisit>> fixtures_;  // by id
  std::vector<StrangerVisit> strangers_;
  std::int64_t newest_ = 0;  // [us]
};

/// The ledger kept in a file, or an empty one when there is none or it is of another building. Throws
/// std::runtime_error for a damaged one.
LampLedger load_ledger(const std::filesystem::path& file, const std::string& building);
/// Throws std::runtime_error when it cannot be written.
void save_ledger(const std::filesystem::path& file, const LampLedger& ledger);

}  // namespace luminav
