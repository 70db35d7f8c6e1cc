#include "services/viewer/http/kept_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <memory>

#include "services/viewer/http/query.hpp"
#include "services/viewer/message_json.hpp"

namespace luminav {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPiece = 64 * 1024;                             // [bytes] held of a file that is sent
constexpr std::chrono::seconds kGrowing{3};                           // the recorder writes ten times a second
const std::vector<std::string_view> kMapParts = {".yaml", ".pgm"};    // as the mapper writes them
const std::vector<std::string_view> kPhotoParts = {".jpg", ".json"};  // as the job service does

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

bool is_part(std::string_view name, const std::vector<std::string_view>& parts) {
  return std::any_of(parts.begin(), parts.end(), [&](std::string_view part) {
    return name.size() > part.size() && name.size() < 200 && name.ends_with(part) &&
           is_of(name.substr(0, name.size() - part.size()), "-_");
  });
}

/// Not what a symbolic link leads to.
bool is_plain_file(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(fs::symlink_status(file, error));
}

bool is_name(FileOrder::Kind kind, std::string_view name) {
  switch (kind) {
    case FileOrder::Kind::kRecording:
      return is_recording_name(name);
    case FileOrder::Kind::kMap:
      return is_part(name, kMapParts);
    case FileOrder::Kind::kPhoto:
      return is_part(name, kPhotoParts);
  }
  return false;
}

std::vector<std::string> plain_files(const fs::path& folder, FileOrder::Kind kind) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (is_name(kind, name) && is_plain_file(entry->path())) {
      names.push_back(name);
    }
  }
  return names;
}

}  // namespace

std::vector<KeptFiles::Item> KeptFiles::recordings() const {
  std::vector<Item> items;
  for (const std::string& name : plain_files(recordings_, FileOrder::Kind::kRecording)) {
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

std::vector<KeptFiles::Item> KeptFiles::sets(FileOrder::Kind kind, const std::vector<std::string_view>& parts) const {
  std::vector<Item> items;
  const fs::path& where = folder(kind);
  for (const std::string& first : plain_files(where, kind)) {
    const std::string name = fs::path(first).stem().string();
    const bool is_whole = std::all_of(parts.begin(), parts.end(), [&](std::string_view part) {
      return is_plain_file(where / (name + std::string(part)));
    });
    if (name + std::string(parts.front()) != first || !is_whole) {
      continue;
    }
    Item item;
    item.name = name;
    std::error_code gone;
    for (const std::string_view part : parts) {
      item.files.push_back(name + std::string(part));
      item.bytes += fs::file_size(where / item.files.back(), gone);
    }
    const auto since = std::chrono::file_clock::to_sys(fs::last_write_time(where / first, gone)).time_since_epoch();
    item.modified = std::chrono::duration_cast<std::chrono::seconds>(since).count();
    if (!gone) {
      items.push_back(std::move(item));
    }
  }
  return items;
}

std::vector<KeptFiles::Item> KeptFiles::items(FileOrder::Kind kind) const {
  return kind == FileOrder::Kind::kRecording ? recordings()
                                             : sets(kind, kind == FileOrder::Kind::kMap ? kMapParts : kPhotoParts);
}

const fs::path& KeptFiles::folder(FileOrder::Kind kind) const {
  return kind == FileOrder::Kind::kRecording ? recordings_ : kind == FileOrder::Kind::kMap ? maps_ : photos_;
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
  return fmt::format(R"({{"recordings":{},"maps":{},"photos":{}}})", list_json(recordings()),
                     list_json(items(FileOrder::Kind::kMap)), list_json(items(FileOrder::Kind::kPhoto)));
}

std::optional<HttpResponse> KeptFiles::fetch(std::string_view query) const {
  const std::optional<FileOrder::Kind> kind = read_file_kind(value_of(query, "kind"));
  const std::string name(value_of(query, "name"));
  if (!kind || !is_name(*kind, name) || !is_plain_file(folder(*kind) / name)) {
    return std::nullopt;
  }
  const fs::path file = folder(*kind) / name;
  const auto stream = std::make_shared<std::ifstream>(file, std::ios::binary);
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  if (!*stream || error) {
    return std::nullopt;
  }
  HttpResponse response;
  const bool is_picture = name.ends_with(kPhotoParts.front());  // which a browser shows
  response.type = is_picture ? "image/jpeg" : "application/octet-stream";
  response.headers = {
      {"Content-Disposition", fmt::format("{}; filename=\"{}\"", is_picture ? "inline" : "attachment", name)}};
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
  const std::vector<Item> known = items(order.kind);
  const auto found =
      std::find_if(known.begin(), known.end(), [&](const Item& item) { return item.name == order.name; });
  if (found == known.end()) {
    throw RequestError("name: there is none of that name");
  }
  if (found->is_growing) {
    throw RequestError("this recording is being written: stop it first");
  }
  for (const std::string& file : found->files) {
    std::error_code error;
    if (!fs::remove(folder(order.kind) / file, error) || error) {
      throw RequestError("it cannot be deleted: " + error.message());
    }
  }
}

}  // namespace luminav
