#pragma once

#include <string>
#include <string_view>

namespace luminav::launcher {

/// One word of a procman configuration.
struct Token {
  enum class Kind { kIdentifier, kString, kInteger, kAssign, kSemicolon, kOpen, kClose, kEnd };
  Kind kind = Kind::kEnd;
  std::string text;  // of a string: without quotes, escapes resolved
  int line = 1;
};

/// As an error message shows it: `"text"` for strings, "end of file" for the end.
std::string to_string(const Token& token);

/// Splits a configuration into tokens; comments run from # to the end of the line.
class PmdLexer {
 public:
  PmdLexer(std::string_view text, std::string file_name) : text_(text), file_name_(std::move(file_name)) {}

  /// The next token, kEnd for ever at the end. Throws ConfigurationError for a character that starts no token, a string
  /// that does not end on its line, and an integer above 2^31 - 1.
  Token next();
  [[noreturn]] void fail(int line, const std::string& message) const;

 private:
  void skip_blanks();
  Token read_string();
  Token read_integer();

  std::string_view text_;
  std::string file_name_;
  std::size_t position_ = 0;
  int line_ = 1;
};

}  // namespace luminav::launcher
