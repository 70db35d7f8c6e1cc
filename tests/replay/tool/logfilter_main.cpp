#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include "services/common/configuration/toml_table.hpp"
#include "services/common/log/log_file.hpp"
#include "services/common/process/command_line.hpp"

namespace luminav {
namespace {

/// "ROBOT_STATUS=5": every fifth message of the channel.
std::map<std::string, std::int64_t> parse_thinning(const std::vector<std::string>& settings) {
  std::map<std::string, std::int64_t> thinning;
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    const std::string number = equals == std::string::npos ? "" : setting.substr(equals + 1);
    if (number.empty() || number.size() > 6 ||
        !std::all_of(number.begin(), number.end(), [](char c) { return c >= '0' && c <= '9'; }) ||
        std::stoll(number) < 1) {
      throw ConfigurationError(fmt::format("--every {}: must be CHANNEL=N with N of at least 1", setting));
    }
    thinning[setting.substr(0, equals)] = std::stoll(number);
  }
  return thinning;
}

int filter(int argc, char** argv) {
  std::vector<std::string> files;
  std::string pattern = ".*";
  std::vector<std::string> every;
  double from = 0.0;
  double until = 1e9;
  CommandLine line("logfilter",
                   "Writes a part of an LCM log into a new log: channels, a time span, every Nth message.");
  line.positional("LOGS", files, "LOG NEW: the log to read and the log to write", true)
      .text("--channels", pattern, "regular expression of the channels to keep")
      .number("--from", from, "[s] since the first message")
      .number("--until", until, "[s] since the first message")
      .list("--every", every, "CHANNEL=N: only every Nth message of it; may be given several times");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  if (files.size() != 2) {
    throw ConfigurationError(
        fmt::format("found {} files, must be two: the log to read and the log to write", files.size()));
  }
  if (files[1] == "-") {
    keep_standard_output_for_files();
  }
  if (std::filesystem::exists(files[1]) && !is_written_in_place(files[1])) {
    throw std::runtime_error(fmt::format("{}: exists already, logs are never overwritten", files[1]));
  }
  const std::map<std::string, std::int64_t> thinning = parse_thinning(every);
  const std::regex channels(pattern);
  std::map<std::string, std::int64_t> seen;
  LogReader log(files[0]);
  LogWriter writer(files[1]);
  std::int64_t first = 0;
  std::int64_t written = 0;
  LogEvent event;
  while (log.next(event)) {
    first = first == 0 ? event.utime : first;
    const double at = static_cast<double>(event.utime - first) * 1e-6;
    if (at < from || at > until || !std::regex_match(event.channel, channels)) {
      continue;
    }
    const auto thin = thinning.find(event.channel);
    if (seen[event.channel]++ % (thin == thinning.end() ? 1 : thin->second) == 0) {
      writer.write(event.utime, event.channel, event.data.data(), event.data.size());
      ++written;
    }
  }
  if (written == 0) {
    throw std::runtime_error(fmt::format("{}: no message is left, nothing is written", files[0]));
  }
  for (const auto& [channel, every_nth] : thinning) {
    if (!seen.contains(channel)) {
      fmt::print("--every {}={}: no such message was kept\n", channel, every_nth);
    }
  }
  fmt::print("{} messages\nsha256: {}\n", written, writer.finish());
  if (!log.damage().empty()) {
    fmt::print("{}\n", log.damage());
  }
  return 0;
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  return luminav::run_guarded("logfilter", [&] { return luminav::filter(argc, argv); });
}
