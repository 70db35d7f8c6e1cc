#include "services/operator/job_words.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "services/common/configuration/configuration_error.hpp"
#include "services/common/geometry/angle.hpp"
#include "services/operator/goal_target.hpp"

namespace luminav {
namespace {

using Words = std::vector<std::string>;

constexpr std::array kKinds{"go", "carry", "tour", "home", "guide"};
constexpr std::array kStates{"queued", "driving", "at a stop", "asking", "done", "failed", "cancelled"};

template <std::size_t N>
std::string name_in(const std::array<const char*, N>& names, int index) {
  return index >= 0 && static_cast<std::size_t>(index) < N ? names[static_cast<std::size_t>(index)]
                                                           : fmt::format("{}", index);
}

bool is_number(const std::string& word) {
  return !word.empty() && std::all_of(word.begin(), word.end(), [](char c) { return c >= '0' && c <= '9'; });
}

job_stop_t place_stop(const std::string& place) {
  job_stop_t stop{};
  stop.place = place;
  return stop;
}

job_stop_t read_stop(const Words& words) {
  const auto numbers = read_point(words);
  if (!numbers) {
    return place_stop(fmt::format("{}", fmt::join(words, " ")));
  }
  if (numbers->size() != 2 && numbers->size() != 3) {
    throw ConfigurationError("a point has two numbers, X and Y, and perhaps a heading, in radians or as 90deg");
  }
  job_stop_t stop{};
  stop.x = (*numbers)[0];
  stop.y = (*numbers)[1];
  stop.has_theta = numbers->size() == 3;
  stop.theta = stop.has_theta ? wrap_angle((*numbers)[2]) : 0.0;
  return stop;
}

/// The job a person means: by the end of its number, or the only one that can be meant.
std::int64_t job_meant(Words& words, const job_status_t& status, const std::function<bool(const job_state_t&)>& can_be,
                       const char* what) {
  Words candidates;
  std::int64_t id = 0;
  const std::string number = !words.empty() && is_number(words.front()) ? words.front() : "";
  for (const job_state_t& job : status.jobs) {
    if (number.empty() ? can_be(job) : std::to_string(job.id).ends_with(number)) {
      candidates.push_back(std::to_string(job.id));
      id = job.id;
    }
  }
  if (candidates.size() != 1) {
    throw ConfigurationError(candidates.empty()
                                 ? (number.empty() ? fmt::format("no job {}", what) : "no job has that number")
                                 : fmt::format("which job? {}", fmt::join(candidates, ", ")));
  }
  if (!number.empty()) {
    words.erase(words.begin());
  }
  return id;
}

void add_stops(job_t& request, const Words& words, const job_status_t& status) {
  const auto& tours = status.tours;
  switch (request.kind) {
    case job_t::KIND_GO:
    case job_t::KIND_GUIDE:
      request.stops.push_back(read_stop(words));
      break;
    case job_t::KIND_TOUR:
      if (words.size() == 1 && std::find(tours.begin(), tours.end(), words[0]) != tours.end()) {
        request.tour = words[0];
        break;
      }
      [[fallthrough]];
    default:
      std::transform(words.begin(), words.end(), std::back_inserter(request.stops), place_stop);
  }
  request.count = static_cast<std::int32_t>(request.stops.size());
}

}  // namespace

job_t make_job(const Words& words, const job_status_t& status) {
  const std::string order = words.empty() ? "" : words.front();
  Words rest(words.begin() + (words.empty() ? 0 : 1), words.end());
  job_t request{};
  if (const auto kind = std::find(kKinds.begin(), kKinds.end(), order); kind != kKinds.end()) {
    request.action = job_t::ACTION_ADD;
    request.kind = static_cast<std::int8_t>(kind - kKinds.begin());
    if (rest.empty() != (request.kind == job_t::KIND_HOME)) {
      throw ConfigurationError(fmt::format("{} {}", order, rest.empty() ? "where?" : "has no places"));
    }
    add_stops(request, rest, status);
    return request;
  }
  const auto is_under_way = [](const job_state_t& job) { return job.position >= 0; };
  const auto waits = [](const job_state_t& job) {
    return !job.waits_for.empty() || (job.kind == job_t::KIND_GUIDE && job.state == job_state_t::STATE_DRIVING);
  };
  const auto asks = [](const job_state_t& job) { return job.state == job_state_t::STATE_ASKING; };
  if (order == "confirm") {
    request.action = job_t::ACTION_CONFIRM;
    request.job = job_meant(rest, status, waits, "waits for a word");
  } else if (order == "cancel") {
    request.action = job_t::ACTION_CANCEL;
    request.job = job_meant(rest, status, is_under_way, "is to be done");
  } else if (order == "answer") {
    request.action = job_t::ACTION_ANSWER;
    request.job = job_meant(rest, status, asks, "asks anything");
  } else {
    throw ConfigurationError("say go, guide, carry, tour, home, list, confirm, cancel or answer");
  }
  request.word = fmt::format("{}", fmt::join(rest, " "));
  return request;
}

std::string line_of(const job_state_t& job) {
  std::string line =
      fmt::format("{} {} to {}: {}", job.id, name_in(kKinds, job.kind), fmt::join(job.stops, ", "), job.sentence);
  if (job.answer_count > 0) {
    line += fmt::format(" ({})", fmt::join(job.answers, " | "));
  }
  return line;
}

std::string page_of(const job_status_t& status) {
  std::string page;
  for (const job_state_t& job : status.jobs) {
    const std::string place = job.position < 0 ? "-" : job.position == 0 ? "now" : fmt::format("{}", job.position);
    page += fmt::format("{:>3}  {:<9}  {}\n", place, name_in(kStates, job.state), line_of(job));
  }
  if (page.empty()) {
    page = "no jobs\n";
  }
  if (!status.tours.empty()) {
    page += fmt::format("tours: {}\n", fmt::join(status.tours, ", "));
  }
  return page;
}

std::string json_of(const job_status_t& status) {
  nlohmann::json jobs = nlohmann::json::array();
  for (const job_state_t& job : status.jobs) {
    jobs.push_back({{"id", job.id},
                    {"kind", name_in(kKinds, job.kind)},
                    {"state", name_in(kStates, job.state)},
                    {"position", job.position},
                    {"priority", job.priority},
                    {"stops", job.stops},
                    {"stop", job.stop},
                    {"sentence", job.sentence},
                    {"waits_for", job.waits_for},
                    {"question", job.question},
                    {"answers", job.answers}});
  }
  return nlohmann::json({{"jobs", jobs}, {"tours", status.tours}})
      .dump(1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace luminav
