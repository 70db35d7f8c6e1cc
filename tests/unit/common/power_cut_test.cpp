// What a disk keeps of a WholeFile, and so of the software stop, when the power goes between any two of its system
// calls, which the linker leads through here (--wrap). Linux promises only this: a file's bytes are kept once it is
// synced, a name once its folder is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "drivers/base/safety/stop_latch.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

struct Call {
  enum class Kind { kWrite, kSyncFile, kRename, kSyncFolder };
  Kind kind;
  ino_t file = 0;
  std::string bytes{};
};

std::vector<Call> g_calls;

using FileStatus = struct stat;

FileStatus status_of(int descriptor) {
  FileStatus status{};
  fstat(descriptor, &status);
  return status;
}

/// A folder with one name in it.
class Disk {
 public:
  Disk(ino_t file, const std::string& content) : name_{file}, written_{{file, content}}, synced_{{file, content}} {}

  void take(const Call& call) {
    switch (call.kind) {
      case Call::Kind::kWrite:
        written_[call.file] += call.bytes;
        break;
      case Call::Kind::kSyncFile:
        synced_[call.file] = written_[call.file];
        break;
      case Call::Kind::kRename:
        name_.push_back(call.file);
        break;
      case Call::Kind::kSyncFolder:
        name_ = {name_.back()};
        break;
    }
  }

  /// All that may be found under the name when the power goes now.
  [[nodiscard]] std::set<std::string> kept() const {
    std::set<std::string> contents;
    for (const ino_t file : name_) {
      const std::string& all = written_.at(file);
      const std::size_t sure = synced_.contains(file) ? synced_.at(file).size() : 0;
      for (std::size_t size = sure; size <= all.size(); ++size) {
        contents.insert(all.substr(0, size));
      }
    }
    return contents;
  }

 private:
  std::vector<ino_t> name_;  // the files that it may mean, oldest first
  std::map<ino_t, std::string> written_;
  std::map<ino_t, std::string> synced_;
};

/// What is kept after each of the calls of a writing, in turn.
std::vector<std::set<std::string>> cut_everywhere(const std::filesystem::path& file,
                                                  const std::function<void()>& write_anew) {
  FileStatus before{};
  stat(file.c_str(), &before);
  Disk disk(before.st_ino, read_whole_file(file));
  g_calls.clear();
  write_anew();
  std::vector<std::set<std::string>> kept = {disk.kept()};
  for (const Call& call : g_calls) {
    disk.take(call);
    kept.push_back(disk.kept());
  }
  return kept;
}

TEST(PowerCut, LeavesTheOldOrTheNewFileBetweenAnyTwoWrites) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("state", "old");
  const auto kept = cut_everywhere(file, [&] {
    WholeFile whole(file);
    whole.write("the new");
    whole.write(" content");
    whole.finish(Durability::kSynced);
  });
  ASSERT_EQ(kept.size(), 6U) << "two writes, two syncs and a new name";
  for (const std::set<std::string>& contents : kept) {
    for (const std::string& content : contents) {
      EXPECT_TRUE(content == "old" || content == "the new content") << '"' << content << '"';
    }
  }
  EXPECT_EQ(kept.back(), std::set<std::string>{"the new content"}) << "written is written";
}

TEST(PowerCut, LeavesTheBeginningOfTheNewFileAtWorstWhereNoDiskMayHoldUpADrive) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("state", "old");
  for (const auto& contents : cut_everywhere(file, [&] { write_whole_file(file, "new", Durability::kRenamed); })) {
    for (const std::string& content : contents) {
      EXPECT_TRUE(content == "old" || std::string("new").starts_with(content)) << '"' << content << '"';
    }
  }
}

/// Asks for a stop, or for its end, and waits until it is kept.
void request(StopLatch& latch, std::int64_t id, bool engaged) {
  latch.request(id, engaged, "viewer");
  latch.save(0);
  latch.finish_saving();
  EXPECT_EQ(latch.trouble(), "");
}

/// The id of the last request that a driver knows which finds this in its folder; 0 = it cannot read it.
std::int64_t id_kept_in(const std::string& content) {
  const TemporaryFolder folder;
  folder.write("stop", content);
  return StopLatch(folder.path()).id();
}

TEST(PowerCut, LeavesTheLastOrTheNewRequestOfAStop) {
  const TemporaryFolder folder;
  StopLatch latch(folder.path());
  request(latch, 1, true);
  for (const std::int64_t id : {2, 3}) {
    const auto kept = cut_everywhere(folder.path() / "stop", [&] { request(latch, id, id == 3); });
    for (const std::set<std::string>& contents : kept) {
      for (const std::string& content : contents) {
        EXPECT_THAT(id_kept_in(content), testing::AnyOf(id - 1, id)) << '"' << content << '"';
      }
    }
    ASSERT_EQ(kept.back().size(), 1U) << "written is written";
    EXPECT_EQ(id_kept_in(*kept.back().begin()), id);
  }
}

TEST(PowerCut, LeavesTheFoldersThatAreMadeForTheFirstStop) {
  const TemporaryFolder folder;
  StopLatch latch(folder.path() / "state/p3dx");
  g_calls.clear();
  request(latch, 1, true);
  std::set<ino_t> synced;
  for (const Call& call : g_calls) {
    if (call.kind == Call::Kind::kSyncFolder) {
      synced.insert(call.file);
    }
  }
  for (const char* with_a_new_name : {"", "state", "state/p3dx"}) {
    FileStatus status{};
    ASSERT_EQ(stat((folder.path() / with_a_new_name).c_str(), &status), 0);
    EXPECT_TRUE(synced.contains(status.st_ino)) << '"' << with_a_new_name << '"';
  }
}

}  // namespace
}  // namespace luminav

extern "C" {
ssize_t __real_write(int descriptor, const void* bytes, std::size_t count);
int __real_fsync(int descriptor);
int __real_rename(const char* from, const char* to);

ssize_t __wrap_write(int descriptor, const void* bytes, std::size_t count) {
  luminav::g_calls.push_back({luminav::Call::Kind::kWrite, luminav::status_of(descriptor).st_ino,
                              std::string(static_cast<const char*>(bytes), count)});
  return __real_write(descriptor, bytes, count);
}

int __wrap_fsync(int descriptor) {
  const luminav::FileStatus status = luminav::status_of(descriptor);
  luminav::g_calls.push_back(
      {S_ISDIR(status.st_mode) ? luminav::Call::Kind::kSyncFolder : luminav::Call::Kind::kSyncFile, status.st_ino});
  return __real_fsync(descriptor);
}

int __wrap_rename(const char* from, const char* to) {
  luminav::FileStatus status{};
  stat(from, &status);
  luminav::g_calls.push_back({luminav::Call::Kind::kRename, status.st_ino});
  return __real_rename(from, to);
}
}
