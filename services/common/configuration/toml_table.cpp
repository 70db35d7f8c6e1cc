#include "services/common/configuration/toml_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <cmath>
#include <fstream>
#include <set>

namespace luminav {
namespace {

std::string allowed_range(Range range) {
  if (std::isinf(range.min) && std::isinf(range.max)) {
    return "a finite number";
  }
  if (range.max >= 1e9) {
    return range.min > 0.0 ? "greater than 0" : fmt::format("at least {}", range.min);
  }
  return fmt::format("between {} and {}", range.min, range.max);
}

/// toml++ limits how deep arrays and inline tables nest, but not a.b.c.d...: 50,000 of them overflow its stack.
void refuse_deep_keys(const std::filesystem::path& file) {
  constexpr int kDeepest = 32;
  std::ifstream in(file);
  int number = 1;
  for (std::string line; std::getline(in, line); ++number) {
    int depth = 0;
    char quote = 0;
    for (const char c : line) {
      if (quote != 0 || c == '"' || c == '\'') {
        quote = quote == 0 ? c : c == quote ? '\0' : quote;
      } else if (c == '#') {
        break;
      } else {
        depth = c == '.' ? depth + 1 : c == '=' || c == ',' || c == '[' || c == '{' ? 0 : depth;
      }
      if (depth > kDeepest) {
        throw ConfigurationError(fmt::format("{}:{}: a key of more than {} parts", file.string(), number, kDeepest));
      }
    }
  }
}

}  // namespace

struct TomlTable::Contents {
  std::filesystem::path file;
  std::shared_ptr<const toml::table> document;
  const toml::table* table = nullptr;  // part of the document; null = an absent, empty table
  std::string name;                    // for messages, such as "camera"
  mutable std::set<std::string, std::less<>> asked;

  const toml::node* find(std::string_view key) const {
    asked.emplace(key);
    return table == nullptr ? nullptr : table->get(key);
  }
};

TomlTable TomlTable::load(const std::filesystem::path& file) {
  auto contents = std::make_shared<Contents>();
  contents->file = std::filesystem::absolute(file).lexically_normal();
  if (!std::filesystem::is_regular_file(contents->file)) {
    const bool is_folder = std::filesystem::is_directory(contents->file);
    throw ConfigurationError(
        fmt::format("{}: {}", file.string(), is_folder ? "is a folder, name the file in it" : "no such file"));
  }
  refuse_deep_keys(contents->file);
  try {
    contents->document = std::make_shared<const toml::table>(toml::parse_file(contents->file.string()));
  } catch (const toml::parse_error& error) {
    throw ConfigurationError(
        fmt::format("{}:{}: {}", file.string(), error.source().begin.line, std::string(error.description())));
  }
  contents->table = contents->document.get();
  return TomlTable(contents);
}

bool TomlTable::has(std::string_view key) const {
  return contents_->find(key) != nullptr;
}

void TomlTable::accept(std::string_view key) const {
  contents_->asked.emplace(key);
}

const std::filesystem::path& TomlTable::file() const {
  return contents_->file;
}

int TomlTable::line() const {
  const unsigned line = contents_->table == nullptr ? 0 : contents_->table->source().begin.line;
  return line == 0 ? 1 : static_cast<int>(line);
}

void TomlTable::fail(std::string_view key, const std::string& message) const {
  unsigned line = 0;
  if (contents_->table != nullptr) {
    const toml::node* node = contents_->table->get(key);
    line = node != nullptr ? node->source().begin.line : contents_->table->source().begin.line;
  }
  const std::string prefix = contents_->name.empty() ? "" : contents_->name + ".";
  throw ConfigurationError(
      fmt::format("{}:{}: {}{} {}", contents_->file.string(), line == 0 ? 1 : line, prefix, key, message));
}

double TomlTable::number(std::string_view key, Range range) const {
  const toml::node* node = contents_->find(key);
  if (node == nullptr) {
    fail(key, fmt::format("is missing, must be a number {}", allowed_range(range)));
  }
  const auto value = node->value<double>();
  if (!node->is_number() || !value) {
    fail(key, fmt::format("must be a number {}", allowed_range(range)));
  }
  if (!std::isfinite(*value) || *value < range.min || *value > range.max) {
    fail(key, fmt::format("= {}, must be {}", *value, allowed_range(range)));
  }
  return *value;
}

double TomlTable::number(std::string_view key, double fallback, Range range) const {
  return has(key) ? number(key, range) : fallback;
}

std::int64_t TomlTable::integer(std::string_view key, Range range) const {
  const toml::node* node = contents_->find(key);
  if (node == nullptr) {
    fail(key, fmt::format("is missing, must be a whole number {}", allowed_range(range)));
  }
  if (!node->is_integer()) {
    fail(key, fmt::format("must be a whole number {}", allowed_range(range)));
  }
  const auto value = *node->value<std::int64_t>();
  if (static_cast<double>(value) < range.min || static_cast<double>(value) > range.max) {
    fail(key, fmt::format("= {}, must be {}", value, allowed_range(range)));
  }
  return value;
}

std::int64_t TomlTable::integer(std::string_view key, std::int64_t fallback, Range range) const {
  return has(key) ? integer(key, range) : fallback;
}

int TomlTable::count(std::string_view key, int fallback, Range range) const {
  return static_cast<int>(integer(key, std::int64_t{fallback}, {std::max(range.min, -2e9), std::min(range.max, 2e9)}));
}

bool TomlTable::boolean(std::string_view key, bool fallback) const {
  const toml::node* node = contents_->find(key);
  if (node == nullptr) {
    return fallback;
  }
  if (!node->is_boolean()) {
    fail(key, "must be true or false");
  }
  return *node->value<bool>();
}

std::string TomlTable::text(std::string_view key) const {
  const toml::node* node = contents_->find(key);
  if (node == nullptr) {
    fail(key, "is missing, must be a text in quotes");
  }
  if (!node->is_string()) {
    fail(key, "must be a text in quotes");
  }
  return *node->value<std::string>();
}

std::string TomlTable::text(std::string_view key, std::string_view fallback) const {
  return has(key) ? text(key) : std::string(fallback);
}

std::string TomlTable::choice(std::string_view key, std::string_view fallback,
                              std::initializer_list<std::string_view> allowed) const {
  const std::string value = text(key, fallback);
  for (const std::string_view word : allowed) {
    if (value == word) {
      return value;
    }
  }
  fail(key, fmt::format("= \"{}\", must be one of {}", value, fmt::join(allowed, ", ")));
}

std::vector<double> TomlTable::numbers(std::string_view key, std::size_t length) const {
  const toml::node* node = contents_->find(key);
  std::vector<double> values;
  if (node == nullptr) {
    return values;
  }
  if (const toml::array* array = node->as_array()) {
    for (const toml::node& element : *array) {
      const auto value = element.is_number() ? element.value<double>() : std::nullopt;
      if (!value || !std::isfinite(*value)) {
        fail(key, "must be a list of finite numbers");
      }
      values.push_back(*value);
    }
  } else {
    fail(key, "must be a list of finite numbers");
  }
  if (length != 0 && values.size() != length) {
    fail(key, fmt::format("has {} numbers, must have {}", values.size(), length));
  }
  return values;
}

std::vector<int> TomlTable::integers(std::string_view key) const {
  std::vector<int> values;
  for (const double value : numbers(key)) {
    if (value != std::floor(value) || std::abs(value) > 2e9) {
      fail(key, "must be a list of whole numbers");
    }
    values.push_back(static_cast<int>(value));
  }
  return values;
}

std::vector<std::string> TomlTable::texts(std::string_view key) const {
  std::vector<std::string> values;
  const toml::node* node = contents_->find(key);
  if (node != nullptr && node->as_array() == nullptr) {
    fail(key, "must be a list of texts in quotes");
  }
  for (std::size_t i = 0; node != nullptr && i < node->as_array()->size(); ++i) {
    const auto value = node->as_array()->at(i).value_exact<std::string>();
    if (!value) {
      fail(key, "must be a list of texts in quotes");
    }
    values.push_back(*value);
  }
  return values;
}

std::vector<Eigen::Vector2d> TomlTable::points(std::string_view key) const {
  const toml::node* node = contents_->find(key);
  std::vector<Eigen::Vector2d> result;
  if (node == nullptr) {
    return result;
  }
  const toml::array* list = node->as_array();
  if (list == nullptr) {
    fail(key, "must be a list of [x, y] pairs");
  }
  for (const toml::node& element : *list) {
    const toml::array* pair = element.as_array();
    if (pair == nullptr || pair->size() != 2 || !(*pair)[0].is_number() || !(*pair)[1].is_number()) {
      fail(key, "must be a list of [x, y] pairs");
    }
    const Eigen::Vector2d point(*(*pair)[0].value<double>(), *(*pair)[1].value<double>());
    if (!point.allFinite()) {
      fail(key, "must be a list of finite [x, y] pairs");
    }
    result.push_back(point);
  }
  return result;
}

std::string TomlTable::path(std::string_view key) const {
  const std::string value = text(key, "");
  if (value.empty()) {
    return "";
  }
  const std::filesystem::path given(value);
  return (given.is_absolute() ? given : contents_->file.parent_path() / given).lexically_normal().string();
}

TomlTable TomlTable::table(std::string_view key) const {
  auto child = std::make_shared<Contents>();
  child->file = contents_->file;
  child->document = contents_->document;
  child->name = contents_->name.empty() ? std::string(key) : contents_->name + "." + std::string(key);
  if (const toml::node* node = contents_->find(key)) {
    child->table = node->as_table();
    if (child->table == nullptr) {
      fail(key, fmt::format("must be a table [{}]", key));
    }
  }
  return TomlTable(child);
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) const {
  std::vector<TomlTable> result;
  const toml::node* node = contents_->find(key);
  if (node == nullptr) {
    return result;
  }
  const toml::array* array = node->as_array();
  if (array == nullptr) {
    fail(key, fmt::format("must be written as [[{}]]", key));
  }
  for (const toml::node& element : *array) {
    auto child = std::make_shared<Contents>();
    child->file = contents_->file;
    child->document = contents_->document;
    child->name = std::string(key);
    child->table = element.as_table();
    if (child->table == nullptr) {
      fail(key, fmt::format("must be written as [[{}]]", key));
    }
    result.push_back(TomlTable(child));
  }
  return result;
}

void TomlTable::reject_unknown() const {
  if (contents_->table == nullptr) {
    return;
  }
  for (const auto& [key, node] : *contents_->table) {
    if (contents_->asked.find(key.str()) == contents_->asked.end()) {
      throw ConfigurationError(fmt::format(
          "{}:{}: unknown key \"{}\"{}, known are {}", contents_->file.string(), key.source().begin.line, key.str(),
          contents_->name.empty() ? "" : " in [" + contents_->name + "]", fmt::join(contents_->asked, ", ")));
    }
  }
}

}  // namespace luminav
