#pragma once

#include <sys/types.h>

#include <string>
#include <utility>
#include <vector>

namespace luminav {

/// Speaks by a program that reads a sentence from its standard input, as espeak-ng does: one sentence at a time, and
/// the newest wins, also over the one that is being spoken. Waits for nothing. Where there is no such program it is
/// silent.
class Speaker {
 public:
  /// `command`: the program, looked for in $PATH, and its arguments. No shell reads them, nor the sentences.
  explicit Speaker(std::vector<std::string> command) : command_(std::move(command)) {}
  /// Ends what is being spoken.
  ~Speaker();
  Speaker(const Speaker&) = delete;
  Speaker& operator=(const Speaker&) = delete;

  void say(const std::string& sentence);
  /// Looks after the program; to be called several times a second.
  void tick();
  [[nodiscard]] bool is_busy() const { return child_ > 0 || !next_.empty(); }
  /// Why nothing is heard, in one sentence, and once; "" = nothing to say.
  std::string take_complaint() { return std::exchange(complaint_, ""); }

 private:
  void start(const std::string& sentence);
  void reap();
  void complain(std::string why);

  std::vector<std::string> command_;
  std::string next_;
  pid_t child_ = 0;  // 0 = none
  bool was_ended_ = false;
  bool has_complained_ = false;
  bool is_missing_ = false;  // the program
  std::string complaint_;
};

/// The command that speaks in a language of espeak-ng's, such as "en".
std::vector<std::string> espeak_command(const std::string& language);

}  // namespace luminav
