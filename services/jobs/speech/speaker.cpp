#include "services/jobs/speech/speaker.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>

namespace luminav {
namespace {

/// What a sentence is to a program that also reads phonemes, in double brackets: letters alone.
std::string plain(std::string sentence) {
  std::replace_if(
      sentence.begin(), sentence.end(),
      [](unsigned char letter) { return letter < ' ' || letter == 0x7f || letter == '[' || letter == ']'; }, ' ');
  return sentence + "\n";
}

/// A file in memory that holds a text, to be read from its begin: unlike a pipe it makes nobody wait, and its reader
/// may go away. -1 = there is none.
int file_with(const std::string& text) {
  const int file = memfd_create("sentence", MFD_CLOEXEC);
  const bool is_whole = file >= 0 && write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (is_whole && lseek(file, 0, SEEK_SET) == 0) {
    return file;
  }
  if (file >= 0) {
    close(file);
  }
  return -1;
}

/// The event loop blocks signals for itself; the program is to have them as usual, and none of our descriptors.
int spawn(const std::vector<std::string>& command, int input, pid_t& child) {
  std::vector<char*> words;
  for (const std::string& word : command) {
    words.push_back(const_cast<char*>(word.c_str()));  // which it does not change: POSIX
  }
  words.push_back(nullptr);
  posix_spawn_file_actions_t actions{};
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
  posix_spawnattr_t attributes{};
  posix_spawnattr_init(&attributes);
  sigset_t signals;
  sigemptyset(&signals);
  posix_spawnattr_setsigmask(&attributes, &signals);
  sigfillset(&signals);
  posix_spawnattr_setsigdefault(&attributes, &signals);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  const int error = posix_spawnp(&child, words.front(), &actions, &attributes, words.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

}  // namespace

Speaker::~Speaker() {
  if (child_ > 0) {
    kill(child_, SIGKILL);
    waitpid(child_, nullptr, 0);
  }
}

void Speaker::say(const std::string& sentence) {
  next_ = is_missing_ ? "" : sentence;
  if (child_ > 0 && !next_.empty()) {
    was_ended_ = true;
    kill(child_, SIGKILL);
  }
}

void Speaker::tick() {
  reap();
  if (child_ == 0 && !next_.empty()) {
    start(std::exchange(next_, ""));
  }
}

void Speaker::reap() {
  int status = 0;
  if (child_ == 0 || waitpid(child_, &status, WNOHANG) != child_) {
    return;
  }
  child_ = 0;
  const bool has_spoken = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  if (!has_spoken && !was_ended_) {
    complain(fmt::format("{} could not speak: is there a sound device?", command_.front()));
  }
}

void Speaker::start(const std::string& sentence) {
  was_ended_ = false;
  const int input = file_with(plain(sentence));
  if (input < 0) {
    complain(fmt::format("nothing is spoken: {}", std::strerror(errno)));
    return;
  }
  pid_t child = 0;
  const int error = spawn(command_, input, child);
  close(input);
  if (error == 0) {
    child_ = child;
    return;
  }
  is_missing_ = error == ENOENT;
  complain(is_missing_
               ? fmt::format("speech is on, but there is no program {}: the robot stays silent", command_.front())
               : fmt::format("{} could not be started: {}", command_.front(), std::strerror(error)));
}

void Speaker::complain(std::string why) {
  if (!std::exchange(has_complained_, true)) {
    complaint_ = std::move(why);
  }
}

std::vector<std::string> espeak_command(const std::string& language) {
  return {"espeak-ng", "-v", language, "-b", "1", "--stdin"};  // -b 1: the text is UTF-8
}

}  // namespace luminav
