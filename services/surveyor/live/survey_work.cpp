#include "services/surveyor/live/survey_work.hpp"

#include <chrono>
#include <exception>
#include <utility>

#include "services/surveyor/live/live_ground.hpp"

namespace luminav {
namespace {

/// What a thread throws would else be thrown where nobody expects it.
template <typename Work>
SurveyWork::Result result_of(SurveyWork::Kind kind, const Work& work) {
  SurveyWork::Result result;
  result.kind = kind;
  try {
    result.estimate = work();
  } catch (const std::exception& error) {
    result.failure = error.what();
  }
  return result;
}

}  // namespace

std::optional<SurveyWork::Kind> SurveyWork::under_way() const {
  return future_.valid() ? std::optional(kind_) : std::nullopt;
}

void SurveyWork::estimate(SurveyLog log, const SurveyModel& model) {
  kind_ = Kind::kEstimate;
  future_ = std::async(std::launch::async, [log = std::move(log), model] {
    return result_of(Kind::kEstimate, [&] {
      LiveEstimate estimate = estimate_so_far(log, model);
      draw(estimate, log, model);
      return estimate;
    });
  });
}

void SurveyWork::write(SurveyLog log, const SurveyModel& model, const SurveyFiles& files) {
  kind_ = Kind::kWrite;
  future_ = std::async(std::launch::async, [log = std::move(log), model, files] {
    return result_of(Kind::kWrite, [&] { return live_estimate(write_survey(log, model, files).survey, log, model); });
  });
}

std::optional<SurveyWork::Result> SurveyWork::take_result() {
  if (!future_.valid() || future_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
    return std::nullopt;
  }
  return future_.get();
}

void SurveyWork::wait() const {
  if (future_.valid()) {
    future_.wait();
  }
}

}  // namespace luminav
