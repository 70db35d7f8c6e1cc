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

/// The recordings and saved maps of this machine, to be listed, fetched and deleted. Only regular files of their two
/// folders with names as recorder and mapper give them: no request reaches anything else. Thread-safe, for it keeps
/// nothing but the folders' names.
class KeptFiles {
 public:
  KeptFiles() = default;
  /// Neither folder needs to be there.
  KeptFiles(std::filesystem::path recordings, std::filesystem::path maps)
      : recordings_(std::move(recordings)), maps_(std::move(maps)) {}

  /// {"recordings": [...], "maps": [...]}, the newest first.
  [[nodiscard]] std::string json() const;
  /// A file to be sent piece by piece; nothing where there is none. `query` as "kind=recording&name=NAME".
  [[nodiscard]] std::optional<HttpResponse> fetch(std::string_view query) const;
  /// Throws RequestError for what is not there, is being written, or cannot be deleted.
  void remove(const FileOrder& order) const;

 private:
  struct Item {
    std::string name;
    std::vector<std::string> files;  // of a map the yaml and the picture
    std::uintmax_t bytes = 0;
    std::int64_t modified = 0;  // [s] since the epoch
    bool is_growing = false;    // was written to just now
  };
  static std::string list_json(std::vector<Item> items);
  [[nodiscard]] std::vector<Item> recordings() const;
  [[nodiscard]] std::vector<Item> maps() const;

  std::filesystem::path recordings_;
  std::filesystem::path maps_;
};

}  // namespace luminav
