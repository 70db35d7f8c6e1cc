#include "services/viewer/http/kept_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <memory>

#include "services/viewer/http/query.hpp"
#include "services/viewer/message_json.hpp"

namespace luminav {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPiece = 64 * 1024;                                 // [bytes] held of a file that is sent
constexpr std::chrono::seconds kGrowing{3};                               // the recorder writes ten times a second
constexpr std::array<std::string_view, 2> kMapParts = {".yaml", ".pgm"};  // as the mapper writes them

bool is_of(std::string_view text, std::string_view more) {
  return std::all_of(text.begin(), text.end(), [&](unsigned char letter) {
    return (letter < 128 && std::isalnum(letter) != 0) ||
           more.find(static_cast<char>(letter)) != std::string_view::npos;
  });
}

/// "drive-2026-01-31.lcm", "drive-2026-01-31.lcm.00".
bool is_recording_name(std::string_view name) {
  constexpr std::string_view kEnd = ".lcm";
  const std::size_t end = name.rfind(kEnd);
  if (end == std::string_view::npos || end == 0 || name.size() > 200) {
    return false;
  }
  const std::string_view behind = name.substr(end + kEnd.size());
  const bool is_numbered =
      behind.size() > 1 && behind.front() == '.' && behind.find_first_not_of("0123456789", 1) == std::string_view::npos;
  return (behind.empty() || is_numbered) && name.front() != '.' && is_of(name.substr(0, end), "-_.");
}

bool is_map_part(std::string_view name) {
  return std::any_of(kMapParts.begin(), kMapParts.end(), [&](std::string_view part) {
    return name.size() > part.size() && name.size() < 200 && name.ends_with(part) &&
           is_of(name.substr(0, name.size() - part.size()), "-_");
  });
}

/// Not what a symbolic link leads to.
bool is_plain_file(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(fs::symlink_status(file, error));
}

std::vector<std::string> plain_files(const fs::path& folder, bool (*is_meant)(std::string_view)) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (is_meant(name) && is_plain_file(entry->path())) {
      names.push_back(name);
    }
  }
  return names;
}

}  // namespace

std::vector<KeptFiles::Item> KeptFiles::recordings() const {
  std::vector<Item> items;
  for (const std::string& name : plain_files(recordings_, is_recording_name)) {
    std::error_code gone;
    const fs::path file = recordings_ / name;
    const auto written = fs::last_write_time(file, gone);
    const auto age = fs::file_time_type::clock::now() - written;
    const auto since = std::chrono::file_clock::to_sys(written).time_since_epoch();
    Item item;
    item.name = name;
    item.files = {name};
    item.bytes = fs::file_size(file, gone);
    item.modified = std::chrono::duration_cast<std::chrono::seconds>(since).count();
    item.is_growing = age < kGrowing && age > -kGrowing;
    if (!gone) {
      items.push_back(std::move(item));
    }
  }
  return items;
}

std::vector<KeptFiles::Item> KeptFiles::maps() const {
  std::vector<Item> items;
  for (const std::string& yaml : plain_files(maps_, is_map_part)) {
    const std::string name = fs::path(yaml).stem().string();
    if (name + std::string(kMapParts.front()) != yaml ||
        !is_plain_file(maps_ / (name + std::string(kMapParts.back())))) {
      continue;
    }
    Item item;
    item.name = name;
    std::error_code gone;
    for (const std::string_view part : kMapParts) {
      item.files.push_back(name + std::string(part));
      item.bytes += fs::file_size(maps_ / item.files.back(), gone);
    }
    const auto since = std::chrono::file_clock::to_sys(fs::last_write_time(maps_ / yaml, gone)).time_since_epoch();
    item.modified = std::chrono::duration_cast<std::chrono::seconds>(since).count();
    if (!gone) {
      items.push_back(std::move(item));
    }
  }
  return items;
}

std::string KeptFiles::list_json(std::vector<Item> items) {
  std::sort(items.begin(), items.end(), [](const Item& a, const Item& b) {
    return a.modified != b.modified ? a.modified > b.modified : a.name > b.name;
  });
  std::string list;
  for (const Item& item : items) {
    std::string files;
    for (const std::string& file : item.files) {
      files += (files.empty() ? "" : ",") + to_json(std::string_view(file));
    }
    list +=
        fmt::format(R"({}{{"name":{},"files":[{}],"bytes":{},"modified":{},"growing":{}}})", list.empty() ? "" : ",",
                    to_json(std::string_view(item.name)), files, item.bytes, item.modified, item.is_growing);
  }
  return "[" + list + "]";
}

std::string KeptFiles::json() const {
  return fmt::format(R"({{"recordings":{},"maps":{}}})", list_json(recordings()), list_json(maps()));
}

std::optional<HttpResponse> KeptFiles::fetch(std::string_view query) const {
  const std::string_view kind = value_of(query, "kind");
  const std::string name(value_of(query, "name"));
  const bool is_recording = kind == "recording" && is_recording_name(name);
  const bool is_map = kind == "map" && is_map_part(name);
  const fs::path file = (is_recording ? recordings_ : maps_) / name;
  if (!(is_recording || is_map) || !is_plain_file(file)) {
    return std::nullopt;
  }
  const auto stream = std::make_shared<std::ifstream>(file, std::ios::binary);
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  if (!*stream || error) {
    return std::nullopt;
  }
  HttpResponse response;
  response.type = "application/octet-stream";
  response.headers = {{"Content-Disposition", fmt::format("attachment; filename=\"{}\"", name)}};
  if (size == 0) {
    return response;
  }
  response.size = size;
  response.more = [stream, left = size]() mutable {
    std::string piece(static_cast<std::size_t>(std::min<std::uintmax_t>(kPiece, left)), '\0');
    stream->read(piece.data(), static_cast<std::streamsize>(piece.size()));
    piece.resize(static_cast<std::size_t>(stream->gcount()));
    left -= piece.size();  // of one that is being written, what was there
    return piece;
  };
  return response;
}

void KeptFiles::remove(const FileOrder& order) const {
  const std::vector<Item> items = order.kind == FileOrder::Kind::kRecording ? recordings() : maps();
  const auto found =
      std::find_if(items.begin(), items.end(), [&](const Item& item) { return item.name == order.name; });
  if (found == items.end()) {
    throw RequestError("name: there is none of that name");
  }
  if (found->is_growing) {
    throw RequestError("this recording is being written: stop it first");
  }
  for (const std::string& file : found->files) {
    std::error_code error;
    if (!fs::remove((order.kind == FileOrder::Kind::kRecording ? recordings_ : maps_) / file, error) || error) {
      throw RequestError("it cannot be deleted: " + error.message());
    }
  }
}

}  // namespace luminav
