#include "services/launcher/deputy/deputy.hpp"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "services/common/process/channels.hpp"
#include "services/launcher/exit_status.hpp"

namespace luminav::launcher {
namespace {

constexpr std::int64_t kInfoPeriod = kSecond;
constexpr std::int64_t kOutputPeriod = 100'000;  // [us]
constexpr std::int64_t kOldestOrders = 60 * kSecond;
constexpr std::size_t kMaxRefused = 32;       // entries, so that strangers cannot fill PM_INFO
constexpr std::size_t kLongestRefused = 256;  // [bytes] of a refused text that is repeated
constexpr std::size_t kMaxCommands = 250;     // PM_INFO has to fit a datagram

/// Signal and time of the orders where they end a process, else those of the deputy's own file. SIGSTOP, say, would
/// freeze a robot's driver together with its guardian. `own` null: the command does not stand there.
void make_sensible(luminav_procman::procman_command_t& command, const Command* own) {
  const int given = command.stop_signal;
  const bool ends = given == SIGINT || given == SIGTERM || given == SIGHUP || given == SIGQUIT;
  if (!ends && !(own != nullptr && own->stop_signal == given)) {
    command.stop_signal = static_cast<std::int8_t>(own != nullptr ? own->stop_signal : SIGINT);
  }
  constexpr float kLongestStop = 10.0F;  // [s]
  const float own_time = own != nullptr ? static_cast<float>(own->stop_time_allowed) : 7.0F;
  if (!std::isfinite(command.stop_time_allowed) || command.stop_time_allowed <= 0.0F) {
    command.stop_time_allowed = own_time;
  }
  command.stop_time_allowed = std::min(command.stop_time_allowed, std::max(own_time, kLongestStop));
}

/// A stranger's text, fit for a terminal and a datagram.
std::string harmless(std::string text) {
  text.resize(std::min(text.size(), kLongestRefused));
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 0x7f; }, '?');
  return text;
}

}  // namespace

Deputy::Deputy(lcm::LCM& lcm, const DeputyConfig& config, ProcessRunner& runner)
    : lcm_(lcm),
      config_(config),
      journal_(config.log_folder, config.log, config.output),
      children_({config.respawn, config.memory_limit, config.environment}, runner, journal_),
      name_(lcm, config.id, config.nonce),
      subscriber_(lcm, config.key) {
  std::erase_if(config_.allowed, [this](const Command& command) { return command.deputy != config_.id; });
  subscriber_.on(channels::kProcmanOrders, &Deputy::on_orders, this);
  subscriber_.on(channels::kProcmanDiscover, &Deputy::on_discovery, this);
}

void Deputy::tick(const Instant& now) {
  now_ = now;
  if (!name_.settled()) {
    name_.tick(now);
    if (!name_.settled()) {
      return;
    }
    children_.note_change();
    journal_.say(now, fmt::format("deputy {} is ready; {}", config_.id,
                                  config_.allow_any ? std::string("runs whatever anybody on this network orders")
                                                    : fmt::format("may run {} commands", config_.allowed.size())));
  }
  children_.tick(now);
  if (children_.take_change() || now.steady - last_info_ >= kInfoPeriod) {
    publish_info();
  }
  publish_output();
}

void Deputy::on_discovery(const luminav_procman::procman_discovery_t&) {
  children_.note_change();  // somebody new: who is here?
}

const Command* Deputy::find_own(const luminav_procman::procman_command_t& command) const {
  const auto own = std::find_if(config_.allowed.begin(), config_.allowed.end(), [&](const Command& allowed) {
    return allowed.name == command.command_id && allowed.exec == command.exec_str;
  });
  return own == config_.allowed.end() ? nullptr : &*own;
}

void Deputy::on_orders(const luminav_procman::procman_orders_t& orders) {
  if (!name_.settled() || shutting_down_ || orders.deputy_id != config_.id) {
    return;
  }
  const std::int64_t age = now_.utime - orders.utime;
  if (age > kOldestOrders) {
    journal_.say_seldom(
        now_, fmt::format("orders of sheriff {} are {} s old and were ignored; are the clocks of both machines right?",
                          harmless(orders.sheriff_id), age / kSecond));
    return;
  }
  if (!lease_.accepts(orders.sheriff_id, now_.steady)) {
    journal_.say_seldom(now_,
                        fmt::format("orders of sheriff {} were ignored: sheriff {} started later and is in command",
                                    harmless(orders.sheriff_id), harmless(lease_.holder())));
    return;
  }
  bool all_allowed = true;
  for (const luminav_procman::procman_command_desired_t& ordered : orders.cmds) {
    if (config_.allow_any || find_own(ordered.cmd) != nullptr) {
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

ManagedCommand* Deputy::list_refused(const luminav_procman::procman_command_t& ordered, const std::string& sheriff_id) {
  auto& commands = children_.commands();
  const std::string id = harmless(ordered.command_id);
  if (const auto found = commands.find(id); found != commands.end()) {
    return &found->second;
  }
  const auto refused = std::count_if(commands.begin(), commands.end(), [](const auto& c) { return c.second.refused; });
  if (static_cast<std::size_t>(refused) >= kMaxRefused) {
    journal_.say_seldom(now_, "more refused commands than are kept; the newest are not listed");
    return nullptr;
  }
  ManagedCommand& command = children_.add(id);
  command.refused = true;
  command.command = ordered;
  command.command.command_id = id;
  command.command.exec_str = harmless(ordered.exec_str);
  command.command.group = harmless(ordered.group);
  make_sensible(command.command, nullptr);
  journal_.say(
      now_, fmt::format("refused command \"{}\" of sheriff {}: `{}` does not stand in this deputy's configuration", id,
                        harmless(sheriff_id), harmless(ordered.exec_str)));
  return &command;
}

void Deputy::refuse(const luminav_procman::procman_command_desired_t& ordered, const std::string& sheriff_id) {
  ManagedCommand* const listed = list_refused(ordered.cmd, sheriff_id);
  if (listed == nullptr) {
    return;
  }
  ManagedCommand& command = *listed;
  const std::string id = harmless(ordered.cmd.command_id);
  if (ordered.force_quit != 0 && !command.refused) {
    stop_whatever_its_words(command, ordered.desired_runid);
    return;
  }
  if (command.running()) {
    journal_.say_seldom(
        now_, fmt::format("refused other words for \"{}\", which goes on: `{}`", id, harmless(ordered.cmd.exec_str)));
    return;
  }
  if (command.actual_runid != ordered.desired_runid || command.exit_code != kRefusedStatus) {
    if (!command.refused) {
      journal_.say_seldom(now_,
                          fmt::format("refused other words for \"{}\": `{}`", id, harmless(ordered.cmd.exec_str)));
    }
    command.actual_runid = command.desired_runid = ordered.desired_runid;
    command.exit_code = kRefusedStatus;
    command.should_run = false;
    command.respawn_at.reset();
    children_.note_change();
  }
}

// To stop is always allowed: the sheriff's file may have been edited since the start.
void Deputy::stop_whatever_its_words(ManagedCommand& command, std::int32_t desired_runid) {
  command.should_run = false;
  command.respawn_at.reset();
  if (command.running()) {
    children_.stop(now_, command);
  } else if (desired_runid != 0 && command.actual_runid != desired_runid) {
    command.actual_runid = desired_runid;
    children_.note_change();
  }
  command.desired_runid = desired_runid;
}

ManagedCommand* Deputy::list_ordered(const std::string& id) {
  auto& commands = children_.commands();
  if (const auto found = commands.find(id); found != commands.end()) {
    return &found->second;
  }
  if (commands.size() >= kMaxCommands) {
    journal_.say_seldom(now_, fmt::format("more than {} commands; \"{}\" was ignored", kMaxCommands, harmless(id)));
    return nullptr;
  }
  ManagedCommand& command = children_.add(id);
  command.log = journal_.open_log(id);
  return &command;
}

void Deputy::obey(const luminav_procman::procman_command_desired_t& ordered) {
  ManagedCommand* const listed = list_ordered(ordered.cmd.command_id);
  if (listed == nullptr) {
    return;
  }
  ManagedCommand& command = *listed;
  command.command = ordered.cmd;
  make_sensible(command.command, find_own(ordered.cmd));
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
      children_.start(now_, command);
      break;
    case OrderStep::kStop:
      children_.stop(now_, command);
      break;
    case OrderStep::kNote:
      if (command.running() && command.stop_sent && !command.kill_sent && !command.too_big) {
        command.stop_sent.reset();  // wanted again before it had to be killed
      }
      if (ordered.desired_runid != 0 && command.actual_runid != ordered.desired_runid) {
        command.actual_runid = ordered.desired_runid;
        children_.note_change();
      }
      break;
  }
}

void Deputy::drop_missing(const luminav_procman::procman_orders_t& orders) {
  std::set<std::string> ordered;
  for (const luminav_procman::procman_command_desired_t& command : orders.cmds) {
    ordered.insert(command.cmd.command_id);
  }
  auto& commands = children_.commands();
  for (auto entry = commands.begin(); entry != commands.end();) {
    ManagedCommand& command = entry->second;
    if (ordered.contains(entry->first)) {
      ++entry;
      continue;
    }
    command.removing = true;
    command.should_run = false;
    command.respawn_at.reset();
    if (command.running()) {
      children_.stop(now_, command);
      ++entry;
    } else {
      entry = commands.erase(entry);
      children_.note_change();
    }
  }
}

void Deputy::publish_info() {
  luminav_procman::procman_deputy_info_t info{};
  info.utime = now_.utime;
  info.deputy_id = config_.id;
  const MachineUsage& machine = children_.machine();
  info.cpu_load = children_.cpu_load();
  info.phys_mem_total_bytes = machine.memory_total;
  info.phys_mem_free_bytes = machine.memory_free;
  info.swap_total_bytes = machine.swap_total;
  info.swap_free_bytes = machine.swap_free;
  for (const auto& [id, command] : children_.commands()) {
    info.cmds.push_back(command.status());
  }
  info.ncmds = static_cast<std::int32_t>(info.cmds.size());
  lcm_.publish(channels::kProcmanInfo, &info);
  last_info_ = now_.steady;
}

void Deputy::publish_output() {
  if (now_.steady - last_output_ < kOutputPeriod) {
    return;
  }
  last_output_ = now_.steady;
  for (luminav_procman::procman_output_t& message : journal_.take_output(now_)) {
    message.utime = now_.utime;
    message.deputy_id = config_.id;
    lcm_.publish(channels::kProcmanOutput, &message);
  }
}

void Deputy::begin_shutdown() {
  shutting_down_ = true;
  children_.stop_all(now_);
}

}  // namespace luminav::launcher
