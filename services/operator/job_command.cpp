#include "services/operator/job_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "services/common/configuration/configuration_error.hpp"
#include "services/common/network/network_access.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/common/process/interrupts.hpp"
#include "services/operator/job_order.hpp"
#include "services/operator/job_words.hpp"
#include "services/operator/terminal.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kTick = 200'000;  // [us]
constexpr int kNobodyAnswers = 1;
constexpr int kRefused = 3;
constexpr int kFailed = 4;
constexpr int kCancelled = 6;
constexpr int kInterrupted = 130;

struct JobOptions {
  std::vector<std::string> words;
  std::int64_t priority = 0;
  std::string on_timeout = "ask";
  bool waits = false;
  bool as_json = false;
};

std::int8_t read_timeout(const std::string& word) {
  const std::vector<std::string> words{"ask", "give-up", "go-on"};
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end()) {
    throw ConfigurationError("--on-timeout: say ask, give-up or go-on");
  }
  return static_cast<std::int8_t>(found - words.begin());
}

const job_state_t* find_job(const JobListener& listener, std::int64_t id) {
  const auto& jobs = listener.status()->jobs;
  const auto found = std::find_if(jobs.begin(), jobs.end(), [&](const job_state_t& job) { return job.id == id; });
  return found == jobs.end() ? nullptr : &*found;
}

/// Shows how a job gets on until it is over. An interruption leaves it to the service.
int follow(lcm::LCM& lcm, const JobListener& listener, std::int64_t id) {
  ProgressLine line;
  while (!is_interrupted()) {
    const job_state_t* job = find_job(listener, id);
    if (job == nullptr || job->position < 0) {
      line.end();
      fmt::print("{}\n", job == nullptr ? "the job is forgotten" : job->sentence);
      return job == nullptr || job->state == job_state_t::STATE_FAILED ? kFailed
             : job->state == job_state_t::STATE_CANCELLED              ? kCancelled
                                                                       : 0;
    }
    line.show(line_of(*job));
    listen_until(lcm, monotonic_us() + kTick);
  }
  line.end();
  return kInterrupted;
}

int send(lcm::LCM& lcm, const JobListener& listener, const NetworkAccess& access, const JobOptions& options) {
  if (options.priority < 0 || options.priority > 100) {
    throw ConfigurationError("--priority must be 0 to 100");
  }
  job_t request = make_job(options.words, *listener.status());
  request.id = request.utime = new_id();
  request.priority = static_cast<std::int32_t>(options.priority);
  request.on_timeout = read_timeout(options.on_timeout);
  request.sender = fmt::format("terminal:{}", getpid());
  JobOrder order(lcm, request, access.key);
  while (!order.objection() && !order.is_unanswered() && !is_interrupted()) {
    order.tick();
    listen_until(lcm, monotonic_us() + kTick);
  }
  if (!order.objection()) {
    fmt::print("the job service does not take up the request\n");
    return is_interrupted() ? kInterrupted : kNobodyAnswers;
  }
  if (!order.objection()->empty()) {
    fmt::print("{}\n", *order.objection());
    return kRefused;
  }
  const std::int64_t id = request.action == job_t::ACTION_ADD ? order.id() : request.job;
  const job_state_t* job = find_job(listener, id);
  fmt::print("{}\n", job != nullptr ? line_of(*job) : fmt::format("{} is taken", id));
  return options.waits ? follow(lcm, listener, id) : 0;
}

}  // namespace

int run_job(int argc, char** argv) {
  std::string url, robot_file;
  JobOptions options;
  CommandLine line("job", "Gives the robot jobs, lists them, confirms, cancels and answers: docs/jobs.md.");
  line.integer("--priority", options.priority, "0 to 100: the highest first")
      .text("--on-timeout", options.on_timeout, "when nobody loads or unloads: ask | give-up | go-on")
      .flag("--wait", options.waits, "wait until the job is over")
      .flag("--json", options.as_json, "of list: for programs");
  line.lcm_url(url)
      .launched_robot(robot_file)
      .positional("order", options.words,
                  "go (PLACE | X Y [HEADING]) | guide PLACE | carry FROM TO | tour (NAME | PLACE ...) | home | list | "
                  "confirm [JOB] "
                  "[loaded | unloaded | here | wait] | cancel [JOB] | answer [JOB] WORDS",
                  true);
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  const NetworkAccess access = read_network_access(robot_file);
  const auto lcm = open_lcm(access.on(url));
  const JobListener listener(*lcm);
  for (int i = 0; i < 7 && !listener.status() && !is_interrupted(); ++i) {  // it speaks once a second
    listen_until(*lcm, monotonic_us() + kTick);
  }
  if (!listener.status()) {
    throw std::runtime_error("no job service answers: does the process jobs run?");
  }
  if (options.words.front() == "list") {
    fmt::print("{}", options.as_json ? json_of(*listener.status()) + "\n" : page_of(*listener.status()));
    return 0;
  }
  return send(*lcm, listener, access, options);
}

}  // namespace luminav
