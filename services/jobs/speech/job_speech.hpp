#pragma once

#include <optional>
#include <string>

#include "services/jobs/job_executor.hpp"

namespace luminav {

enum class SpeechLanguage { kEnglish, kGerman };

/// What the robot says aloud about the job that is under way: where it leads its visitor, what a stop's text says, what
/// it asks. Each thing once, when it comes to be so. A stop's text is spoken as it stands in the file.
class JobSpeech {
 public:
  explicit JobSpeech(SpeechLanguage language) : language_(language) {}

  /// The sentence that is due now; nothing when all has been said.
  std::optional<std::string> next(const JobExecutor& executor);

 private:
  [[nodiscard]] std::string sentence_of(const Job& job, const GuideWatch& guide) const;
  [[nodiscard]] std::string say(const char* english, const char* german, const std::string& place) const;

  SpeechLanguage language_;
  std::string said_;  // last, with the job and the stop that it was said of
};

}  // namespace luminav
