#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "services/common/configuration/configuration_error.hpp"

namespace luminav {

/// Allowed values, both ends included.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};
inline constexpr Range kAnyNumber{};
inline constexpr Range kPositive{1e-9, 1e9};
inline constexpr Range kNotNegative{0.0, 1e9};
inline constexpr Range kFraction{0.0, 1.0};

/// A table of a TOML file, read strictly: every getter remembers its key, and `reject_unknown` throws for what nobody
/// asked for. Getters without a fallback demand the key. All of them throw ConfigurationError.
class TomlTable {
 public:
  static TomlTable load(const std::filesystem::path& file);

  [[nodiscard]] bool has(std::string_view key) const;

  [[nodiscard]] double number(std::string_view key, Range range = kAnyNumber) const;
  [[nodiscard]] double number(std::string_view key, double fallback, Range range = kAnyNumber) const;
  [[nodiscard]] std::int64_t integer(std::string_view key, Range range = kAnyNumber) const;
  [[nodiscard]] std::int64_t integer(std::string_view key, std::int64_t fallback, Range range = kAnyNumber) const;
  [[nodiscard]] int count(std::string_view key, int fallback, Range range) const;
  [[nodiscard]] bool boolean(std::string_view key, bool fallback) const;
  [[nodiscard]] std::string text(std::string_view key) const;
  [[nodiscard]] std::string text(std::string_view key, std::string_view fallback) const;
  /// One of the allowed words.
  [[nodiscard]] std::string choice(std::string_view key, std::string_view fallback,
                                   std::initializer_list<std::string_view> allowed) const;
  /// A list of numbers; `length` 0 = any. Empty when the key is absent.
  [[nodiscard]] std::vector<double> numbers(std::string_view key, std::size_t length = 0) const;
  /// A list of texts. Empty when the key is absent.
  [[nodiscard]] std::vector<std::string> texts(std::string_view key) const;
  [[nodiscard]] std::vector<int> integers(std::string_view key) const;
  /// A list of [x, y] pairs. Empty when the key is absent.
  [[nodiscard]] std::vector<Eigen::Vector2d> points(std::string_view key) const;
  /// A path relative to the file's folder, made absolute; "" when absent.
  [[nodiscard]] std::string path(std::string_view key) const;

  /// Reads an optional number, count or switch into a field, which keeps its value when the key is absent.
  void read(std::string_view key, double& field, Range range = kAnyNumber) const { field = number(key, field, range); }
  void read(std::string_view key, int& field, Range range) const { field = count(key, field, range); }
  void read(std::string_view key, bool& field) const { field = boolean(key, field); }

  /// The table under a key; an empty one when it is absent.
  [[nodiscard]] TomlTable table(std::string_view key) const;
  /// The array of tables under a key; empty when absent.
  [[nodiscard]] std::vector<TomlTable> tables(std::string_view key) const;
  /// Marks a key as known without reading it: another process reads it.
  void accept(std::string_view key) const;

  /// Throws for the first key that no getter asked for, naming those that were.
  void reject_unknown() const;
  /// Throws "file:line: key: message".
  [[noreturn]] void fail(std::string_view key, const std::string& message) const;
  [[nodiscard]] const std::filesystem::path& file() const;
  /// Line on which the table begins; 1 for one that is absent.
  [[nodiscard]] int line() const;

 private:
  struct Contents;
  explicit TomlTable(std::shared_ptr<Contents> contents) : contents_(std::move(contents)) {}
  std::shared_ptr<Contents> contents_;  // the parsed document is shared by all tables of a file
};

}  // namespace luminav
