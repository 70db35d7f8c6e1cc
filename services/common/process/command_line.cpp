#include "services/common/process/command_line.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include "services/common/configuration/toml_table.hpp"
#include "services/common/configuration/whole_file.hpp"

namespace luminav {

struct CommandLine::Parser {
  CLI::App app;
};

CommandLine::CommandLine(std::string_view process, std::string_view description) : parser_(std::make_unique<Parser>()) {
  parser_->app.name(std::string(process));
  parser_->app.description(std::string(description));
  parser_->app.set_version_flag("--version", fmt::format("{} (luminav) {}", process, kVersion));
}

CommandLine::~CommandLine() = default;

CommandLine& CommandLine::text(std::string_view flag, std::string& target, std::string_view help, bool required) {
  parser_->app.add_option(std::string(flag), target, std::string(help))
      ->capture_default_str()
      ->required(required)
      ->check([](const std::string& value) { return value.empty() ? "needs a value" : std::string(); }, "", "");
  return *this;
}

CommandLine& CommandLine::output_file(std::string_view flag, std::string& target, std::string_view help) {
  output_files_.push_back(&target);
  return text(flag, target, help);
}

CommandLine& CommandLine::number(std::string_view flag, double& target, std::string_view help) {
  parser_->app.add_option(std::string(flag), target, std::string(help))->capture_default_str();
  return *this;
}

CommandLine& CommandLine::integer(std::string_view flag, std::int64_t& target, std::string_view help) {
  parser_->app.add_option(std::string(flag), target, std::string(help))->capture_default_str();
  return *this;
}

CommandLine& CommandLine::flag(std::string_view flag, bool& target, std::string_view help) {
  parser_->app.add_flag(std::string(flag), target, std::string(help));
  return *this;
}

CommandLine& CommandLine::list(std::string_view flag, std::vector<std::string>& target, std::string_view help) {
  parser_->app.add_option(std::string(flag), target, std::string(help));
  return *this;
}

CommandLine& CommandLine::positional(std::string_view name, std::vector<std::string>& target, std::string_view help,
                                     bool required) {
  if (name.find(' ') != std::string_view::npos) {
    throw std::logic_error("newer CLI11 takes no spaces in a positional's name");
  }
  // "4.2 -1.5" are numbers, not options
  parser_->app.allow_extras(false);
  parser_->app.add_option(std::string(name), target, std::string(help))->required(required);
  return *this;
}

CommandLine& CommandLine::robot_file(std::string& target) {
  return text("--robot", target, "robot file (TOML)", true);
}

CommandLine& CommandLine::building_file(std::string& target) {
  building_file_ = &target;
  return text("--building", target, "building file (TOML), or its folder", true);
}

CommandLine& CommandLine::lcm_url(std::string& target) {
  // That of the launched system comes first: with a second robot on a port of its own both may be set.
  for (const char* name : {"LUMINAV_LCM_URL", "LCM_DEFAULT_URL"}) {
    const char* from_environment = std::getenv(name);
    if (target.empty() && from_environment != nullptr) {
      target = from_environment;
    }
  }
  if (target.empty()) {
    target = "udpm://239.255.76.67:7667?ttl=0";
  }
  return text("--lcm-url", target, "LCM network; default $LUMINAV_LCM_URL, else $LCM_DEFAULT_URL");
}

CommandLine& CommandLine::launched_robot(std::string& target) {
  const char* launched = std::getenv("LUMINAV_ROBOT");
  if (target.empty() && launched != nullptr) {
    target = launched;
  }
  return text("--robot", target, "robot file (TOML) whose table [network] says who may speak; default $LUMINAV_ROBOT");
}

CommandLine& CommandLine::state_folder(std::string& target) {
  const char* launched = std::getenv("LUMINAV_STATE");
  if (target.empty() && launched != nullptr) {
    target = launched;
  }
  if (target.empty()) {
    const char* home = std::getenv("HOME");
    target = fmt::format("{}/.local/state/luminav", home != nullptr ? home : "/tmp");
  }
  return text("--state", target, "folder for what must survive a restart; default $LUMINAV_STATE");
}

std::optional<int> CommandLine::parse(int argc, char** argv) {
  try {
    parser_->app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {
      return parser_->app.exit(error);  // help or version
    }
    const std::string what = dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr
                                 ? error.what()
                                 : fmt::format("found {}", fmt::join(parser_->app.remaining(), " "));
    fmt::print(stderr, "{}: {}; see --help\n", parser_->app.get_name(), what);
    return 2;
  }
  if (std::any_of(output_files_.begin(), output_files_.end(), [](const std::string* file) { return *file == "-"; })) {
    keep_standard_output_for_files();
  }
  if (building_file_ != nullptr && std::filesystem::is_directory(*building_file_)) {
    *building_file_ += "/building.toml";
  }
  return std::nullopt;
}

int run_guarded(std::string_view process, const std::function<int()>& body) {
  try {
    return body();
  } catch (const ConfigurationError& error) {
    fmt::print(stderr, "{}: {}\n", process, error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", process, error.what());
    return 1;
  }
}

}  // namespace luminav
