#include "services/launcher/sheriff/script_run.hpp"

#include <fmt/format.h>

#include "services/common/configuration/toml_table.hpp"
#include "services/launcher/instant.hpp"

namespace luminav::launcher {
namespace {

bool has_status(const CommandState& state, AwaitedStatus awaited) {
  return awaited == AwaitedStatus::kRunning && (is_running(state.condition) || state.finished);
}

bool has_failed(const CommandState& state) {
  return state.condition == Condition::kFailed || state.condition == Condition::kGaveUp ||
         state.condition == Condition::kRefused;
}

std::string describe(const CommandState& state) {
  return state.detail.empty() ? fmt::format("{}: {}", state.name, to_string(state.condition))
                              : fmt::format("{}: {} ({})", state.name, to_string(state.condition), state.detail);
}

}  // namespace

ScriptRun::ScriptRun(Sheriff& sheriff, const PmdFile& file, const std::string& name, double time_limit)
    : sheriff_(sheriff), time_limit_(static_cast<std::int64_t>(time_limit * 1e6)) {
  const Script* script = file.find_script(name);
  if (script == nullptr) {
    throw ConfigurationError(fmt::format("{}: has no script \"{}\"", file.file, name));
  }
  append(file, *script);
}

ScriptRun::ScriptRun(Sheriff& sheriff, const Action& action, double time_limit)
    : sheriff_(sheriff), actions_{action}, time_limit_(static_cast<std::int64_t>(time_limit * 1e6)) {}

void ScriptRun::append(const PmdFile& file, const Script& script) {
  for (const Action& action : script.actions) {
    if (action.kind == Action::Kind::kRunScript) {
      append(file, *file.find_script(action.script));
    } else {
      actions_.push_back(action);
    }
  }
}

ScriptRun::Progress ScriptRun::step(std::int64_t steady_now) {
  while (next_ < actions_.size()) {
    const Action& action = actions_[next_];
    if (!begun_) {
      begin(action, steady_now);
    }
    const Progress progress = wait(action, steady_now);
    if (progress != Progress::kSucceeded) {
      return progress;
    }
    ++next_;
    begun_.reset();
  }
  message_.clear();
  return Progress::kSucceeded;
}

void ScriptRun::begin(const Action& action, std::int64_t steady_now) {
  begun_ = steady_now;
  switch (action.kind) {
    case Action::Kind::kStart:
      sheriff_.start(action.target);
      started_.push_back(action.target);
      break;
    case Action::Kind::kStop:
      sheriff_.stop(action.target);
      break;
    case Action::Kind::kRestart:
      sheriff_.restart(action.target);
      started_.push_back(action.target);
      break;
    default:
      break;
  }
}

ScriptRun::Progress ScriptRun::wait(const Action& action, std::int64_t steady_now) {
  if (action.kind == Action::Kind::kWaitTime) {
    const bool over = static_cast<double>(steady_now - *begun_) >= action.seconds * 1e6;
    message_ = fmt::format("waits {} s", action.seconds);
    return over ? Progress::kSucceeded : Progress::kGoingOn;
  }
  return action.await ? wait_for_status(action, steady_now) : Progress::kSucceeded;
}

ScriptRun::Progress ScriptRun::wait_for_status(const Action& action, std::int64_t steady_now) {
  if (*action.await == AwaitedStatus::kStopped && sheriff_.all_stopped(action.target)) {
    return Progress::kSucceeded;
  }
  const std::string goal = fmt::format("{} {}", to_string(action.target),
                                       *action.await == AwaitedStatus::kRunning ? "to be ready" : "to be stopped");
  std::string missing;
  bool any_failed = false;
  for (const CommandState& state : sheriff_.states(action.target)) {
    const bool stopped =
        *action.await == AwaitedStatus::kStopped && state.pid == 0 && state.condition != Condition::kUnknown;
    if (!has_status(state, *action.await) && !stopped) {
      missing += (missing.empty() ? "" : "; ") + describe(state);
    }
    any_failed = any_failed || (*action.await == AwaitedStatus::kRunning && has_failed(state));
  }
  if (*action.await == AwaitedStatus::kRunning && missing.empty()) {
    return Progress::kSucceeded;
  }
  if (any_failed) {
    message_ = fmt::format("waited for {}, which cannot be: {}", goal, missing);
    return Progress::kFailed;
  }
  if (steady_now - *begun_ >= time_limit_) {
    message_ = fmt::format("waited {} s for {}: {}", static_cast<double>(time_limit_) * 1e-6, goal, missing);
    return Progress::kFailed;
  }
  message_ = fmt::format("waits for {}: {}", goal, missing);
  return Progress::kGoingOn;
}

}  // namespace luminav::launcher
