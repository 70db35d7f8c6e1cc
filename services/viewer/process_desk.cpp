#include "services/viewer/process_desk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "services/viewer/message_json.hpp"

namespace luminav {
namespace {

using launcher::Action;
using launcher::CommandState;
using launcher::Instant;
using launcher::kSecond;
using launcher::ScriptRun;
using launcher::Sheriff;
using launcher::Target;

constexpr std::size_t kMaxPending = 8;
constexpr std::int64_t kPatience = 3 * kSecond;  // deputies answer within a fifth of a second, or say so once a second
constexpr double kTimeLimit = 15.0;              // [s] for a process to be ready or gone

Action::Kind kind_of(ProcessOrder::Action action) {
  switch (action) {
    case ProcessOrder::Action::kStart:
      return Action::Kind::kStart;
    case ProcessOrder::Action::kStop:
      return Action::Kind::kStop;
    case ProcessOrder::Action::kRestart:
      return Action::Kind::kRestart;
  }
  return Action::Kind::kStart;
}

std::string command_json(const CommandState& state) {
  return fmt::format(
      R"({{"name":{},"group":{},"deputy":{},"condition":{},"detail":{},"running":{},"restarts":{},"uptime":{:.0f},)"
      R"("cpu":{:.4f},"memory_bytes":{}}})",
      to_json(state.name), to_json(state.group), to_json(state.deputy), to_json(launcher::to_string(state.condition)),
      to_json(state.detail), state.pid != 0, state.restarts, std::isfinite(state.uptime) ? state.uptime : 0.0,
      state.core_cpu.value_or(0.0), state.memory_bytes);
}

}  // namespace

ProcessDesk::ProcessDesk(lcm::LCM& procman, lcm::LCM& data, std::optional<CommandKey> key)
    : procman_(procman),
      data_(data),
      key_(key),
      watcher_(procman, {}, {.id = make_sheriff_id(Instant::read()), .observe = true, .key = key}) {
  watcher_.listen_for_readiness(data);
}

std::int64_t ProcessDesk::order(const ProcessOrder& order, std::int64_t now) {
  const std::lock_guard lock(mutex_);
  if (known_.empty()) {
    throw RequestError("no deputy was heard: the system was not started by scripts/launch");
  }
  if (std::find(known_.begin(), known_.end(), order.name) == known_.end()) {
    throw RequestError("name: no deputy has a process of that name");
  }
  if (pending_.size() >= kMaxPending) {
    throw RequestError("too many orders are waiting");
  }
  last_id_ = std::max(now, last_id_ + 1);
  pending_.push_back({order, last_id_});
  return last_id_;
}

void ProcessDesk::tick(const Instant& now) {
  watcher_.tick(now);
  {
    const std::lock_guard lock(mutex_);
    known_.clear();
    for (const CommandState& state : watcher_.states()) {
      known_.push_back(state.name);
    }
  }
  if (work_) {
    go_on(now);
  } else {
    begin_next(now);
  }
}

void ProcessDesk::begin_next(const Instant& now) {
  auto work = std::make_unique<Work>();
  {
    const std::lock_guard lock(mutex_);
    if (pending_.empty()) {
      return;
    }
    work->pending = pending_.front();
    pending_.pop_front();
  }
  work->sheriff = std::make_unique<Sheriff>(
      procman_, launcher::PmdFile{}, launcher::SheriffConfig{.id = make_sheriff_id(Instant::read()), .key = key_});
  work->sheriff->listen_for_readiness(data_);
  work->begun = now.steady;
  outcome_ = {work->pending, "waiting", ""};
  work_ = std::move(work);
  work_->sheriff->tick(now);
}

void ProcessDesk::go_on(const Instant& now) {
  Sheriff& sheriff = *work_->sheriff;
  sheriff.tick(now);
  const Target target{Target::Kind::kCommand, work_->pending.order.name};
  if (!work_->run) {
    const bool has_heard_all = sheriff.deputies().size() >= watcher_.deputies().size();
    if (sheriff.knows(target) && has_heard_all && sheriff.deputies_heard({})) {
      Action action;
      action.kind = kind_of(work_->pending.order.action);
      action.target = target;
      action.await =
          action.kind == Action::Kind::kStop ? launcher::AwaitedStatus::kStopped : launcher::AwaitedStatus::kRunning;
      work_->run.emplace(sheriff, action, kTimeLimit);
    } else if (now.steady - work_->begun > kPatience) {
      finish("failed", "its deputy does not answer");
    }
    return;
  }
  const ScriptRun::Progress progress = work_->run->step(now.steady);
  if (progress == ScriptRun::Progress::kSucceeded) {
    finish("done", "");
  } else if (progress == ScriptRun::Progress::kFailed) {
    finish("failed", work_->run->message());
  }
}

void ProcessDesk::finish(const std::string& fate, const std::string& said) {
  outcome_->fate = fate;
  outcome_->said = said;
  work_.reset();
}

std::string ProcessDesk::json() const {
  std::string deputies, commands;
  for (const launcher::DeputyState& deputy : watcher_.deputies()) {
    deputies += fmt::format(R"({}{{"id":{},"heard":{},"cpu":{:.3f}}})", deputies.empty() ? "" : ",", to_json(deputy.id),
                            deputy.heard, std::isfinite(deputy.cpu_load) ? deputy.cpu_load : 0.0);
  }
  for (const CommandState& state : watcher_.states()) {
    commands += (commands.empty() ? "" : ",") + command_json(state);
  }
  std::string order = "null";
  if (outcome_) {
    order = fmt::format(R"({{"id":{},"name":{},"action":"{}","fate":"{}","said":{}}})", outcome_->pending.id,
                        to_json(outcome_->pending.order.name), name_of(outcome_->pending.order.action), outcome_->fate,
                        to_json(outcome_->said));
  }
  return fmt::format(R"({{"deputies":[{}],"commands":[{}],"order":{}}})", deputies, commands, order);
}

}  // namespace luminav
