#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/viewer/http/http_response.hpp"
#include "services/viewer/request_text.hpp"

namespace luminav {

/// The recordings, saved maps and photos of this machine, to be listed, fetched and deleted. Only regular files of
/// their folders with names as recorder, mapper and job service give them: no request reaches anything else.
/// Thread-safe, for it keeps nothing but the folders' names.
class KeptFiles {
 public:
  KeptFiles() = default;
  /// None of the folders needs to be there.
  KeptFiles(std::filesystem::path recordings, std::filesystem::path maps, std::filesystem::path photos)
      : recordings_(std::move(recordings)), maps_(std::move(maps)), photos_(std::move(photos)) {}

  /// {"recordings": [...], "maps": [...], "photos": [...]}, the newest first.
  [[nodiscard]] std::string json() const;
  /// A file to be sent piece by piece; nothing where there is none. `query` as "kind=recording&name=NAME".
  [[nodiscard]] std::optional<HttpResponse> fetch(std::string_view query) const;
  /// Throws RequestError for what is not there, is being written, or cannot be deleted.
  void remove(const FileOrder& order) const;

 private:
  struct Item {
    std::string name;
    std::vector<std::string> files;  // of a map the yaml and the picture, of a photo what is known of it, too
    std::uintmax_t bytes = 0;
    std::int64_t modified = 0;  // [s] since the epoch
    bool is_growing = false;    // was written to just now
  };
  static std::string list_json(std::vector<Item> items);
  [[nodiscard]] std::vector<Item> recordings() const;
  /// Of one name each: a file that ends in the first of these, and one for each of the others.
  [[nodiscard]] std::vector<Item> sets(FileOrder::Kind kind, const std::vector<std::string_view>& parts) const;
  [[nodiscard]] std::vector<Item> items(FileOrder::Kind kind) const;
  [[nodiscard]] const std::filesystem::path& folder(FileOrder::Kind kind) const;

  std::filesystem::path recordings_;
  std::filesystem::path maps_;
  std::filesystem::path photos_;
};

}  // namespace luminav
