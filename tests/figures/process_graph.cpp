#include "tests/figures/process_graph.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace luminav {
namespace {

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" `");
  const std::size_t last = text.find_last_not_of(" `");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, separator);) {
    parts.push_back(trimmed(part));
  }
  return parts;
}

/// Cells of a Markdown table's row; empty for another line.
std::vector<std::string> cells_of(const std::string& line) {
  if (line.empty() || line.front() != '|') {
    return {};
  }
  return split(line.substr(1, line.find_last_of('|') - 1), '|');
}

/// Left edge of what is drawn, and the distances of its grid, in px.
constexpr int kNames = 210;
constexpr int kColumn = 104;
constexpr int kRow = 30;
constexpr int kHead = 64;

}  // namespace

std::vector<ChannelRow> read_channel_table(const std::filesystem::path& markdown_file) {
  std::ifstream in(markdown_file);
  std::vector<ChannelRow> rows;
  std::vector<std::string> head;
  for (std::string line; std::getline(in, line);) {
    const std::vector<std::string> cells = cells_of(line);
    const auto column = [&](const char* name) {
      return static_cast<std::size_t>(std::find(head.begin(), head.end(), name) - head.begin());
    };
    if (cells.empty()) {
      head.clear();
    } else if (head.empty()) {
      head = cells;
    } else if (cells.size() == head.size() && column("channel") < head.size() && column("publisher") < head.size() &&
               column("subscribers") < head.size() && column("rate") < head.size() && cells[0].find("---") != 0) {
      for (const std::string& channel : split(cells[column("channel")], ',')) {
        rows.push_back({channel, cells[column("rate")], split(cells[column("publisher")], ','),
                        split(cells[column("subscribers")], ',')});
      }
    }
  }
  if (rows.empty()) {
    throw std::runtime_error(markdown_file.string() + ": has no table of channels");
  }
  return rows;
}

std::string draw_process_graph(const std::vector<std::string>& processes, const std::vector<ChannelRow>& channels) {
  const auto column_of = [&](const std::string& process) {
    const auto found = std::find(processes.begin(), processes.end(), process);
    return found == processes.end() ? -1 : static_cast<int>(found - processes.begin());
  };
  const auto columns_of = [&](const std::vector<std::string>& names) {
    std::vector<int> columns;
    for (const std::string& name : names) {
      if (name == "every process") {
        for (std::size_t i = 0; i < processes.size(); ++i) {
          columns.push_back(static_cast<int>(i));
        }
      } else if (const int column = column_of(name); column >= 0) {
        columns.push_back(column);
      }
    }
    return columns;
  };
  const auto x_of = [](int column) { return kNames + column * kColumn + kColumn / 2; };

  std::string rows;
  int y = kHead + kRow;
  for (const ChannelRow& channel : channels) {
    const std::vector<int> from = columns_of(channel.publishers);
    const std::vector<int> to = columns_of(channel.subscribers);
    if (from.empty()) {
      continue;
    }
    std::vector<int> all = from;
    all.insert(all.end(), to.begin(), to.end());
    const auto [min, max] = std::minmax_element(all.begin(), all.end());
    rows += fmt::format(
        "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>"
        "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" stroke=\"#b33\" stroke-width=\"2\"/>\n",
        kNames, y + 4, channel.channel, x_of(*min), y, x_of(*max), y);
    for (const int column : to) {
      const bool is_both = std::find(from.begin(), from.end(), column) != from.end();
      rows += fmt::format("<path d=\"M{} {}l8 0l-8 13l-8 -13z\" fill=\"#246\"/>\n", x_of(column) + (is_both ? 16 : 0),
                          y - 4);
    }
    for (const int column : from) {
      rows += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"6\" fill=\"#b33\"/>\n", x_of(column), y);
    }
    y += kRow;
  }

  const int width = kNames + static_cast<int>(processes.size()) * kColumn + 10;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n",
      width, y + 20);
  for (std::size_t i = 0; i < processes.size(); ++i) {
    const int x = x_of(static_cast<int>(i));
    svg += fmt::format(
        "<line x1=\"{0}\" y1=\"{1}\" x2=\"{0}\" y2=\"{2}\" stroke=\"#ccc\" stroke-width=\"2\"/>"
        "<rect x=\"{3}\" y=\"{4}\" width=\"{5}\" height=\"32\" rx=\"6\" fill=\"#eef3f8\" stroke=\"#246\"/>"
        "<text x=\"{0}\" y=\"{6}\" text-anchor=\"middle\">{7}</text>\n",
        x, kHead - 12, y - kRow + 14, x - kColumn / 2 + 5, kHead - 44, kColumn - 10, kHead - 23, processes[i]);
  }
  return svg + rows +
         fmt::format(
             "<circle cx=\"{}\" cy=\"{}\" r=\"6\" fill=\"#b33\"/><text x=\"{}\" y=\"{}\">publishes</text>"
             "<path d=\"M{} {}l8 0l-8 13l-8 -13z\" fill=\"#246\"/><text x=\"{}\" y=\"{}\">reads</text>\n</svg>\n",
             kNames + 10, y + 4, kNames + 22, y + 8, kNames + 110, y, kNames + 124, y + 8);
}

}  // namespace luminav
