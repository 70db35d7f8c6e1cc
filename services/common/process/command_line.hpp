#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace luminav {

/// The options of a process. CLI11 behind a small header: it costs ten seconds in every unit that includes it.
class CommandLine {
 public:
  CommandLine(std::string_view process, std::string_view description);
  ~CommandLine();

  CommandLine& text(std::string_view flag, std::string& target, std::string_view help, bool required = false);
  /// A file to write; "-" is standard output, and what the program says then goes to standard error.
  CommandLine& output_file(std::string_view flag, std::string& target, std::string_view help);
  CommandLine& number(std::string_view flag, double& target, std::string_view help);
  CommandLine& integer(std::string_view flag, std::int64_t& target, std::string_view help);
  CommandLine& flag(std::string_view flag, bool& target, std::string_view help);
  /// May be given several times.
  CommandLine& list(std::string_view flag, std::vector<std::string>& target, std::string_view help);
  CommandLine& positional(std::string_view name, std::vector<std::string>& target, std::string_view help,
                          bool required = false);

  // What all processes share.
  CommandLine& robot_file(std::string& target);
  CommandLine& building_file(std::string& target);
  CommandLine& lcm_url(std::string& target);
  /// For programs that need of it only who may speak; default $LUMINAV_ROBOT, as scripts/launch has it.
  CommandLine& launched_robot(std::string& target);
  /// Default $LUMINAV_STATE, as scripts/launch has it, else ~/.local/state/luminav; processes add the robot's name.
  CommandLine& state_folder(std::string& target);

  /// The exit status if the program should end now (help, version, a wrong option), else nothing.
  [[nodiscard]] std::optional<int> parse(int argc, char** argv);

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
  std::vector<const std::string*> output_files_;
  std::string* building_file_ = nullptr;
};

/// Runs the body of main; prints `<process>: <what>` and returns 2 for a ConfigurationError, 1 for any other exception.
int run_guarded(std::string_view process, const std::function<int()>& body);

inline constexpr const char* kVersion = "0.1.0";

}  // namespace luminav
