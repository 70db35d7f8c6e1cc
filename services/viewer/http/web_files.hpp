#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace luminav {

/// A file of the page, compiled in.
struct WebFile {
  std::string_view name;
  std::string_view content;
};

/// All of them; generated from services/viewer/web when the viewer is built.
const std::vector<WebFile>& web_files();

/// The type that browsers want for a file's name.
std::string_view content_type_of(std::string_view name);

}  // namespace luminav
