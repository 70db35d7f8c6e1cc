#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace luminav {

/// Throws std::runtime_error when it cannot be read.
std::string read_whole_file(const std::filesystem::path& file);

/// Says whether the bytes are on the disk when a file counts as written.
enum class Durability {
  kSynced,   // what a person asked for
  kRenamed,  // what a process remembers: whole after its end, and no disk holds up a drive
};

/// A file that is written to its end or not at all. What the name is stays what it is: of a symbolic link the file that
/// it leads to is written; a device, a pipe and whatever is open as standard output are written in place; a file keeps
/// its mode and owner. All else goes to a temporary file beside it that takes its place in `finish`. "-" is standard
/// output. Each throws std::runtime_error when it cannot be written.
class WholeFile {
 public:
  explicit WholeFile(std::filesystem::path file);
  /// Leaves nothing of what was not finished.
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  void write(std::string_view bytes);
  void finish(Durability durability = Durability::kSynced);

 private:
  void open();
  [[noreturn]] void fail() const;

  std::filesystem::path file_;       // as a person named it
  std::filesystem::path target_;     // where its links lead
  std::filesystem::path temporary_;  // "" = in place
  int descriptor_ = -1;
};

/// Writes all of a WholeFile at once.
void write_whole_file(const std::filesystem::path& file, std::string_view bytes,
                      Durability durability = Durability::kSynced);

/// As std::filesystem::create_directories, and what it makes is on the disk: a synced file in it stays where it is.
void make_folders(const std::filesystem::path& folder);

/// Keeps standard output for what is written to "-": all that is printed from now on goes to standard error.
void keep_standard_output_for_files();

/// True for "-" and for what is there but neither a file nor a folder: a device or a pipe.
bool is_written_in_place(const std::filesystem::path& file);

}  // namespace luminav
