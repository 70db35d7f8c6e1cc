#include "services/jobs/speech/job_speech.hpp"

#include <fmt/format.h>

namespace luminav {

std::optional<std::string> JobSpeech::next(const JobExecutor& executor) {
  const Job* job = executor.active();
  std::string sentence = job == nullptr ? "" : sentence_of(*job, executor.guide());
  if (sentence.empty()) {
    return std::nullopt;
  }
  std::string said = fmt::format("{} {} {}", job->id, job->stop, sentence);
  if (said == said_) {
    return std::nullopt;
  }
  said_ = std::move(said);
  return sentence;
}

std::string JobSpeech::say(const char* english, const char* german, const std::string& place) const {
  return fmt::format(fmt::runtime(language_ == SpeechLanguage::kGerman ? german : english), place);
}

std::string JobSpeech::sentence_of(const Job& job, const GuideWatch& guide) const {
  const JobStop& stop = job.stops[job.stop];
  const std::string place = name_of(stop);
  const bool guides = job.kind == JobKind::kGuide;
  switch (job.state) {
    case JobState::kDriving:
      if (!guides || job.goal_id == 0) {
        return "";
      }
      if (guide.leads()) {
        return say("Please follow me to {}.", "Bitte folgen Sie mir zu {}.", place);
      }
      return guide.stands() ? say("I am waiting for you.", "Ich warte auf Sie.", place) : "";
    case JobState::kAtStop:
      if (stop.confirm == "loaded") {
        return say("This is {}. Please load me, and say on the page that I am loaded.",
                   "Das ist {}. Bitte beladen Sie mich und melden Sie das auf der Seite.", place);
      }
      if (stop.confirm == "unloaded") {
        return say("This is {}. Please unload me, and say on the page that I am unloaded.",
                   "Das ist {}. Bitte entladen Sie mich und melden Sie das auf der Seite.", place);
      }
      return guides ? say("Here we are: {}.", "Wir sind da: {}.", place) : stop.text;
    case JobState::kAsking:  // its own words are English; who speaks another language reads them on the page
      return language_ == SpeechLanguage::kGerman
                 ? say("", "Ich brauche Hilfe auf dem Weg zu {}. Meine Frage steht auf der Seite.", place)
                 : fmt::format("I need help. {}.", job.question->text);
    default:
      return "";
  }
}

}  // namespace luminav
