#pragma once

#include <future>
#include <optional>
#include <string>

#include "services/surveyor/drive/survey_writing.hpp"
#include "services/surveyor/live/live_survey.hpp"

namespace luminav {

/// What takes seconds of a survey, on a thread of its own so that no message is lost meanwhile: values in, values out.
/// One piece of work at a time.
class SurveyWork {
 public:
  enum class Kind { kEstimate, kWrite };
  struct Result {
    Kind kind = Kind::kEstimate;
    std::optional<LiveEstimate> estimate;
    std::string failure;  // why there is none, in one sentence
  };

  /// What it is at; nothing: it is idle.
  [[nodiscard]] std::optional<Kind> under_way() const;
  /// Estimates a drive so far; to be called while it is idle.
  void estimate(SurveyLog log, const SurveyModel& model);
  /// Writes the building of a drive; likewise.
  void write(SurveyLog log, const SurveyModel& model, const SurveyFiles& files);
  /// What has been done since the last call.
  [[nodiscard]] std::optional<Result> take_result();
  /// Waits until what is under way is done.
  void wait() const;

 private:
  Kind kind_ = Kind::kEstimate;
  std::future<Result> future_;  // its destructor waits for the thread
};

}  // namespace luminav
