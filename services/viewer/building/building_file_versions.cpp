#include "services/viewer/building/building_file_versions.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <ctime>
#include <stdexcept>
#include <system_error>

#include "services/common/configuration/building_watch.hpp"
#include "services/common/configuration/whole_file.hpp"

namespace luminav {

namespace fs = std::filesystem;

std::string version_of(std::string_view text) {
  return fmt::format("{:016x}", static_cast<std::uint64_t>(FileSum().add(text).value()));
}

std::string BuildingFileVersions::read() const {
  return read_whole_file(file_);
}

void BuildingFileVersions::replace(const std::string& text, std::int64_t utime) const {
  write_whole_file(new_name("before", utime), read());
  write_whole_file(file_, text);
}

fs::path BuildingFileVersions::newest_before() const {
  const std::string begins = file_.stem().string() + "-before-";
  fs::path newest;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(fs::absolute(file_).parent_path(), error)) {
    const fs::path& path = entry.path();
    if (path.extension() == ".toml" && path.filename().string().starts_with(begins) && path.stem() > newest.stem()) {
      newest = path;
    }
  }
  return newest;
}

void BuildingFileVersions::undo(std::int64_t utime) const {
  const fs::path before = newest_before();
  const std::string text = read_whole_file(before);
  write_whole_file(new_name("undone", utime), read());
  write_whole_file(file_, text);
  std::error_code error;
  fs::remove(before, error);
}

fs::path BuildingFileVersions::new_name(std::string_view word, std::int64_t utime) const {
  const std::string date = fmt::format("{:%Y-%m-%d-%H%M%S}", fmt::gmtime(static_cast<std::time_t>(utime / 1'000'000)));
  const std::string name = fmt::format("{}-{}-{}", file_.stem().string(), word, date);
  fs::path path = file_.parent_path() / (name + ".toml");
  for (int i = 2; fs::exists(path); ++i) {
    path = file_.parent_path() / fmt::format("{}-{}.toml", name, i);
  }
  return path;
}

BuildingFileVersions::Lock::Lock(const fs::path& file)
    : descriptor_(open(fs::absolute(file).parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (descriptor_ < 0 || flock(descriptor_, LOCK_EX) != 0) {
    if (descriptor_ >= 0) {
      close(descriptor_);
    }
    throw std::runtime_error(file.parent_path().string() + ": cannot be locked");
  }
}

BuildingFileVersions::Lock::~Lock() {
  close(descriptor_);
}

BuildingFileVersions::Draft::Draft(const fs::path& file, const std::string& text)
    : file_(file.parent_path() / ("." + file.filename().string() + ".draft")) {
  write_whole_file(file_, text);
}

BuildingFileVersions::Draft::~Draft() {
  std::error_code error;
  fs::remove(file_, error);
}

}  // namespace luminav
