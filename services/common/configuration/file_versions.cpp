#include "services/common/configuration/file_versions.hpp"

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

std::optional<std::pair<fs::file_time_type, std::uintmax_t>> FileVersions::stamp() const {
  std::error_code error;
  const fs::file_time_type time = fs::last_write_time(file_, error);
  const std::uintmax_t size = error ? 0 : fs::file_size(file_, error);
  return error ? std::nullopt : std::optional(std::pair(time, size));
}

std::string FileVersions::read() const {
  return read_whole_file(file_);
}

fs::path FileVersions::replace(const std::string& text, std::int64_t utime) const {
  fs::path kept = new_name("before", utime);
  write_whole_file(kept, read());
  write_whole_file(file_, text);
  return kept;
}

fs::path FileVersions::newest_before() const {
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

void FileVersions::undo(std::int64_t utime) const {
  const fs::path before = newest_before();
  const std::string text = read_whole_file(before);
  write_whole_file(new_name("undone", utime), read());
  write_whole_file(file_, text);
  std::error_code error;
  fs::remove(before, error);
}

fs::path FileVersions::new_name(std::string_view word, std::int64_t utime) const {
  const std::string date = fmt::format("{:%Y-%m-%d-%H%M%S}", fmt::gmtime(static_cast<std::time_t>(utime / 1'000'000)));
  const std::string name = fmt::format("{}-{}-{}", file_.stem().string(), word, date);
  fs::path path = file_.parent_path() / (name + ".toml");
  for (int i = 2; fs::exists(path); ++i) {
    path = file_.parent_path() / fmt::format("{}-{}.toml", name, i);
  }
  return path;
}

FileVersions::Lock::Lock(const fs::path& file)
    : descriptor_(open(fs::absolute(file).parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (descriptor_ < 0 || flock(descriptor_, LOCK_EX) != 0) {
    if (descriptor_ >= 0) {
      close(descriptor_);
    }
    throw std::runtime_error(file.parent_path().string() + ": cannot be locked");
  }
}

FileVersions::Lock::~Lock() {
  close(descriptor_);
}

FileVersions::Draft::Draft(const fs::path& file, const std::string& text)
    : file_(file.parent_path() / ("." + file.filename().string() + ".draft")) {
  write_whole_file(file_, text);
}

FileVersions::Draft::~Draft() {
  std::error_code error;
  fs::remove(file_, error);
}

}  // namespace luminav
