#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace luminav {

/// A text as a TOML basic string.
std::string quoted(const std::string& text);

/// The lines of a TOML file that a person wrote, for edits that leave all else as it is, comments included.
class TomlLines {
 public:
  explicit TomlLines(const std::string& text);
  explicit TomlLines(std::vector<std::string> lines) : lines_(std::move(lines)) {}

  /// A table's lines: its header up to behind the last one that belongs to it and says something.
  struct Table {
    std::size_t begin = 0;
    std::size_t end = 0;
  };

  [[nodiscard]] std::size_t size() const { return lines_.size(); }
  [[nodiscard]] bool is_header(std::size_t line) const;
  /// The table whose header is at `begin`.
  [[nodiscard]] Table table_at(std::size_t begin) const;
  /// The table `[name]`; its begin is size() where there is none.
  [[nodiscard]] Table find_table(const std::string& name) const;

  /// Sets a key in its old place, or at the table's end. `value` is the text after the equals sign; the comment of the
  /// old line stays unless the value brings one, or took several lines.
  void set_key(Table table, const std::string& key, const std::string& value);
  void erase_key(Table table, const std::string& key);
  /// Removes a table, what its lines say included.
  void erase(Table table);
  void append(const std::string& line) { lines_.push_back(line); }

  /// The table with the comments that stand right above it.
  [[nodiscard]] Table with_comments(Table table) const;
  [[nodiscard]] bool is_blank(std::size_t line) const;
  [[nodiscard]] std::vector<std::string> lines(Table table) const;
  /// Puts other lines in the place of these; an empty range is where they go in.
  void replace(Table table, const std::vector<std::string>& lines);

  [[nodiscard]] std::string text() const;

 private:
  /// Where a key is set, its value's lines; an empty range at the table's end where it is not.
  [[nodiscard]] Table find_key(Table table, const std::string& key) const;

  std::vector<std::string> lines_;
};

}  // namespace luminav
