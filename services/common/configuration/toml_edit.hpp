#pragma once

#include <string>
#include <utility>
#include <vector>

namespace luminav {

/// The text of a TOML file with keys of a table set: in their old place, or at the table's end, or in a new table at
/// the end of the file. All else stays as it is, comments of other lines included. `values` are pairs of a key and the
/// text after its equals sign, which may end in a comment. Throws ConfigurationError where the outcome would not be
/// TOML, as with a table written in dotted keys or inline.
std::string with_keys_set(const std::string& toml, const std::string& table,
                          const std::vector<std::pair<std::string, std::string>>& values);

}  // namespace luminav
