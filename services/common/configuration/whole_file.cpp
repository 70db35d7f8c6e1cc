#include "services/common/configuration/whole_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <fstream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

namespace luminav {
namespace {

constexpr const char* kStandardOutput = "-";
int g_standard_output = STDOUT_FILENO;

using FileStatus = struct stat;

std::optional<FileStatus> status_of(const std::filesystem::path& file) {
  FileStatus status{};
  return ::stat(file.c_str(), &status) == 0 ? std::optional(status) : std::nullopt;
}

// Also /dev/stdout of a redirection, which opened anew would begin at its first byte again.
bool is_standard_output(const std::optional<FileStatus>& status) {
  FileStatus output{};
  return status && fstat(g_standard_output, &output) == 0 && output.st_dev == status->st_dev &&
         output.st_ino == status->st_ino;
}

std::filesystem::path follow_links(std::filesystem::path file) {
  constexpr int kMaxLinks = 40;  // as the kernel's
  std::error_code ignored;
  for (int i = 0; i < kMaxLinks && std::filesystem::is_symlink(file, ignored); ++i) {
    file = file.parent_path() / std::filesystem::read_symlink(file, ignored);
  }
  return file;
}

void sync_folder_of(const std::filesystem::path& file) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor >= 0) {
    fsync(descriptor);
    close(descriptor);
  }
}

}  // namespace

std::string read_whole_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream bytes;
  bytes << in.rdbuf();
  if (!in) {
    throw std::runtime_error(file.string() + ": cannot be read");
  }
  return bytes.str();
}

WholeFile::WholeFile(std::filesystem::path file) : file_(std::move(file)) {
  open();
  if (descriptor_ < 0) {
    fail();
  }
}

void WholeFile::open() {
  const std::optional<FileStatus> status = status_of(file_);
  if (file_ == kStandardOutput || is_standard_output(status)) {
    std::fflush(stdout);  // what was printed before comes first
    descriptor_ = fcntl(g_standard_output, F_DUPFD_CLOEXEC, 0);
    return;
  }
  if (status && !S_ISREG(status->st_mode)) {
    descriptor_ = ::open(file_.c_str(), O_WRONLY | O_NOCTTY | O_CLOEXEC);
    return;
  }
  target_ = follow_links(file_);
  if (std::filesystem::is_symlink(target_)) {
    return;  // it leads in a circle
  }
  temporary_ = target_.string() + "." + std::to_string(getpid()) + ".tmp";
  descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666);
  // The mode after the owner, whose change takes set-id bits away.
  if (descriptor_ >= 0 && status &&
      (fchown(descriptor_, status->st_uid, status->st_gid) != 0 || fchmod(descriptor_, status->st_mode & 07777) != 0)) {
    // Somebody else's file that may be written, but not made again: as long as it lasts it is not whole.
    close(descriptor_);
    unlink(temporary_.c_str());
    temporary_.clear();
    descriptor_ = ::open(target_.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC);
  }
}

WholeFile::~WholeFile() {
  if (descriptor_ >= 0) {
    close(descriptor_);
    if (!temporary_.empty()) {
      unlink(temporary_.c_str());
    }
  }
}

void WholeFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno != EINTR) {
      fail();
    }
    bytes.remove_prefix(count < 0 ? 0 : static_cast<std::size_t>(count));
  }
}

void WholeFile::finish(Durability durability) {
  const bool synced = durability == Durability::kSynced;
  if (synced && fsync(descriptor_) != 0 && errno != EINVAL && errno != EROFS) {  // a device or pipe has no disk
    fail();
  }
  if (!temporary_.empty()) {
    if (rename(temporary_.c_str(), target_.c_str()) != 0) {
      fail();
    }
    temporary_.clear();
    if (synced) {
      sync_folder_of(target_);
    }
  }
  if (close(std::exchange(descriptor_, -1)) != 0) {
    fail();
  }
}

void WholeFile::fail() const {
  throw std::runtime_error(file_.string() + ": cannot be written");
}

void write_whole_file(const std::filesystem::path& file, std::string_view bytes, Durability durability) {
  WholeFile whole(file);
  whole.write(bytes);
  whole.finish(durability);
}

void make_folders(const std::filesystem::path& folder) {
  if (!folder.empty() && !std::filesystem::is_directory(folder)) {
    make_folders(folder.parent_path());
    std::filesystem::create_directory(folder);
    sync_folder_of(folder);
  }
}

void keep_standard_output_for_files() {
  if (g_standard_output == STDOUT_FILENO) {
    std::fflush(stdout);
    g_standard_output = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0);
    dup2(STDERR_FILENO, STDOUT_FILENO);
  }
}

bool is_written_in_place(const std::filesystem::path& file) {
  const std::optional<FileStatus> status = status_of(file);
  return file == kStandardOutput || (status && !S_ISREG(status->st_mode) && !S_ISDIR(status->st_mode));
}

}  // namespace luminav
