#include "services/jobs/storage/job_store.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "services/common/configuration/configuration_error.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/common/geometry/seconds.hpp"

namespace luminav {
namespace {

using Json = nlohmann::json;

constexpr const char* kFormat = "luminav jobs 1";
constexpr double kFresh = 120.0;  // [s] since the table was kept last: its people still stand beside the robot

Json json_of(const JobStop& stop) {
  return {{"place", stop.place},         {"x", stop.pose.x},    {"y", stop.pose.y},  {"theta", stop.pose.theta},
          {"has_theta", stop.has_theta}, {"pause", stop.pause}, {"text", stop.text}, {"photo", stop.photo},
          {"confirm", stop.confirm}};
}

JobStop stop_from(const Json& json) {
  JobStop stop;
  stop.place = json.at("place");
  stop.pose = {json.at("x"), json.at("y"), json.at("theta")};
  stop.has_theta = json.at("has_theta");
  stop.pause = json.at("pause");
  stop.text = json.at("text");
  stop.photo = json.value("photo", false);  // a table of a version before photos has none
  stop.confirm = json.at("confirm");
  return stop;
}

/// The sentence of a job that is under way changes all the time, and is said anew anyway.
Json json_of(const Job& job) {
  Json stops = Json::array();
  for (const JobStop& stop : job.stops) {
    stops.push_back(json_of(stop));
  }
  Json json = {{"id", job.id},
               {"kind", static_cast<int>(job.kind)},
               {"priority", job.priority},
               {"on_timeout", static_cast<int>(job.on_timeout)},
               {"tour", job.tour},
               {"sender", job.sender},
               {"stops", stops},
               {"state", static_cast<int>(job.state)},
               {"stop", job.stop},
               {"goal_id", job.goal_id},
               {"tries", job.tries},
               {"sentence", job.is_over() ? job.sentence : ""}};
  if (job.question) {
    json["question"] = {{"text", job.question->text}, {"answers", job.question->answers}};
  }
  return json;
}

template <typename Enum>
Enum enum_from(const Json& json, Enum last) {
  const int value = json;
  if (value < 0 || value > static_cast<int>(last)) {
    throw std::runtime_error("a number stands for nothing");
  }
  return static_cast<Enum>(value);
}

Job job_from(const Json& json) {
  Job job;
  job.id = json.at("id");
  job.kind = enum_from(json.at("kind"), JobKind::kGuide);
  job.priority = json.at("priority");
  job.on_timeout = enum_from(json.at("on_timeout"), TimeoutPolicy::kGoOn);
  job.tour = json.at("tour");
  job.sender = json.at("sender");
  for (const Json& stop : json.at("stops")) {
    job.stops.push_back(stop_from(stop));
  }
  job.state = enum_from(json.at("state"), JobState::kCancelled);
  job.stop = json.at("stop");
  job.goal_id = json.at("goal_id");
  job.tries = json.at("tries");
  job.sentence = json.at("sentence");
  if (json.contains("question")) {
    job.question = Question{json.at("question").at("text"), json.at("question").at("answers")};
    if (!job.is_over()) {
      job.sentence = job.question->text;
    }
  }
  if (job.stop >= job.stops.size() || job.question.has_value() != (job.state == JobState::kAsking)) {
    throw std::runtime_error("a job contradicts itself");
  }
  return job;
}

std::string text_of(const StoredJobs& stored) {
  Json json = {{"format", kFormat},
               {"boot", stored.kept.boot},
               {"building", stored.kept.building},
               {"utime", stored.kept.utime},
               {"ended", stored.kept.ended},
               {"active", stored.table.active},
               {"open_goal", stored.table.open_goal},
               {"toured", stored.table.toured},
               {"jobs", Json::array()},
               {"echoes", Json::array()}};
  for (const Job& job : stored.table.jobs) {
    json["jobs"].push_back(json_of(job));
  }
  for (const RequestEcho& echo : stored.table.echoes) {
    json["echoes"].push_back({echo.id, echo.objection});
  }
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

StoredJobs jobs_from(const Json& json) {
  if (json.at("format") != kFormat) {
    throw std::runtime_error("it is of another version");
  }
  StoredJobs stored;
  stored.kept = {json.at("boot"), json.at("building"), json.at("utime"), json.at("ended")};
  stored.table.active = json.at("active");
  stored.table.open_goal = json.at("open_goal");
  stored.table.toured = json.at("toured").get<std::map<std::string, int>>();
  for (const Json& job : json.at("jobs")) {
    stored.table.jobs.push_back(job_from(job));
  }
  for (const Json& echo : json.at("echoes")) {
    stored.table.echoes.push_back({echo.at(0), echo.at(1)});
  }
  return stored;
}

}  // namespace

std::string objection_to_going_on(const JobCircumstances& kept, const JobCircumstances& now) {
  if (kept.building != now.building) {
    return fmt::format("and is of building \"{}\", this is \"{}\"", kept.building, now.building);
  }
  if (kept.boot.empty() || kept.boot != now.boot) {
    return "and the machine was started anew since";
  }
  const double age = seconds_between(kept.utime, now.utime);
  if (age < 0.0) {
    return "and the robot's clock went back since";
  }
  if (age > kFresh) {
    return fmt::format("{:.0f} min ago", age / 60.0);
  }
  return kept.ended ? "the job service ended in order" : "";
}

JobStore::JobStore(const std::filesystem::path& folder) : file_(folder.empty() ? folder : folder / "jobs.json") {}

void JobStore::keep(const StoredJobs& stored) {
  std::string text = text_of(stored);
  if (file_.empty() || text == kept_) {
    return;
  }
  std::filesystem::create_directories(file_.parent_path());
  write_whole_file(file_, text, Durability::kSynced);
  kept_ = std::move(text);
}

std::optional<StoredJobs> JobStore::recall() const {
  if (file_.empty() || !std::filesystem::exists(file_)) {
    return std::nullopt;
  }
  try {
    return jobs_from(Json::parse(read_whole_file(file_)));
  } catch (const std::exception& error) {
    throw ConfigurationError(
        fmt::format("{}: the table of jobs cannot be read: {}; move the file away to begin with none", file_.string(),
                    error.what()));
  }
}

}  // namespace luminav
