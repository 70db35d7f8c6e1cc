#include "services/launcher/command_words.hpp"

#include <algorithm>
#include <stdexcept>

namespace luminav::launcher {
namespace {

bool is_name_start(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool is_name_part(char c) {
  return is_name_start(c) || (c >= '0' && c <= '9');
}

std::vector<std::string> split_words(std::string_view line) {
  std::vector<std::string> words;
  std::string word;
  bool in_word = false;
  char quote = '\0';
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote != '\0' && c == quote) {
      quote = '\0';
    } else if (c == '\\') {
      if (i + 1 == line.size()) {
        throw std::invalid_argument("the command ends with a backslash");
      }
      word += line[++i];  // in quotes of either kind, too: procman's rule, not a shell's
      in_word = true;
    } else if (quote != '\0') {
      word += c;
    } else if (c == '\'' || c == '"') {
      quote = c;
      in_word = true;
    } else if (c == ' ' || c == '\t' || c == '\n' || c == '\r') {
      if (in_word) {
        words.push_back(std::move(word));
        word.clear();
        in_word = false;
      }
    } else {
      word += c;
      in_word = true;
    }
  }
  if (quote != '\0') {
    throw std::invalid_argument("the command has an open quote");
  }
  if (in_word) {
    words.push_back(std::move(word));
  }
  return words;
}

/// Length of NAME in "NAME=...", 0 when the word is no assignment.
std::size_t assigned_name_length(std::string_view word) {
  const std::size_t length = word.find('=');
  if (length == std::string_view::npos || length == 0 || !is_name_start(word[0])) {
    return 0;
  }
  return std::all_of(word.begin(), word.begin() + static_cast<std::ptrdiff_t>(length), is_name_part) ? length : 0;
}

std::string expand(std::string_view word, const Environment& environment, std::vector<std::string>& unset) {
  std::string result;
  for (std::size_t i = 0; i < word.size();) {
    const bool braced = i + 1 < word.size() && word[i + 1] == '{';
    const std::size_t start = i + (braced ? 2 : 1);
    if (word[i] != '$' || start >= word.size() || !is_name_start(word[start])) {
      result += word[i++];
      continue;
    }
    std::size_t end = start;
    while (end < word.size() && is_name_part(word[end])) {
      ++end;
    }
    const std::size_t after = braced ? end + 1 : end;
    if (braced && (end == word.size() || word[end] != '}')) {
      result += word[i++];
      continue;
    }
    const std::string name(word.substr(start, end - start));
    if (const std::optional<std::string> value = environment(name)) {
      result += *value;
    } else {
      result += word.substr(i, after - i);
      unset.push_back(name);
    }
    i = after;
  }
  return result;
}

/// The program as it is written, "" when there is none.
std::string program_word(std::string_view line) {
  try {
    for (const std::string& word : split_words(line)) {
      if (assigned_name_length(word) == 0) {
        return word;
      }
    }
  } catch (const std::invalid_argument&) {
    return "";
  }
  return "";
}

}  // namespace

CommandWords split_command(std::string_view line, const Environment& environment) {
  CommandWords result;
  for (const std::string& word : split_words(line)) {
    const std::size_t name_length = result.words.empty() ? assigned_name_length(word) : 0;
    if (name_length > 0) {
      result.environment.emplace_back(word.substr(0, name_length), word.substr(name_length + 1));
    } else {
      result.words.push_back(expand(word, environment, result.unset));
    }
  }
  if (result.words.empty()) {
    throw std::invalid_argument("the command names no program");
  }
  return result;
}

std::string program_name(std::string_view line) {
  const std::string program = program_word(line);
  const std::string name = program.substr(program.rfind('/') + 1);
  constexpr std::string_view kInstalledPrefix = "luminav-";
  return name.starts_with(kInstalledPrefix) ? name.substr(kInstalledPrefix.size()) : name;
}

bool announces_itself(std::string_view line) {
  const std::string program = program_word(line);
  return program.starts_with("$LUMINAV_BIN/") || program.starts_with("${LUMINAV_BIN}/") ||
         program.substr(program.rfind('/') + 1).starts_with("luminav-");
}

}  // namespace luminav::launcher
