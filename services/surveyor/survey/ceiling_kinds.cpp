#include "services/surveyor/survey/ceiling_kinds.hpp"

#include <fmt/format.h>

#include <cmath>

#include "services/common/configuration/fixture_table.hpp"

namespace luminav {
namespace {

constexpr double kAlike = 0.03;  // [m] sides that differ by less are one to the camera

}  // namespace

bool looks_alike(const Fixture& a, const Fixture& b) {
  return a.shape == b.shape && std::abs(a.length - b.length) < kAlike && std::abs(a.width - b.width) < kAlike;
}

CeilingKinds read_ceiling_kinds(const std::filesystem::path& file) {
  const TomlTable root = TomlTable::load(file);
  CeilingKinds kinds;
  kinds.ceiling_height = root.number("ceiling_height", {1.0, 30.0});
  for (const TomlTable& table : root.tables("kind")) {
    Fixture kind = read_fixture_kind(table, kinds.ceiling_height);
    kind.id = static_cast<int>(kinds.kinds.size()) + 1;
    table.reject_unknown();
    for (const Fixture& other : kinds.kinds) {
      if (looks_alike(kind, other)) {
        table.fail("kind", fmt::format("looks like kind {}: sides must differ by at least {} m", other.id, kAlike));
      }
    }
    kinds.kinds.push_back(kind);
  }
  if (kinds.kinds.empty()) {
    root.fail("kind", "is missing: at least one [[kind]] of fixture is needed, with its length and width");
  }
  root.reject_unknown();
  return kinds;
}

Building building_of(const CeilingKinds& kinds) {
  Building building;
  building.name = "kinds";
  building.ceiling_height = kinds.ceiling_height;
  building.fixtures = kinds.kinds;
  return building;
}

}  // namespace luminav
