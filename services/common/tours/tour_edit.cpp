#include "services/common/tours/tour_edit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "services/common/configuration/configuration_error.hpp"
#include "services/common/configuration/toml_lines.hpp"

namespace luminav {
namespace {

using Lines = std::vector<std::string>;

void append(Lines& lines, const Lines& more) {
  lines.insert(lines.end(), more.begin(), more.end());
}

std::optional<std::size_t> find_tour(const std::vector<Tour>& tours, const std::string& name) {
  const auto found = std::find_if(tours.begin(), tours.end(), [&](const Tour& tour) { return tour.name == name; });
  return found == tours.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - tours.begin()));
}

std::size_t index_of(const std::vector<Tour>& tours, const std::string& name) {
  if (const std::optional<std::size_t> found = find_tour(tours, name)) {
    return *found;
  }
  throw ConfigurationError(fmt::format("there is no tour \"{}\"", name));
}

/// Sets a key of the table that these lines are, or takes it away.
void set(TomlLines& lines, std::size_t header, const std::string& key, const std::optional<std::string>& value) {
  if (value) {
    lines.set_key(lines.table_at(header), key, *value);
  } else {
    lines.erase_key(lines.table_at(header), key);
  }
}

/// What differs from the old one is written: the rest stays as somebody has laid it out.
void write(const Tour& tour, const Tour& old, TomlLines& lines, std::size_t header) {
  if (tour.name != old.name) {
    set(lines, header, "name", quoted(tour.name));
  }
  if (tour.at != old.at) {
    set(lines, header, "at", tour.at ? std::optional(quoted(time_of_day_text(*tour.at))) : std::nullopt);
  }
  if (tour.days != old.days) {
    set(lines, header, "days", tour.days == kEveryDay ? std::nullopt : std::optional(quoted(days_text(tour.days))));
  }
}

void write(const TourStop& stop, const TourStop& old, TomlLines& lines, std::size_t header) {
  if (stop.place != old.place) {
    set(lines, header, "place", quoted(stop.place));
  }
  if (stop.pause != old.pause) {
    set(lines, header, "pause", stop.pause == 0.0 ? std::nullopt : std::optional(fmt::format("{:.6g}", stop.pause)));
  }
  if (stop.text != old.text) {
    set(lines, header, "text", stop.text.empty() ? std::nullopt : std::optional(quoted(stop.text)));
  }
  if (stop.photo != old.photo) {
    set(lines, header, "photo", stop.photo ? std::optional<std::string>("true") : std::nullopt);
  }
}

template <typename Item>
Lines new_table(const char* header, const Item& item) {
  TomlLines lines(Lines{header});
  write(item, {}, lines, 0);
  return lines.lines({0, lines.size()});
}

/// Which of the old stops each new one was: the one at the same place, else the one that stood there and is gone.
std::vector<std::optional<std::size_t>> match(const std::vector<TourStop>& old, const std::vector<TourStop>& stops) {
  std::vector<std::optional<std::size_t>> origin(stops.size());
  std::vector<bool> is_taken(old.size());
  for (std::size_t i = 0; i < stops.size(); ++i) {
    for (std::size_t k = 0; k < old.size() && !origin[i]; ++k) {
      if (!is_taken[k] && old[k].place == stops[i].place) {
        origin[i] = k;
        is_taken[k] = true;
      }
    }
  }
  for (std::size_t i = 0; i < std::min(stops.size(), old.size()); ++i) {
    if (!origin[i] && !is_taken[i]) {
      origin[i] = i;
      is_taken[i] = true;
    }
  }
  return origin;
}

/// A jobs file of which one tour is edited.
class EditedFile {
 public:
  EditedFile(const std::string& toml, const JobsSource& source) : lines_(toml), source_(source) {}

  void append(const Tour& tour) {
    Lines block = {""};
    luminav::append(block, new_table("[[tour]]", tour));
    for (const TourStop& stop : tour.stops) {
      luminav::append(block, new_table("[[tour.stop]]", stop));
    }
    lines_.replace({lines_.size(), lines_.size()}, block);
  }

  void change(std::size_t index, const Tour& tour) {
    const std::size_t header = header_at(source_.lines[index].tour, "[[tour]]");
    rewrite_stops(index, tour.stops);
    write(tour, source_.jobs.tours[index], lines_, header);
  }

  void remove(std::size_t index) {
    const std::vector<int>& stops = source_.lines[index].stops;
    std::for_each(stops.rbegin(), stops.rend(), [&](int stop) { lines_.erase(stop_at(stop)); });
    lines_.erase(lines_.table_at(header_at(source_.lines[index].tour, "[[tour]]")));
  }

  /// Up to before another one; nothing = to the end.
  void move(std::size_t index, std::optional<std::size_t> before) {
    const TomlLines::Table block = block_of(index);
    Lines moved = lines_.lines(block);
    std::size_t target = before ? block_of(*before).begin : lines_.size();
    const bool has_gap = block.begin > 0 && lines_.is_blank(block.begin - 1);
    const TomlLines::Table old{block.begin - (has_gap ? 1 : 0), block.end};
    lines_.erase(old);
    target -= target > old.begin ? old.end - old.begin : 0;
    moved.insert(before ? moved.end() : moved.begin(), "");
    lines_.replace({target, target}, moved);
  }

  [[nodiscard]] std::string text() const { return lines_.text(); }

 private:
  /// Index of the line that is counted from 1.
  [[nodiscard]] std::size_t header_at(int line, const char* header) const {
    const auto at = static_cast<std::size_t>(std::max(1, line)) - 1;
    if (at >= lines_.size() || !lines_.is_header(at)) {
      throw ConfigurationError(
          fmt::format("line {} of the file is not a table of its own, must begin with {}", line, header));
    }
    return at;
  }
  [[nodiscard]] TomlLines::Table stop_at(int line) const { return lines_.table_at(header_at(line, "[[tour.stop]]")); }
  /// A whole tour with the comments right above it.
  [[nodiscard]] TomlLines::Table block_of(std::size_t index) const {
    const JobsSource::TourLines& at = source_.lines[index];
    const TomlLines::Table tour = lines_.table_at(header_at(at.tour, "[[tour]]"));
    return lines_.with_comments({tour.begin, stop_at(at.stops.back()).end});
  }

  void rewrite_stops(std::size_t index, const std::vector<TourStop>& stops) {
    const std::vector<TourStop>& old = source_.jobs.tours[index].stops;
    std::vector<TomlLines::Table> blocks;
    for (const int line : source_.lines[index].stops) {
      blocks.push_back(lines_.with_comments(stop_at(line)));
    }
    const std::vector<std::optional<std::size_t>> origin = match(old, stops);
    Lines written;
    for (std::size_t i = 0; i < std::max(stops.size(), old.size()); ++i) {
      if (i > 0 && i < blocks.size()) {  // what stands between two of them stays there
        luminav::append(written, lines_.lines({blocks[i - 1].end, blocks[i].begin}));
      }
      if (i < stops.size()) {
        luminav::append(written, origin[i] ? changed_stop(blocks[*origin[i]], stops[i], old[*origin[i]])
                                           : new_table("[[tour.stop]]", stops[i]));
      }
    }
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      if (std::find(origin.begin(), origin.end(), std::optional(k)) == origin.end()) {
        luminav::append(written, lines_.lines({blocks[k].begin, stop_at(source_.lines[index].stops[k]).begin}));
      }
    }
    lines_.replace({blocks.front().begin, blocks.back().end}, written);
  }

  [[nodiscard]] Lines changed_stop(TomlLines::Table block, const TourStop& stop, const TourStop& old) const {
    TomlLines lines(lines_.lines(block));
    std::size_t header = 0;
    while (!lines.is_header(header)) {
      ++header;
    }
    write(stop, old, lines, header);
    return lines.lines({0, lines.size()});
  }

  TomlLines lines_;
  const JobsSource& source_;
};

}  // namespace

std::vector<Tour> with_edit(const std::vector<Tour>& tours, const TourEdit& edit) {
  std::vector<Tour> result = tours;
  const bool is_new = edit.kind == TourEdit::Kind::kSet && edit.name.empty();
  const std::size_t old = is_new ? tours.size() : index_of(tours, edit.name);
  const auto at = result.begin() + static_cast<std::ptrdiff_t>(old);
  switch (edit.kind) {
    case TourEdit::Kind::kSet:
      if (edit.tour.name != edit.name && find_tour(tours, edit.tour.name)) {
        throw ConfigurationError(fmt::format("there is a tour \"{}\" already", edit.tour.name));
      }
      if (is_new) {
        result.push_back(edit.tour);
      } else {
        *at = edit.tour;
      }
      break;
    case TourEdit::Kind::kRemove:
      result.erase(at);
      break;
    case TourEdit::Kind::kMove: {
      if (edit.before == edit.name) {
        throw ConfigurationError("a tour does not stand before itself");
      }
      Tour moved = *at;
      result.erase(at);
      const std::size_t target = edit.before.empty() ? result.size() : index_of(result, edit.before);
      result.insert(result.begin() + static_cast<std::ptrdiff_t>(target), std::move(moved));
      break;
    }
  }
  return result;
}

std::string with_edit(const std::string& toml, const JobsSource& source, const TourEdit& edit) {
  EditedFile file(toml, source);
  const std::vector<Tour>& tours = source.jobs.tours;
  switch (edit.kind) {
    case TourEdit::Kind::kSet:
      if (edit.name.empty()) {
        file.append(edit.tour);
      } else {
        file.change(index_of(tours, edit.name), edit.tour);
      }
      break;
    case TourEdit::Kind::kRemove:
      file.remove(index_of(tours, edit.name));
      break;
    case TourEdit::Kind::kMove:
      file.move(index_of(tours, edit.name),
                edit.before.empty() ? std::nullopt : std::optional(index_of(tours, edit.before)));
      break;
  }
  return file.text();
}

}  // namespace luminav
