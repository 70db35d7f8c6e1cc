#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace luminav {

/// One row of the table of channels in lcmtypes/README.md.
struct ChannelRow {
  std::string channel;
  std::string rate;
  std::vector<std::string> publishers;
  std::vector<std::string> subscribers;
};

/// Reads the first table whose head names channel, rate, publisher and subscribers. Throws std::runtime_error when
/// there is none.
std::vector<ChannelRow> read_channel_table(const std::filesystem::path& markdown_file);

/// Processes as columns (in the order given), channels as rows: a dot where a process publishes, an arrow to each that
/// reads. Channels that none of the processes publishes are left out. Standalone SVG text.
std::string draw_process_graph(const std::vector<std::string>& processes, const std::vector<ChannelRow>& channels);

}  // namespace luminav
