#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace luminav::launcher {

/// A command line, ready to be run without a shell.
struct CommandWords {
  std::vector<std::pair<std::string, std::string>> environment;  // leading NAME=VALUE words
  std::vector<std::string> words;                                // program and arguments
  std::vector<std::string> unset;                                // variables that were left as written
};

using Environment = std::function<std::optional<std::string>(const std::string& name)>;

/// Splits at blanks with ' " and \ as in a shell, takes the leading NAME=VALUE words as environment (values as they
/// stand), then expands $NAME and ${NAME} in the other words, in single quotes too, as procman does. What a variable
/// holds is never split again. Throws std::invalid_argument for an open quote and for a line without a program.
CommandWords split_command(std::string_view line, const Environment& environment);

/// The program's name without folder and without "luminav-": what a process calls itself in NODE_STATUS.
std::string program_name(std::string_view line);

/// True when the program is one of ours: then it says in NODE_STATUS that it is ready.
bool announces_itself(std::string_view line);

}  // namespace luminav::launcher
