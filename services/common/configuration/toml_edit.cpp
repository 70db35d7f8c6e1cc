#include "services/common/configuration/toml_edit.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include "services/common/configuration/toml_lines.hpp"
#include "services/common/configuration/toml_table.hpp"

namespace luminav {
std::string with_keys_set(const std::string& toml, const std::string& table,
                          const std::vector<std::pair<std::string, std::string>>& values) {
  TomlLines lines(toml);
  if (lines.find_table(table).begin == lines.size()) {
    lines.append("");
    lines.append("[" + table + "]");
  }
  for (const auto& [key, value] : values) {
    lines.set_key(lines.find_table(table), key, value);
  }
  std::string text = lines.text();
  try {
    static_cast<void>(toml::parse(text));
  } catch (const toml::parse_error& error) {
    throw ConfigurationError(
        fmt::format("table [{0}] cannot be edited as it is written ({1}): give it a header [{0}] and "
                    "a line for each key",
                    table, std::string(error.description())));
  }
  return text;
}

}  // namespace luminav
