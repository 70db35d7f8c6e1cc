#include "services/launcher/sheriff/tracked_command.hpp"

#include <fmt/format.h>
#include <signal.h>

#include <limits>

#include "services/launcher/command_words.hpp"
#include "services/launcher/exit_status.hpp"
#include "services/launcher/instant.hpp"

namespace luminav::launcher {
namespace {

constexpr std::int64_t kSilence = 3 * kSecond;    // NODE_STATUS comes once a second
constexpr std::int64_t kUndecided = 6 * kSecond;  // longer than a deputy waits before it restarts something
constexpr std::int64_t kProof = kSecond;          // a foreign program that lived this long is running

std::int32_t next_runid(std::int32_t runid) {
  return runid == std::numeric_limits<std::int32_t>::max() ? 1 : runid + 1;
}

}  // namespace

std::string to_string(Condition condition) {
  switch (condition) {
    case Condition::kStopped:
      return "stopped";
    case Condition::kStarting:
      return "starting";
    case Condition::kReady:
      return "ready";
    case Condition::kDegraded:
      return "degraded";
    case Condition::kFault:
      return "fault";
    case Condition::kSilent:
      return "silent";
    case Condition::kStopping:
      return "stopping";
    case Condition::kRestarting:
      return "restarting";
    case Condition::kFailed:
      return "failed";
    case Condition::kGaveUp:
      return "gave up";
    case Condition::kRefused:
      return "refused";
    default:
      return "unknown";
  }
}

bool is_running(Condition condition) {
  return condition == Condition::kReady || condition == Condition::kDegraded;
}

TrackedCommand::TrackedCommand(const Command& source) : deputy(source.deputy), configured(true) {
  command.command_id = source.name;
  command.exec_str = source.exec;
  command.group = source.group;
  command.auto_respawn = source.auto_respawn ? 1 : 0;
  command.stop_signal = static_cast<std::int8_t>(source.stop_signal);
  command.stop_time_allowed = static_cast<float>(source.stop_time_allowed);
  process = program_name(source.exec);
  announces_itself_ = announces_itself(source.exec);
}

TrackedCommand::TrackedCommand(const luminav_procman::procman_command_status_t& found, std::string its_deputy)
    : command(found.cmd), deputy(std::move(its_deputy)) {
  process = program_name(command.exec_str);
  announces_itself_ = announces_itself(command.exec_str);
}

bool TrackedCommand::update(const std::optional<luminav_procman::procman_command_status_t>& status,
                            std::int64_t steady_now) {
  status_ = status;
  bool orders_due = false;
  if (!adopted_) {
    adopt(steady_now);
    apply(wish_);
    orders_due = wish_ != Wish::kNone;
    wish_ = Wish::kNone;
  }
  if (!status) {
    words_.clear();
    return orders_due;
  }
  note_run(*status, steady_now);
  orders_due = decide(*status, steady_now) || orders_due;
  // What ended by itself shall not run again because its deputy was restarted.
  const bool ended = status->pid == 0 && status->actual_runid == desired_runid && desired_runid != 0;
  const bool for_good =
      command.auto_respawn == 0 || status->exit_code == kGaveUpStatus || status->exit_code == kRefusedStatus;
  if (ended && for_good && !force_quit) {
    force_quit = true;
    orders_due = true;
  }
  return orders_due;
}

void TrackedCommand::adopt(std::int64_t steady_now) {
  adopted_ = true;
  if (!status_ || status_->actual_runid == 0) {
    return;
  }
  desired_runid = status_->actual_runid;
  if (status_->pid != 0) {
    return;
  }
  // Stopped by order, or between a crash and its restart? The deputy's list does not say; time will.
  if (command.auto_respawn != 0) {
    undecided_since_ = steady_now;
  } else {
    force_quit = true;
  }
}

bool TrackedCommand::decide(const luminav_procman::procman_command_status_t& status, std::int64_t steady_now) {
  if (!undecided_since_) {
    return false;
  }
  const bool over = steady_now - *undecided_since_ >= kUndecided;
  if (status.pid != 0 || status.actual_runid != desired_runid || over) {
    undecided_since_.reset();
    force_quit = force_quit || (over && status.pid == 0);
    return over;
  }
  return false;
}

void TrackedCommand::adopt_orders(std::int32_t runid, bool quit) {
  adopted_ = true;
  desired_runid = runid;
  force_quit = quit;
}

void TrackedCommand::note_run(const luminav_procman::procman_command_status_t& status, std::int64_t steady_now) {
  if (status.pid == 0) {
    words_.clear();
    return;
  }
  if (status.pid == last_pid_) {
    return;
  }
  const bool same_run = last_pid_ != 0 && status.actual_runid == last_runid_;
  restarts_ += same_run ? 1 : 0;
  saw_start_ = last_pid_ != 0 || saw_start_;
  last_pid_ = status.pid;
  last_runid_ = status.actual_runid;
  running_since_ = steady_now;
  words_.clear();  // the word of the process before it
}

void TrackedCommand::update(const node_status_t& status, std::int64_t steady_now) {
  if (pid() != 0) {
    words_[status.host] = {status, steady_now};
  }
}

void TrackedCommand::apply(Wish wish) {
  const bool stopped = pid() == 0;
  const bool start_ordered = !force_quit && desired_runid != 0 && (!status_ || status_->actual_runid != desired_runid);
  if (wish == Wish::kRestart || (wish == Wish::kStart && !start_ordered && (stopped || force_quit))) {
    desired_runid = next_runid(desired_runid);
    force_quit = false;
    saw_start_ = true;
  } else if (wish == Wish::kStop) {
    force_quit = true;
  }
}

void TrackedCommand::start() {
  if (adopted_) {
    apply(Wish::kStart);
  } else if (wish_ != Wish::kRestart) {
    wish_ = Wish::kStart;
  }
}

void TrackedCommand::stop() {
  if (adopted_) {
    apply(Wish::kStop);
  } else {
    wish_ = Wish::kStop;
  }
}

void TrackedCommand::restart() {
  if (adopted_) {
    apply(Wish::kRestart);
  } else {
    wish_ = Wish::kRestart;
  }
}

bool TrackedCommand::is_stopped() const {
  const bool start_ordered = status_ && !force_quit && status_->actual_runid != desired_runid;
  return adopted_ && pid() == 0 && !start_ordered && (force_quit || desired_runid == 0 || command.auto_respawn == 0);
}

CommandState TrackedCommand::state(bool deputy_heard, std::int64_t steady_now) const {
  CommandState state;
  state.name = command.command_id;
  state.group = command.group;
  state.deputy = deputy;
  state.condition = condition(deputy_heard, steady_now, state.detail);
  state.restarts = restarts_;
  if (status_) {
    state.pid = status_->pid;
    state.exit_code = status_->exit_code;
    state.machine_cpu = status_->cpu_usage;
    state.memory_bytes = status_->mem_rss_bytes;
    state.finished = status_->pid == 0 && status_->actual_runid != 0 && status_->actual_runid == desired_runid &&
                     command.auto_respawn == 0 && ended_well(status_->exit_code);
  }
  if (state.pid != 0) {
    state.uptime = static_cast<double>(steady_now - running_since_) * 1e-6;
    state.uptime_at_least = !saw_start_;
  }
  if (const Word* own = word(); own != nullptr && !has_namesake) {
    state.core_cpu = own->status.cpu_fraction;
    state.dropped_inputs = own->status.dropped_inputs;
  }
  return state;
}

Condition TrackedCommand::condition(bool deputy_heard, std::int64_t steady_now, std::string& detail) const {
  if (!deputy_heard) {
    detail = fmt::format("deputy {} is not heard", deputy);
    return Condition::kUnknown;
  }
  if (!status_) {
    return wish_ == Wish::kNone && desired_runid == 0 ? Condition::kStopped : Condition::kStarting;
  }
  const bool current = status_->actual_runid == desired_runid;
  if (!current && !force_quit && desired_runid != 0) {
    return status_->pid == 0 ? Condition::kStarting : Condition::kRestarting;
  }
  if (status_->pid == 0) {
    return stopped_condition(detail);
  }
  return force_quit || removing ? Condition::kStopping : running_condition(steady_now, detail);
}

Condition TrackedCommand::running_condition(std::int64_t steady_now, std::string& detail) const {
  if (!announces_itself_ && words_.empty()) {
    return steady_now - running_since_ >= kProof ? Condition::kReady : Condition::kStarting;
  }
  if (detail = why_unknown(); !detail.empty()) {
    return Condition::kUnknown;
  }
  const Word* own = word();
  if (own == nullptr) {
    detail = "runs, not yet ready";
    return Condition::kStarting;
  }
  const std::int64_t silence = steady_now - own->at;
  if (silence > kSilence) {
    detail = fmt::format("no status for {} s", silence / kSecond);
    return Condition::kSilent;
  }
  detail = own->status.reason;
  switch (own->status.state) {
    case node_status_t::STATE_READY:
      return Condition::kReady;
    case node_status_t::STATE_DEGRADED:
      return Condition::kDegraded;
    case node_status_t::STATE_FAULT:
      return Condition::kFault;
    default:
      return Condition::kStarting;
  }
}

const TrackedCommand::Word* TrackedCommand::word() const {
  if (host.empty()) {
    return words_.size() == 1 ? &words_.begin()->second : nullptr;
  }
  const auto own = words_.find(host);
  return own == words_.end() ? nullptr : &own->second;
}

std::string TrackedCommand::why_unknown() const {
  if (has_namesake) {
    return fmt::format("another command of this host calls itself {} too: NODE_STATUS cannot be told apart", process);
  }
  if (!host.empty() || words_.size() < 2) {
    return "";
  }
  return fmt::format("{} says its state on {} and on {}: which one is deputy {}'s is not known", process,
                     words_.begin()->first, words_.rbegin()->first, deputy);
}

Condition TrackedCommand::stopped_condition(std::string& detail) const {
  if (status_->actual_runid == 0) {
    return Condition::kStopped;
  }
  if (status_->exit_code == kRefusedStatus) {
    detail = fmt::format("not in the configuration of deputy {}, or other words there", deputy);
    return Condition::kRefused;
  }
  if (status_->exit_code == kGaveUpStatus) {
    detail = "died too often in a row; see its log";
    return Condition::kGaveUp;
  }
  const bool by_order =
      force_quit && (ended_by_signal(status_->exit_code, SIGINT) || ended_by_signal(status_->exit_code, SIGTERM) ||
                     ended_by_signal(status_->exit_code, SIGKILL));
  // Nobody commands, so nobody says whether it was stopped: our programs end well when they are asked to.
  if (undecided_since_ && (ended_well(status_->exit_code) || ended_by_signal(status_->exit_code, SIGINT) ||
                           ended_by_signal(status_->exit_code, SIGTERM))) {
    return Condition::kStopped;
  }
  if (command.auto_respawn != 0 && !force_quit) {
    detail = describe_exit(status_->exit_code);
    return Condition::kRestarting;
  }
  if (ended_well(status_->exit_code) || by_order) {
    return Condition::kStopped;
  }
  detail = describe_exit(status_->exit_code);
  return Condition::kFailed;
}

}  // namespace luminav::launcher
