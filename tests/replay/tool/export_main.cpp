#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "services/common/configuration/shipped_file.hpp"
#include "services/common/configuration/toml_table.hpp"
#include "services/common/log/log_file.hpp"
#include "services/common/process/command_line.hpp"
#include "tests/replay/log_reading/message_schema.hpp"
#include "tests/replay/tool/mcap/foxglove_export.hpp"
#include "tests/replay/tool/mcap/mcap_writer.hpp"

namespace luminav {
namespace {

/// RFC 4180: quotes around what holds commas, quotes or line ends.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) {
    return text;
  }
  std::string result = "\"";
  for (const char c : text) {
    result += c == '"' ? "\"\"" : std::string(1, c);
  }
  return result + '"';
}

std::string text_of(const FieldValue& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value.value)) {
    return fmt::format("{}", *integer);
  }
  if (const auto* number = std::get_if<double>(&value.value)) {
    return fmt::format("{}", *number);
  }
  return quoted(std::get<std::string>(value.value));
}

/// The columns of a channel in the order in which they first come up: arrays may grow.
struct Table {
  std::vector<std::string> heads;
  std::map<std::string, std::size_t> columns;
};

using Values = std::vector<FieldValue>;

class Exporter {
 public:
  explicit Exporter(std::int64_t longest) : longest_(static_cast<std::size_t>(longest)) {}
  Exporter(const Exporter&) = delete;
  Exporter& operator=(const Exporter&) = delete;
  /// Leaves nothing of what did not come to its end.
  ~Exporter() {
    for (const auto& [channel, sheet] : sheets_) {
      std::error_code ignored;
      std::filesystem::remove(temporary(sheet.file), ignored);
    }
  }

  /// First pass: which columns there are.
  void look(const LogEvent& event) {
    const std::optional<Values> values = MessageSchemas::built_in().decode(event.data, longest_);
    if (!values) {
      ++undecodable_[event.channel];
      return;
    }
    Table& table = tables_[event.channel];
    for (const FieldValue& value : *values) {
      if (table.columns.try_emplace(value.path, table.heads.size()).second) {
        table.heads.push_back(quoted(value.unit.empty() ? value.path : fmt::format("{} [{}]", value.path, value.unit)));
      }
    }
  }
  void open(const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    for (const auto& [channel, table] : tables_) {
      std::string name = channel;
      std::replace(name.begin(), name.end(), '/', '_');
      const std::filesystem::path file = folder / (name + ".csv");
      if (std::filesystem::exists(file)) {
        throw std::runtime_error(fmt::format("{}: exists already", file.string()));
      }
      Sheet& sheet = sheets_[channel];
      sheet.file = file;
      std::ofstream& out = sheet.out;
      out.open(temporary(file));
      out << "received [us]," << fmt::format("{}", fmt::join(table.heads, ",")) << "\n";
      if (!out) {
        throw std::runtime_error(fmt::format("{}: cannot be written", file.string()));
      }
    }
  }
  void write(const LogEvent& event) {
    const std::optional<Values> values = MessageSchemas::built_in().decode(event.data, longest_);
    if (!values) {
      return;
    }
    const Table& table = tables_.at(event.channel);
    std::vector<std::string> row(table.heads.size());
    for (const FieldValue& value : *values) {
      row[table.columns.at(value.path)] = text_of(value);
    }
    sheets_.at(event.channel).out << event.utime << "," << fmt::format("{}", fmt::join(row, ",")) << "\n";
    ++rows_[event.channel];
  }
  void finish() {
    for (auto& [channel, sheet] : sheets_) {
      sheet.out.close();
      if (sheet.out.fail()) {
        throw std::runtime_error(fmt::format("{}: could not be written to its end", sheet.file.string()));
      }
    }
    for (const auto& [channel, sheet] : sheets_) {
      std::filesystem::rename(temporary(sheet.file), sheet.file);
      fmt::print("{:<20} {:>8} rows, {} columns\n", channel, rows_[channel], tables_.at(channel).heads.size() + 1);
    }
    for (const auto& [channel, count] : undecodable_) {
      fmt::print("{:<20} {:>8} messages of no known type left out\n", channel, count);
    }
  }

 private:
  struct Sheet {
    std::filesystem::path file;
    std::ofstream out;  // to a temporary file beside it until all is written
  };
  static std::filesystem::path temporary(const std::filesystem::path& file) { return file.string() + ".tmp"; }

  std::size_t longest_;
  std::map<std::string, Table> tables_;
  std::map<std::string, Sheet> sheets_;
  std::map<std::string, std::int64_t> rows_;
  std::map<std::string, std::int64_t> undecodable_;
};

/// The damage of the log, in one sentence.
std::string write_tables(const std::string& file, const std::string& folder, std::int64_t longest) {
  Exporter exporter(longest);
  LogEvent event;
  LogReader log(file);
  std::int64_t events = 0;  // a log that is being recorded goes on meanwhile: its end is where it was now
  for (; log.next(event); ++events) {
    exporter.look(event);
  }
  exporter.open(folder);
  LogReader again(file);
  for (std::int64_t i = 0; i < events && again.next(event); ++i) {
    exporter.write(event);
  }
  exporter.finish();
  return log.damage();
}

/// That of the log's own configuration, where scripts/record kept one, or the one that is shipped.
std::filesystem::path robot_of(const std::string& log, const std::string& asked) {
  const std::filesystem::path kept = log + ".config/robot.toml";
  if (!asked.empty()) {
    return asked;
  }
  return std::filesystem::exists(kept) ? kept : std::filesystem::path(shipped_file("robots/p3dx.toml"));
}

std::string write_mcap(const std::string& file, const std::string& out, const std::string& robot,
                       std::int64_t longest) {
  const RobotDescription description = read_robot(robot_of(file, robot));
  LogReader log(file);
  McapWriter writer(out);
  FoxgloveExport exporter(writer, description, static_cast<std::size_t>(longest));
  for (LogEvent event; log.next(event);) {
    exporter.add(event);
  }
  exporter.finish();
  writer.finish();
  for (const auto& [topic, count] : exporter.counts()) {
    fmt::print("{:<20} {:>8} messages\n", topic, count);
  }
  for (const auto& [channel, count] : exporter.unknown()) {
    fmt::print("{:<20} {:>8} messages of no known type left out\n", channel, count);
  }
  return log.damage();
}

int export_log(int argc, char** argv) {
  std::vector<std::string> logs;
  std::string folder, mcap, robot;
  std::int64_t longest = 64;
  CommandLine line("export",
                   "Writes an LCM log as tables, one CSV file per channel with the units of the message types in the "
                   "header, or as one MCAP file for Foxglove, Lichtblick and PlotJuggler.");
  line.positional("LOG", logs, "file that lcm-logger or scripts/record wrote", true)
      .text("--csv", folder, "folder to write to; it is made, files in it are never overwritten")
      .output_file("--mcap", mcap, "MCAP file to write")
      .text("--robot", robot,
            "for --mcap: where sonars and camera sit (default: LOG.config/robot.toml, else the P3-DX)")
      .integer("--longest", longest, "elements of an array that are written; pictures and tiles are left out");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  if (logs.size() != 1 || longest < 1 || longest > 10'000) {
    throw ConfigurationError("needs one log, and --longest between 1 and 10000");
  }
  if (folder.empty() == mcap.empty()) {
    throw ConfigurationError("needs --csv FOLDER or --mcap FILE");
  }
  const std::string damage =
      folder.empty() ? write_mcap(logs.front(), mcap, robot, longest) : write_tables(logs.front(), folder, longest);
  if (!damage.empty()) {
    fmt::print("{}\n", damage);
  }
  return 0;
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  return luminav::run_guarded("export", [&] { return luminav::export_log(argc, argv); });
}
