#include "services/launcher/pmd_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include "services/common/configuration/toml_table.hpp"
#include "services/launcher/pmd_lexer.hpp"

namespace luminav::launcher {
namespace {

using Kind = Token::Kind;

/// Recursive descent: one function per production of the grammar.
class PmdParser {
 public:
  PmdParser(std::string_view text, const std::string& file_name) : lexer_(text, file_name) {
    result_.file = file_name;
    token_ = lexer_.next();
  }

  PmdFile parse() {
    while (token_.kind != Kind::kEnd) {
      if (is_word("script")) {
        parse_script();
      } else if (!parse_command_or_group("")) {
        expected("'cmd', 'group', 'script' or end of file");
      }
    }
    check_references();
    return std::move(result_);
  }

 private:
  [[noreturn]] void expected(const std::string& what) const {
    lexer_.fail(token_.line, fmt::format("found {}, expected {}", to_string(token_), what));
  }
  [[nodiscard]] bool is_word(std::string_view word) const {
    return token_.kind == Kind::kIdentifier && token_.text == word;
  }
  void advance() { token_ = lexer_.next(); }
  void take(Kind kind, const std::string& what) {
    if (token_.kind != kind) {
      expected(what);
    }
    advance();
  }
  std::string take_string(const std::string& what) {
    std::string text = token_.text;
    take(Kind::kString, what);
    return text;
  }
  int take_integer(const std::string& what, int min, int max) {
    const Token token = token_;
    take(Kind::kInteger, what);
    const int value = std::stoi(token.text);
    if (value < min || value > max) {
      lexer_.fail(token.line, fmt::format("found {}, expected {}", value, what));
    }
    return value;
  }
  void check_name(const std::string& name, const std::string& what, int line) const {
    if (name.empty() || name.find('/') != std::string::npos) {
      lexer_.fail(line, fmt::format("found \"{}\", expected {} without '/' and not empty", name, what));
    }
  }

  bool parse_command_or_group(const std::string& enclosing) {
    if (is_word("cmd")) {
      parse_command(enclosing);
      return true;
    }
    if (is_word("group")) {
      parse_group(enclosing);
      return true;
    }
    return false;
  }

  void parse_group(const std::string& enclosing) {
    advance();
    const int line = token_.line;
    const std::string name = take_string("the group's name as a \"string\"");
    check_name(name, "a group's name", line);
    take(Kind::kOpen, "'{' after the group's name");
    const std::string path = enclosing.empty() ? name : enclosing + "/" + name;
    if (++depth_ > kDeepest) {
      lexer_.fail(line, fmt::format("groups are nested deeper than {}", kDeepest));
    }
    while (token_.kind != Kind::kClose) {
      if (!parse_command_or_group(path)) {
        expected(fmt::format("'cmd', 'group' or '}}' that ends group \"{}\" of line {}", name, line));
      }
    }
    --depth_;
    advance();
    groups_.insert(path);
  }

  void parse_command(const std::string& enclosing) {
    Command command;
    command.line = token_.line;
    command.group = enclosing;
    advance();
    bool named = false;
    if (token_.kind == Kind::kString) {
      check_name(token_.text, "a command's name", token_.line);
      command.name = token_.text;
      named = true;
      advance();
    }
    take(Kind::kOpen, named ? "'{' after the command's name" : "the command's name as a \"string\" or '{'");
    std::set<std::string> seen;
    while (token_.kind != Kind::kClose) {
      parse_attribute(command, seen);
    }
    advance();
    if (command.exec.empty()) {
      lexer_.fail(command.line,
                  fmt::format("command \"{}\" has no exec, expected exec = \"program arguments\";", command.name));
    }
    if (!named) {
      command.name = program_name(command.exec);
      check_name(command.name, "a command with a name", command.line);
    }
    if (command.deputy.empty()) {
      lexer_.fail(command.line, fmt::format("command \"{}\" has no deputy, expected deputy = \"id\";", command.name));
    }
    if (const Command* other = result_.find_command(command.name)) {
      lexer_.fail(command.line, fmt::format("command \"{}\" stands in line {} already, expected a name of its own",
                                            command.name, other->line));
    }
    result_.commands.push_back(std::move(command));
  }

  static std::string program_name(const std::string& exec) {
    const std::string program = exec.substr(0, exec.find(' '));
    return program.substr(program.rfind('/') + 1);
  }

  void parse_attribute(Command& command, std::set<std::string>& seen) {
    if (token_.kind != Kind::kIdentifier) {
      expected("an attribute (exec, deputy, host, group, auto_respawn, stop_signal, stop_time_allowed) or '}'");
    }
    const Token attribute = token_;
    const std::string key = attribute.text == "host" ? "deputy" : attribute.text;
    static const std::set<std::string> known = {"exec",         "deputy",      "group",
                                                "auto_respawn", "stop_signal", "stop_time_allowed"};
    if (!known.contains(key)) {
      expected("one of exec, deputy, host, group, auto_respawn, stop_signal, stop_time_allowed");
    }
    if (!seen.insert(key).second) {
      lexer_.fail(attribute.line, fmt::format("attribute '{}' is given twice", attribute.text));
    }
    advance();
    take(Kind::kAssign, fmt::format("'=' after {}", attribute.text));
    if (key == "stop_signal") {
      command.stop_signal = take_integer("a signal's number, 1 to 64", 1, 64);
    } else if (key == "stop_time_allowed") {
      command.stop_time_allowed = take_integer("seconds, 1 to 3600", 1, 3600);
    } else {
      const int line = token_.line;
      const std::string value = take_string(fmt::format("the value of {} as a \"string\"", attribute.text));
      if (key == "exec") {
        command.exec = value;
      } else if (key == "deputy") {
        if (value.empty()) {
          lexer_.fail(line, "found \"\", expected the id of a deputy");
        }
        command.deputy = value;
      } else if (key == "auto_respawn") {
        command.auto_respawn = is_true(value);
      }
      // group: the enclosing group counts
    }
    take(Kind::kSemicolon, fmt::format("';' after the value of {}", attribute.text));
  }

  static bool is_true(std::string value) {
    std::transform(value.begin(), value.end(), value.begin(), [](unsigned char c) { return std::tolower(c); });
    return value == "true" || value == "yes";
  }

  void parse_script() {
    Script script;
    script.line = token_.line;
    advance();
    script.name = take_string("the script's name as a \"string\"");
    if (const Script* other = result_.find_script(script.name)) {
      lexer_.fail(script.line, fmt::format("script \"{}\" stands in line {} already, expected a name of its own",
                                           script.name, other->line));
    }
    take(Kind::kOpen, "'{' after the script's name");
    while (token_.kind != Kind::kClose) {
      script.actions.push_back(parse_action());
      take(Kind::kSemicolon, "';' after an action");
    }
    advance();
    result_.scripts.push_back(std::move(script));
  }

  Action parse_action() {
    Action action;
    action.line = token_.line;
    if (is_word("start") || is_word("stop") || is_word("restart")) {
      action.kind = is_word("start")  ? Action::Kind::kStart
                    : is_word("stop") ? Action::Kind::kStop
                                      : Action::Kind::kRestart;
      advance();
      action.target = parse_target(true);
      if (is_word("wait")) {
        advance();
        action.await = parse_status();
      }
    } else if (is_word("wait")) {
      advance();
      parse_wait(action);
    } else if (is_word("run_script")) {
      action.kind = Action::Kind::kRunScript;
      advance();
      action.script = take_string("the script's name as a \"string\"");
    } else {
      expected("an action (start, stop, restart, wait, run_script) or '}'");
    }
    return action;
  }

  void parse_wait(Action& action) {
    if (is_word("ms")) {
      advance();
      action.kind = Action::Kind::kWaitTime;
      action.seconds = take_integer("milliseconds", 0, 2147483647) / 1000.0;
      return;
    }
    if (!is_word("cmd") && !is_word("group")) {
      expected("'ms', 'cmd' or 'group' after wait");
    }
    action.kind = Action::Kind::kWaitStatus;
    action.target = parse_target(false);
    if (!is_word("status")) {
      expected("'status' after what is waited for");
    }
    advance();
    action.await = parse_status();
  }

  Target parse_target(bool everything_allowed) {
    Target target;
    if (everything_allowed && is_word("everything")) {
      advance();
      return target;
    }
    if (!is_word("cmd") && !is_word("group")) {
      expected("'everything', 'cmd' or 'group'");
    }
    target.kind = is_word("cmd") ? Target::Kind::kCommand : Target::Kind::kGroup;
    advance();
    target.name = take_string("a name as a \"string\"");
    return target;
  }

  AwaitedStatus parse_status() {
    const Token token = token_;
    take(Kind::kString, "\"running\" or \"stopped\"");
    if (token.text != "running" && token.text != "stopped") {
      lexer_.fail(token.line, fmt::format("found {}, expected \"running\" or \"stopped\"", to_string(token)));
    }
    return token.text == "running" ? AwaitedStatus::kRunning : AwaitedStatus::kStopped;
  }

  void check_references() const {
    for (const Script& script : result_.scripts) {
      for (const Action& action : script.actions) {
        const Target& target = action.target;
        if (action.kind == Action::Kind::kRunScript && result_.find_script(action.script) == nullptr) {
          lexer_.fail(action.line, fmt::format("found script \"{}\", expected a script of this file", action.script));
        }
        if (target.kind == Target::Kind::kCommand && result_.find_command(target.name) == nullptr) {
          lexer_.fail(action.line, fmt::format("found command \"{}\", expected a command of this file", target.name));
        }
        if (target.kind == Target::Kind::kGroup && !groups_.contains(target.name)) {
          lexer_.fail(action.line, fmt::format("found group \"{}\", expected a group of this file", target.name));
        }
      }
    }
    std::map<std::string, int> lengths;
    for (const Script& script : result_.scripts) {
      std::vector<std::string> running;
      measure(script, running, lengths);
    }
  }

  // Actions that a script comes to with all that it runs; `lengths` holds the scripts that were measured already.
  int measure(const Script& script, std::vector<std::string>& running, std::map<std::string, int>& lengths) const {
    if (const auto known = lengths.find(script.name); known != lengths.end()) {
      return known->second;
    }
    if (std::find(running.begin(), running.end(), script.name) != running.end()) {
      lexer_.fail(script.line, fmt::format("script \"{}\" runs itself: {} -> {}", script.name,
                                           fmt::join(running, " -> "), script.name));
    }
    running.push_back(script.name);
    if (std::ssize(running) > kDeepest) {
      lexer_.fail(script.line, fmt::format("scripts run each other deeper than {}", kDeepest));
    }
    int length = 0;
    for (const Action& action : script.actions) {
      length += 1;
      if (action.kind == Action::Kind::kRunScript) {
        length += measure(*result_.find_script(action.script), running, lengths);
      }
      if (length > kMaxActions) {
        lexer_.fail(script.line,
                    fmt::format("script \"{}\" comes to more than {} actions with the scripts that it runs",
                                script.name, kMaxActions));
      }
    }
    running.pop_back();
    lengths[script.name] = length;
    return length;
  }

  static constexpr int kDeepest = 50;         // a file that nests deeper is damaged
  static constexpr int kMaxActions = 10'000;  // of a script: scripts that run others twice double with each level
  PmdLexer lexer_;
  Token token_;
  PmdFile result_;
  std::set<std::string> groups_;
  int depth_ = 0;
};

}  // namespace

std::string to_string(const Target& target) {
  switch (target.kind) {
    case Target::Kind::kCommand:
      return fmt::format("command \"{}\"", target.name);
    case Target::Kind::kGroup:
      return fmt::format("group \"{}\"", target.name);
    default:
      return "everything";
  }
}

bool is_in_group(std::string_view group_of_command, std::string_view group) {
  return group_of_command == group || (group_of_command.size() > group.size() && group_of_command.starts_with(group) &&
                                       group_of_command[group.size()] == '/');
}

const Script* PmdFile::find_script(std::string_view name) const {
  const auto found = std::find_if(scripts.begin(), scripts.end(), [&](const Script& s) { return s.name == name; });
  return found == scripts.end() ? nullptr : &*found;
}

const Command* PmdFile::find_command(std::string_view name) const {
  const auto found = std::find_if(commands.begin(), commands.end(), [&](const Command& c) { return c.name == name; });
  return found == commands.end() ? nullptr : &*found;
}

bool PmdFile::has_group(std::string_view name) const {
  return std::any_of(commands.begin(), commands.end(), [&](const Command& c) { return is_in_group(c.group, name); });
}

PmdFile parse_pmd(std::string_view text, const std::string& file_name) {
  return PmdParser(text, file_name).parse();
}

PmdFile read_pmd(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file)) {
    throw ConfigurationError(
        fmt::format("{}: cannot read this file, expected a process configuration (.pmd)", file.string()));
  }
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  return parse_pmd(text, file.string());
}

}  // namespace luminav::launcher
