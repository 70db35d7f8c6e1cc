#pragma once

#include "services/common/building/building.hpp"
#include "services/common/configuration/toml_table.hpp"

namespace luminav {

/// What a table says of a fixture beside its place and its id: `shape`, `length` and `width` or `diameter`, `height`
/// (left out: the ceiling's) and `lamps`. Throws ConfigurationError.
Fixture read_fixture_kind(const TomlTable& table, double ceiling_height);

}  // namespace luminav
