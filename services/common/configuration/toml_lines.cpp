#include "services/common/configuration/toml_lines.hpp"

#include <algorithm>
#include <cctype>
#include <sstream>

namespace luminav {
namespace {

std::string trimmed(const std::string& line) {
  const std::size_t first = line.find_first_not_of(" \t");
  return first == std::string::npos ? "" : line.substr(first);
}

bool says_nothing(const std::string& line) {
  const std::string text = trimmed(line);
  return text.empty() || text.front() == '#';
}

/// What a line says outside of its strings, and where its comment begins.
struct CodeOfLine {
  std::string text{};
  std::size_t comment = std::string::npos;
};

CodeOfLine code_of(const std::string& line) {
  CodeOfLine code;
  char quote = '\0';  // of the string that it is in
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote != '\0') {
      i += quote == '"' && c == '\\' ? 1 : 0;
      quote = c == quote ? '\0' : quote;
    } else if (c == '#') {
      code.comment = i;
      break;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else {
      code.text += c;
    }
  }
  return code;
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
  return text.rfind(key, 0) == 0 && trimmed(text.substr(key.size())).rfind('=', 0) == 0;
}

}  // namespace

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    result += c == '"' || c == '\\' ? "\\" : "";
    result += c;
  }
  return result + '"';
}

TomlLines::TomlLines(const std::string& text) {
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    lines_.push_back(line);
  }
}

bool TomlLines::is_header(std::size_t line) const {
  // a row of an array begins with a bracket, too; a table's name begins with a letter
  const std::string text = trimmed(lines_[line]);
  const std::size_t name = text.find_first_not_of("[ \t");
  return text.rfind('[', 0) == 0 && name != std::string::npos &&
         std::isalpha(static_cast<unsigned char>(text[name])) != 0;
}

TomlLines::Table TomlLines::table_at(std::size_t begin) const {
  std::size_t end = begin + 1;
  while (end < lines_.size() && !is_header(end)) {
    ++end;
  }
  while (end > begin + 1 && says_nothing(lines_[end - 1])) {
    --end;
  }
  return {begin, end};
}

TomlLines::Table TomlLines::find_table(const std::string& name) const {
  const auto header =
      std::find_if(lines_.begin(), lines_.end(), [&](const std::string& line) { return table_of(line) == name; });
  const auto begin = static_cast<std::size_t>(header - lines_.begin());
  return header == lines_.end() ? Table{begin, begin} : table_at(begin);
}

TomlLines::Table TomlLines::find_key(Table table, const std::string& key) const {
  std::size_t first = table.begin + 1;
  while (first < table.end && !sets_key(lines_[first], key)) {
    ++first;
  }
  int open = 0;  // brackets of a list, which may take several lines
  for (std::size_t last = first; last < table.end; ++last) {
    const std::string code = code_of(lines_[last]).text;
    open += static_cast<int>(std::count(code.begin(), code.end(), '[') - std::count(code.begin(), code.end(), ']'));
    if (open <= 0) {
      return {first, last + 1};
    }
  }
  return {first, table.end};
}

void TomlLines::set_key(Table table, const std::string& key, const std::string& value) {
  const Table old = find_key(table, key);
  std::string line = key + " = " + value;
  if (old.end == old.begin + 1 && code_of(value).comment == std::string::npos) {
    const std::size_t comment = code_of(lines_[old.begin]).comment;
    line += comment == std::string::npos ? "" : "  " + lines_[old.begin].substr(comment);
  }
  erase(old);
  lines_.insert(lines_.begin() + static_cast<std::ptrdiff_t>(old.begin), line);
}

void TomlLines::erase_key(Table table, const std::string& key) {
  erase(find_key(table, key));
}

void TomlLines::erase(Table table) {
  lines_.erase(lines_.begin() + static_cast<std::ptrdiff_t>(table.begin),
               lines_.begin() + static_cast<std::ptrdiff_t>(table.end));
}

TomlLines::Table TomlLines::with_comments(Table table) const {
  while (table.begin > 0 && says_nothing(lines_[table.begin - 1]) && !is_blank(table.begin - 1)) {
    --table.begin;
  }
  return table;
}

bool TomlLines::is_blank(std::size_t line) const {
  return trimmed(lines_[line]).empty();
}

std::vector<std::string> TomlLines::lines(Table table) const {
  return {lines_.begin() + static_cast<std::ptrdiff_t>(table.begin),
          lines_.begin() + static_cast<std::ptrdiff_t>(table.end)};
}

void TomlLines::replace(Table table, const std::vector<std::string>& lines) {
  erase(table);
  lines_.insert(lines_.begin() + static_cast<std::ptrdiff_t>(table.begin), lines.begin(), lines.end());
}

std::string TomlLines::text() const {
  std::string text;
  for (const std::string& line : lines_) {
    text += line + "\n";
  }
  return text;
}

}  // namespace luminav
