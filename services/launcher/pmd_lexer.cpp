#include "services/launcher/pmd_lexer.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <limits>

#include "services/common/configuration/toml_table.hpp"

namespace luminav::launcher {
namespace {

// Not the functions of <cctype>: those depend on the locale.
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

std::string show(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte >= 0x20 && byte < 0x7f ? fmt::format("'{}'", c) : fmt::format("byte 0x{:02x}", byte);
}

}  // namespace

std::string to_string(const Token& token) {
  switch (token.kind) {
    case Token::Kind::kEnd:
      return "end of file";
    case Token::Kind::kString:
      return fmt::format("\"{}\"", token.text);
    default:
      return fmt::format("'{}'", token.text);
  }
}

void PmdLexer::fail(int line, const std::string& message) const {
  throw ConfigurationError(fmt::format("{}:{}: {}", file_name_, line, message));
}

void PmdLexer::skip_blanks() {
  while (position_ < text_.size()) {
    const char c = text_[position_];
    if (c == '#') {
      position_ = std::min(text_.find('\n', position_), text_.size());
    } else if (c == ' ' || c == '\t' || c == '\r' || c == '\n') {
      line_ += c == '\n' ? 1 : 0;
      ++position_;
    } else {
      return;
    }
  }
}

Token PmdLexer::next() {
  skip_blanks();
  if (position_ == text_.size()) {
    return {Token::Kind::kEnd, "", line_};
  }
  const char c = text_[position_];
  switch (c) {
    case '=':
      ++position_;
      return {Token::Kind::kAssign, "=", line_};
    case ';':
      ++position_;
      return {Token::Kind::kSemicolon, ";", line_};
    case '{':
      ++position_;
      return {Token::Kind::kOpen, "{", line_};
    case '}':
      ++position_;
      return {Token::Kind::kClose, "}", line_};
    case '"':
      return read_string();
    default:
      break;
  }
  if (is_digit(c)) {
    return read_integer();
  }
  if (!is_letter(c)) {
    fail(line_, fmt::format("found {}, expected a word, a \"string\", a number or one of = ; {{ }}", show(c)));
  }
  const std::size_t start = position_;
  while (position_ < text_.size() &&
         (is_letter(text_[position_]) || is_digit(text_[position_]) || text_[position_] == '-')) {
    ++position_;
  }
  return {Token::Kind::kIdentifier, std::string(text_.substr(start, position_ - start)), line_};
}

Token PmdLexer::read_string() {
  Token token{Token::Kind::kString, "", line_};
  ++position_;
  while (position_ < text_.size() && text_[position_] != '\n') {
    char c = text_[position_++];
    if (c == '"') {
      return token;
    }
    if (c == '\\') {
      if (position_ == text_.size() || text_[position_] == '\n') {
        break;
      }
      c = text_[position_++];
      c = c == 'n' ? '\n' : c == 'r' ? '\r' : c == 't' ? '\t' : c;
    }
    token.text += c;
  }
  fail(line_, fmt::format("the string \"{}... does not end, expected \" on the same line", token.text.substr(0, 20)));
}

Token PmdLexer::read_integer() {
  const std::size_t start = position_;
  std::int64_t value = 0;
  while (position_ < text_.size() && is_digit(text_[position_])) {
    value = value * 10 + (text_[position_++] - '0');
    if (value > std::numeric_limits<std::int32_t>::max()) {
      fail(line_, "found a number above 2147483647");
    }
  }
  return {Token::Kind::kInteger, std::string(text_.substr(start, position_ - start)), line_};
}

}  // namespace luminav::launcher
