#include "services/launcher/deputy/deputy.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "services/common/process/channels.hpp"
#include "services/launcher/exit_status.hpp"

namespace luminav::launcher {
namespace {

constexpr std::int64_t kIntroductionPeriod = 200'000;  // [us]
constexpr std::int64_t kIntroductionTime = 500'000;    // [us] as long as procman listens for another of its name
constexpr std::int64_t kInfoPeriod = kSecond;
constexpr std::int64_t kOutputPeriod = 100'000;  // [us]
constexpr std::int64_t kOldestOrders = 60 * kSecond;
constexpr double kLongestShutdown = 5.0;      // [s] that a child has to end when the deputy ends
constexpr std::size_t kMostRefused = 32;      // entries, so that strangers cannot fill PM_INFO
constexpr std::size_t kLongestRefused = 256;  // [bytes] of a refused text that is repeated
constexpr std::size_t kMostCommands = 250;    // PM_INFO has to fit a datagram

std::string time_of_day(std::int64_t utime) {
  return fmt::format("{:%Y-%m-%d %H:%M:%S}", fmt::localtime(static_cast<std::time_t>(utime / kSecond)));
}

/// Signal and time of the orders, or procman's standard where they make no sense.
void make_sensible(procman::procman_command_t& command) {
  if (command.stop_signal < 1 || command.stop_signal > 64) {
    command.stop_signal = SIGINT;
  }
  if (!std::isfinite(command.stop_time_allowed) || command.stop_time_allowed <= 0.0F) {
    command.stop_time_allowed = 7.0F;
  }
  command.stop_time_allowed = std::min(command.stop_time_allowed, 3600.0F);
}

/// A stranger's text, fit for a terminal and a datagram.
std::string harmless(std::string text) {
  text.resize(std::min(text.size(), kLongestRefused));
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c >= 0 && (c < ' ' || c == 0x7f); }, '?');
  return text;
}

}  // namespace

Deputy::Deputy(lcm::LCM& lcm, const DeputyConfig& config, ProcessRunner& runner)
    : lcm_(lcm),
      config_(config),
      runner_(runner),
      subscriber_(lcm),
      info_subscriber_(std::make_unique<Subscriber>(lcm)),
      output_(config.output) {
  std::erase_if(config_.allowed, [this](const Command& command) { return command.deputy != config_.id; });
  RespawnPolicy checked(config_.respawn);
  if (!config_.log_folder.empty()) {
    log_ = std::make_unique<RotatingLog>(config_.log_folder / "deputy.log", config_.log);
  }
  machine_ = runner_.machine();
  subscriber_.on(channels::kProcmanOrders, &Deputy::on_orders, this);
  subscriber_.on(channels::kProcmanDiscover, &Deputy::on_discovery, this);
  info_subscriber_->on(channels::kProcmanInfo, &Deputy::on_info, this);
}

void Deputy::tick(const Instant& now) {
  now_ = now;
  if (conflict_) {
    return;
  }
  if (!introduced_) {
    introduce();
    return;
  }
  collect_children();
  run_timers();
  measure();
  if (changed_ || now_.steady - last_info_ >= kInfoPeriod) {
    publish_info();
  }
  publish_output();
}

void Deputy::introduce() {
  if (!begun_) {
    begun_ = now_.steady;
    last_introduction_ = now_.steady - kIntroductionPeriod;
  }
  if (now_.steady - *begun_ >= kIntroductionTime) {
    introduced_ = true;
    info_subscriber_.reset();
    changed_ = true;
    say(fmt::format("deputy {} is ready; {}", config_.id,
                    config_.allow_any ? std::string("runs whatever anybody on this network orders")
                                      : fmt::format("may run {} commands", config_.allowed.size())));
    return;
  }
  if (now_.steady - last_introduction_ >= kIntroductionPeriod) {
    last_introduction_ = now_.steady;
    procman::procman_discovery_t discovery{};
    discovery.utime = now_.utime;
    discovery.transmitter_id = config_.id;
    discovery.nonce = config_.nonce;
    lcm_.publish(channels::kProcmanDiscover, &discovery);
  }
}

void Deputy::on_discovery(const procman::procman_discovery_t& discovery) {
  if (introduced_) {
    changed_ = true;
    return;
  }
  // Of two that start at the same moment the one with the lower number stays.
  if (discovery.transmitter_id == config_.id && discovery.nonce != 0 && discovery.nonce < config_.nonce) {
    conflict_ =
        fmt::format("another deputy named {} is starting on this network; give one of them another --id", config_.id);
  }
}

void Deputy::on_info(const procman::procman_deputy_info_t& info) {
  if (!introduced_ && info.deputy_id == config_.id) {
    conflict_ =
        fmt::format("a deputy named {} is running on this network already; give one of them another --id", config_.id);
  }
}

bool Deputy::is_allowed(const procman::procman_command_t& command) const {
  return config_.allow_any || std::any_of(config_.allowed.begin(), config_.allowed.end(), [&](const Command& allowed) {
           return allowed.name == command.command_id && allowed.exec == command.exec_str;
         });
}

void Deputy::on_orders(const procman::procman_orders_t& orders) {
  if (!introduced_ || shutting_down_ || orders.deputy_id != config_.id) {
    return;
  }
  const std::int64_t age = now_.utime - orders.utime;
  if (age > kOldestOrders) {
    say_seldom(fmt::format("orders of sheriff {} are {} s old and were ignored; are the clocks of both machines right?",
                           harmless(orders.sheriff_id), age / kSecond));
    return;
  }
  if (!lease_.accepts(orders.sheriff_id, now_.steady)) {
    say_seldom(fmt::format("orders of sheriff {} were ignored: sheriff {} started later and is in command",
                           harmless(orders.sheriff_id), harmless(lease_.holder())));
    return;
  }
  bool all_allowed = true;
  for (const procman::procman_command_desired_t& ordered : orders.cmds) {
    if (is_allowed(ordered.cmd)) {
      obey(ordered);
    } else {
      all_allowed = false;
      refuse(ordered, orders.sheriff_id);
    }
  }
  // Orders that hold an invented command are not trusted to say what to remove.
  if (all_allowed) {
    drop_missing(orders);
  }
}

void Deputy::refuse(const procman::procman_command_desired_t& ordered, const std::string& sheriff_id) {
  const std::string id = harmless(ordered.cmd.command_id);
  auto found = commands_.find(id);
  if (found == commands_.end()) {
    const auto refused =
        std::count_if(commands_.begin(), commands_.end(), [](const auto& c) { return c.second.refused; });
    if (static_cast<std::size_t>(refused) >= kMostRefused) {
      say_seldom("more refused commands than are kept; the newest are not listed");
      return;
    }
    found = commands_.emplace(id, ManagedCommand(config_.respawn)).first;
    found->second.refused = true;
    found->second.command = ordered.cmd;
    found->second.command.command_id = id;
    found->second.command.exec_str = harmless(ordered.cmd.exec_str);
    found->second.command.group = harmless(ordered.cmd.group);
    make_sensible(found->second.command);
    say(fmt::format("refused command \"{}\" of sheriff {}: `{}` does not stand in this deputy's configuration", id,
                    harmless(sheriff_id), harmless(ordered.cmd.exec_str)));
    changed_ = true;
  }
  ManagedCommand& command = found->second;
  if (command.running()) {
    say_seldom(fmt::format("refused other words for \"{}\", which goes on: `{}`", id, harmless(ordered.cmd.exec_str)));
    return;
  }
  if (command.actual_runid != ordered.desired_runid || command.exit_code != kRefusedStatus) {
    if (!command.refused) {
      say_seldom(fmt::format("refused other words for \"{}\": `{}`", id, harmless(ordered.cmd.exec_str)));
    }
    command.actual_runid = command.desired_runid = ordered.desired_runid;
    command.exit_code = kRefusedStatus;
    command.should_run = false;
    command.respawn_at.reset();
    changed_ = true;
  }
}

void Deputy::obey(const procman::procman_command_desired_t& ordered) {
  const std::string& id = ordered.cmd.command_id;
  auto found = commands_.find(id);
  if (found == commands_.end()) {
    if (commands_.size() >= kMostCommands) {
      say_seldom(fmt::format("more than {} commands; \"{}\" was ignored", kMostCommands, harmless(id)));
      return;
    }
    found = commands_.emplace(id, ManagedCommand(config_.respawn)).first;
    if (!config_.log_folder.empty()) {
      found->second.log = std::make_unique<RotatingLog>(config_.log_folder / log_file_name(id), config_.log);
    }
    changed_ = true;
  }
  ManagedCommand& command = found->second;
  command.command = ordered.cmd;
  make_sensible(command.command);
  command.refused = false;
  command.removing = false;
  command.should_run = ordered.force_quit == 0;
  command.desired_runid = ordered.desired_runid;
  if (!command.should_run) {
    command.respawn_at.reset();
  }
  switch (step_for(command.running(), command.actual_runid, ordered.desired_runid, ordered.force_quit != 0)) {
    case OrderStep::kStart:
      command.respawn.reset();
      start(command);
      break;
    case OrderStep::kStop:
      stop_step(command);
      break;
    case OrderStep::kNote:
      if (command.running() && command.stop_sent && !command.kill_sent && !command.too_big) {
        command.stop_sent.reset();  // wanted again before it had to be killed
      }
      if (ordered.desired_runid != 0 && command.actual_runid != ordered.desired_runid) {
        command.actual_runid = ordered.desired_runid;
        changed_ = true;
      }
      break;
  }
}

void Deputy::drop_missing(const procman::procman_orders_t& orders) {
  std::set<std::string> ordered;
  for (const procman::procman_command_desired_t& command : orders.cmds) {
    ordered.insert(command.cmd.command_id);
  }
  for (auto entry = commands_.begin(); entry != commands_.end();) {
    ManagedCommand& command = entry->second;
    if (ordered.contains(entry->first)) {
      ++entry;
      continue;
    }
    command.removing = true;
    command.should_run = false;
    command.respawn_at.reset();
    if (command.running()) {
      stop_step(command);
      ++entry;
    } else {
      entry = commands_.erase(entry);
      changed_ = true;
    }
  }
}

void Deputy::start(ManagedCommand& command) {
  command.actual_runid = command.desired_runid;
  command.stop_sent.reset();
  command.kill_sent = false;
  command.too_big = false;
  command.respawn_at.reset();
  command.usage = {};
  command.cpu_usage = 0.0F;
  changed_ = true;
  const std::string& id = command.command.command_id;
  try {
    const CommandWords words = split_command(command.command.exec_str, config_.environment);
    for (const std::string& name : words.unset) {
      say(fmt::format("\"{}\": the variable {} is not set and stays as written", id, name));
    }
    command.pid = runner_.start(words);
    command.started = now_.steady;
    command.exit_code = 0;
    if (command.log) {
      command.log->write(fmt::format("--- {} started, pid {}: {}\n", time_of_day(now_.utime), command.pid,
                                     fmt::join(words.words, " ")));
    }
  } catch (const std::exception& error) {
    command.exit_code = 255 << 8;
    say(fmt::format("\"{}\" cannot be started: {}", id, error.what()));
  }
}

void Deputy::stop_step(ManagedCommand& command) {
  if (!command.stop_sent) {
    command.stop_sent = now_.steady;
    command.kill_sent = false;
    runner_.signal(command.pid, command.command.stop_signal);
    changed_ = true;
    return;
  }
  const double allowed = shutting_down_ ? std::min<double>(kLongestShutdown, command.command.stop_time_allowed)
                                        : command.command.stop_time_allowed;
  if (static_cast<double>(now_.steady - *command.stop_sent) >= allowed * 1e6) {
    if (!command.kill_sent) {
      say(fmt::format("\"{}\" did not end within {:.1f} s and is killed", command.command.command_id, allowed));
    }
    command.kill_sent = true;
    runner_.signal(command.pid, SIGKILL);
  }
}

void Deputy::collect_children() {
  const auto name_of = [this](int pid) {
    return std::find_if(commands_.begin(), commands_.end(), [pid](const auto& c) { return c.second.pid == pid; });
  };
  const auto take_output = [&] {
    for (const ProcessOutput& printed : runner_.take_output()) {
      const auto command = name_of(printed.pid);
      if (command == commands_.end()) {
        continue;
      }
      output_.add(command->first, printed.text, now_.steady);
      if (command->second.log && !command->second.log->write(printed.text) && !log_failed_) {
        log_failed_ = true;
        say(fmt::format("cannot write {}; is the disk full?", command->second.log->file().string()));
      }
    }
  };
  take_output();
  const std::vector<ProcessExit> exits = runner_.take_exits();
  take_output();  // last words
  for (const ProcessExit& ended : exits) {
    if (const auto command = name_of(ended.pid); command != commands_.end()) {
      on_exit(command->second, ended.status);
      if (command->second.removing && !command->second.running()) {
        commands_.erase(command);
      }
    }
  }
}

void Deputy::on_exit(ManagedCommand& command, int status) {
  const std::string& id = command.command.command_id;
  const bool by_order = command.stop_sent.has_value();
  const std::int64_t lived = now_.steady - command.started;
  const std::string what = describe_exit(status);
  command.pid = 0;
  command.exit_code = status;
  command.stop_sent.reset();
  command.kill_sent = false;
  changed_ = true;
  if (command.log) {
    command.log->write(fmt::format("--- {} ended: {}\n", time_of_day(now_.utime), what));
  }
  if (shutting_down_ || command.removing || !command.should_run) {
    return;
  }
  if (command.actual_runid != command.desired_runid) {
    start(command);  // a restart is one step: the orders for the new run are here already
    return;
  }
  if (!by_order) {
    say(fmt::format("\"{}\" ended by itself after {:.1f} s: {}", id, static_cast<double>(lived) * 1e-6, what));
  }
  if (command.command.auto_respawn == 0) {
    return;
  }
  if (const std::optional<std::int64_t> delay = command.respawn.delay_after(lived)) {
    command.respawn_at = now_.steady + *delay;
  } else {
    command.exit_code = kGaveUpStatus;
    say(fmt::format("\"{}\" died {} times in a row and stays stopped until it is started again; the last time: {}", id,
                    command.respawn.deaths_in_a_row() + 1, what));
  }
}

void Deputy::run_timers() {
  for (auto& [id, command] : commands_) {
    if (command.running() && command.stop_sent) {
      stop_step(command);
    } else if (command.respawn_at && now_.steady >= *command.respawn_at) {
      start(command);
    }
  }
}

void Deputy::measure() {
  const std::int64_t interval = now_.steady - last_measurement_;
  if (interval < kInfoPeriod) {
    return;
  }
  const double available = static_cast<double>(interval) * runner_.processors();
  for (auto& [id, command] : commands_) {
    if (!command.running()) {
      continue;
    }
    const ProcessUsage usage = runner_.usage(command.pid);
    const bool first = command.usage.cpu == 0;
    const auto used = static_cast<double>(usage.cpu - command.usage.cpu);
    command.cpu_usage = first ? 0.0F : static_cast<float>(std::clamp(used / available, 0.0, 1.0));
    command.usage = usage;
    end_if_too_big(command);
  }
  const MachineUsage machine = runner_.machine();
  const auto total = static_cast<double>(machine.cpu_total - machine_.cpu_total);
  cpu_load_ =
      total > 0 ? static_cast<float>(static_cast<double>(machine.cpu_busy - machine_.cpu_busy) / total) : cpu_load_;
  machine_ = machine;
  last_measurement_ = now_.steady;
}

void Deputy::end_if_too_big(ManagedCommand& command) {
  if (config_.memory_limit <= 0 || command.usage.resident_bytes <= config_.memory_limit || command.stop_sent) {
    return;
  }
  say(fmt::format("\"{}\" uses {} MB, more than the {} MB allowed, and is ended", command.command.command_id,
                  command.usage.resident_bytes / 1'000'000, config_.memory_limit / 1'000'000));
  command.too_big = true;
  stop_step(command);
}

void Deputy::publish_info() {
  procman::procman_deputy_info_t info{};
  info.utime = now_.utime;
  info.deputy_id = config_.id;
  info.cpu_load = cpu_load_;
  info.phys_mem_total_bytes = machine_.memory_total;
  info.phys_mem_free_bytes = machine_.memory_free;
  info.swap_total_bytes = machine_.swap_total;
  info.swap_free_bytes = machine_.swap_free;
  for (const auto& [id, command] : commands_) {
    info.cmds.push_back(command.status());
  }
  info.ncmds = static_cast<std::int32_t>(info.cmds.size());
  lcm_.publish(channels::kProcmanInfo, &info);
  last_info_ = now_.steady;
  changed_ = false;
}

void Deputy::publish_output() {
  if (now_.steady - last_output_ < kOutputPeriod) {
    return;
  }
  last_output_ = now_.steady;
  for (procman::procman_output_t& message : output_.take(now_.steady)) {
    message.utime = now_.utime;
    message.deputy_id = config_.id;
    lcm_.publish(channels::kProcmanOutput, &message);
  }
}

void Deputy::begin_shutdown() {
  shutting_down_ = true;
  for (auto& [id, command] : commands_) {
    command.should_run = false;
    command.respawn_at.reset();
    if (command.running() && !command.stop_sent) {
      stop_step(command);
    }
  }
}

bool Deputy::all_stopped() const {
  return std::none_of(commands_.begin(), commands_.end(), [](const auto& c) { return c.second.running(); });
}

void Deputy::say(const std::string& sentence) {
  output_.add("", sentence + "\n", now_.steady);
  if (log_) {
    log_->write(fmt::format("{} {}\n", time_of_day(now_.utime), sentence));
  }
  notice_(sentence);
}

void Deputy::say_seldom(const std::string& sentence) {
  constexpr std::int64_t kPause = kSecond;
  if (now_.steady - last_seldom_at_ < kPause && last_seldom_at_ != 0) {
    return;
  }
  last_seldom_at_ = now_.steady;
  say(sentence);
}

}  // namespace luminav::launcher
