#include "services/common/configuration/toml_edit.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <sstream>

#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

std::string trimmed(const std::string& line) {
  const std::size_t first = line.find_first_not_of(" \t");
  return first == std::string::npos ? "" : line.substr(first);
}

bool is_header(const std::string& line) {
  return trimmed(line).rfind('[', 0) == 0;
}

/// The table whose header this line is, as `[ camera . lens ] # comment` of camera.lens; "" for any other line.
std::string table_of(const std::string& line) {
  const std::string text = trimmed(line);
  if (text.rfind('[', 0) != 0 || text.rfind("[[", 0) == 0) {
    return "";
  }
  std::string name = text.substr(1, text.find(']') - 1);
  std::erase_if(name, [](char c) { return c == ' ' || c == '\t'; });
  return name;
}

bool sets_key(const std::string& line, const std::string& key) {
  const std::string text = trimmed(line);
  if (text.rfind(key, 0) != 0) {
    return false;
  }
  const std::string rest = trimmed(text.substr(key.size()));
  return !rest.empty() && rest.front() == '=';
}

/// Behind the last line of a value that begins in `line`: an array may take several.
std::vector<std::string>::iterator end_of_value(std::vector<std::string>::iterator line,
                                                std::vector<std::string>::iterator end) {
  int open = 0;
  for (; line != end; ++line) {
    const std::string code = line->substr(0, line->find('#'));
    open += static_cast<int>(std::count(code.begin(), code.end(), '[') - std::count(code.begin(), code.end(), ']'));
    if (open <= 0) {
      return line + 1;
    }
  }
  return end;
}

void set_key(std::vector<std::string>& lines, const std::string& table, const std::string& key,
             const std::string& value) {
  const std::string line = key + " = " + value;
  const auto header =
      std::find_if(lines.begin(), lines.end(), [&](const std::string& text) { return table_of(text) == table; });
  if (header == lines.end()) {
    lines.insert(lines.end(), {"", "[" + table + "]", line});
    return;
  }
  auto end = std::find_if(header + 1, lines.end(), is_header);
  const auto old = std::find_if(header + 1, end, [&](const std::string& text) { return sets_key(text, key); });
  if (old != end) {
    lines.insert(lines.erase(old, end_of_value(old, end)), line);
    return;
  }
  while (end != header + 1 && trimmed(*(end - 1)).empty()) {
    --end;
  }
  lines.insert(end, line);
}

}  // namespace

std::string with_keys_set(const std::string& toml, const std::string& table,
                          const std::vector<std::pair<std::string, std::string>>& values) {
  std::vector<std::string> lines;
  std::istringstream in(toml);
  for (std::string line; std::getline(in, line);) {
    lines.push_back(line);
  }
  for (const auto& [key, value] : values) {
    set_key(lines, table, key, value);
  }
  std::string text;
  for (const std::string& line : lines) {
    text += line + "\n";
  }
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
