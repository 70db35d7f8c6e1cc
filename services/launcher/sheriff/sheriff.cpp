#include "services/launcher/sheriff/sheriff.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <set>

#include "services/common/configuration/toml_table.hpp"
#include "services/common/process/channels.hpp"
#include "services/launcher/deputy/sheriff_lease.hpp"
#include "services/launcher/exit_status.hpp"

namespace luminav::launcher {
namespace {

constexpr std::int64_t kOrdersPeriod = kSecond;
constexpr std::int64_t kDeputySilence = 5 * kSecond;
constexpr std::int64_t kYieldTime = SheriffLease::kLength;

}  // namespace

std::string make_sheriff_id(const Instant& now) {
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  return fmt::format("{}:{}:{}", host.data(), getpid(), now.utime);
}

Sheriff::Sheriff(lcm::LCM& procman, const PmdFile& file, const SheriffConfig& config)
    : procman_(procman), config_(config), orders_(procman, config.key), procman_subscriber_(procman, config.key) {
  for (const Command& command : file.commands) {
    commands_.push_back(std::make_unique<TrackedCommand>(command));
  }
  procman_subscriber_.on(channels::kProcmanInfo, &Sheriff::on_info, this);
  procman_subscriber_.on(channels::kProcmanOrders, &Sheriff::on_orders, this);
  procman_subscriber_.on(channels::kProcmanOutput, &Sheriff::on_output, this);
}

void Sheriff::listen_for_readiness(lcm::LCM& data) {
  data_subscriber_ = std::make_unique<Subscriber>(data);
  data_subscriber_->on(channels::kNodeStatus, &Sheriff::on_node_status, this);
}

TrackedCommand* Sheriff::find(const std::string& deputy, const std::string& name) {
  const auto found = std::find_if(commands_.begin(), commands_.end(), [&](const auto& command) {
    return command->deputy == deputy && command->command.command_id == name;
  });
  return found == commands_.end() ? nullptr : found->get();
}

void Sheriff::on_info(const luminav_procman::procman_deputy_info_t& info) {
  const bool is_new = !deputies_.contains(info.deputy_id);
  Deputy& deputy = deputies_[info.deputy_id];
  if (is_new) {
    notice_(fmt::format("deputy {} is there", info.deputy_id));
  } else if (deputy.silent) {
    notice_(fmt::format("deputy {} is back", info.deputy_id));
    deputy.heard_on.clear();  // perhaps on another host
  }
  deputy.silent = false;
  deputy.heard = now_.steady;
  deputy.clock_ahead = info.utime - now_.utime;
  deputy.cpu_load = info.cpu_load;
  deputy.memory_total = info.phys_mem_total_bytes;
  deputy.memory_free = info.phys_mem_free_bytes;
  check_clock(info.deputy_id, deputy);

  std::map<std::string, const luminav_procman::procman_command_status_t*> listed;
  std::vector<std::string>& refused = refused_[info.deputy_id];
  refused.clear();
  for (const luminav_procman::procman_command_status_t& status : info.cmds) {
    listed[status.cmd.command_id] = &status;
    if (find(info.deputy_id, status.cmd.command_id) != nullptr) {
      continue;
    }
    if (status.pid == 0 && status.exit_code == kRefusedStatus) {
      refused.push_back(status.cmd.command_id);  // some stranger's: forgotten with our next orders
    } else {
      commands_.push_back(std::make_unique<TrackedCommand>(status, info.deputy_id));
    }
  }
  for (const auto& command : commands_) {
    if (command->deputy != info.deputy_id) {
      continue;
    }
    const auto found = listed.find(command->command.command_id);
    const bool is_listed = found != listed.end();
    if (command->update(is_listed ? std::optional(*found->second) : std::nullopt, now_.steady)) {
      deputy.orders_due = true;
    }
  }
  forget_removed();
  locate_commands();
}

void Sheriff::check_clock(const std::string& id, Deputy& deputy) {
  constexpr auto kTolerance = static_cast<std::int64_t>(kClockTolerance * kSecond);
  const bool wrong = std::abs(deputy.clock_ahead) > kTolerance;
  const bool stepped = std::abs(deputy.clock_ahead - deputy.clock_reported.value_or(0)) > kTolerance;
  if (wrong && stepped) {
    notice_(fmt::format("the clock of deputy {} is {:.0f} s {} of this machine's", id,
                        1e-6 * static_cast<double>(std::abs(deputy.clock_ahead)),
                        deputy.clock_ahead > 0 ? "ahead" : "behind"));
  }
  if (!wrong || stepped) {
    deputy.clock_reported = deputy.clock_ahead;
  }
}

void Sheriff::on_orders(const luminav_procman::procman_orders_t& orders) {
  if (orders.sheriff_id == config_.id) {
    return;
  }
  const bool younger = start_of_sheriff(orders.sheriff_id) > start_of_sheriff(config_.id);
  if (!config_.observe && !younger) {
    if (other_sheriff_ != orders.sheriff_id) {
      notice_(fmt::format("sheriff {} commands on this network too; it started earlier and should yield",
                          orders.sheriff_id));
      other_sheriff_ = orders.sheriff_id;
    }
    return;
  }
  if (!config_.observe && !yielding()) {
    notice_(fmt::format("sheriff {} has taken command; this one yields while it is there", orders.sheriff_id));
  }
  if (younger || config_.observe) {
    other_sheriff_ = orders.sheriff_id;
    other_sheriff_heard_ = now_.steady;
  }
  for (const luminav_procman::procman_command_desired_t& ordered : orders.cmds) {
    if (TrackedCommand* command = find(orders.deputy_id, ordered.cmd.command_id)) {
      command->adopt_orders(ordered.desired_runid, ordered.force_quit != 0);
    }
  }
}

void Sheriff::on_output(const luminav_procman::procman_output_t& output) {
  for (std::size_t i = 0; i < output.text.size() && i < output.command_ids.size(); ++i) {
    output_(output.deputy_id, output.command_ids[i], output.text[i]);
  }
}

void Sheriff::on_node_status(const node_status_t& status) {
  if (!std::isfinite(status.cpu_fraction)) {
    data_subscriber_->drop("NODE_STATUS with a share of the processor that is no number");
    return;
  }
  for (const auto& command : commands_) {
    if (command->process == status.process && command->pid() != 0) {
      command->update(status, now_.steady);
      deputies_[command->deputy].heard_on[status.host].insert(status.process);
    }
  }
  locate_commands();
}

// procman's deputies do not say on which host they are. Theirs is the one on which most of their commands speak: a
// leftover of one of them on another host does not speak for it.
void Sheriff::locate_commands() {
  std::map<std::string, std::string> host_of;
  for (const auto& [id, deputy] : deputies_) {
    std::size_t max = 0;
    for (const auto& [host, processes] : deputy.heard_on) {
      if (processes.size() >= max) {
        host_of[id] = processes.size() > max ? host : "";
        max = processes.size();
      }
    }
  }
  for (const auto& command : commands_) {
    command->host = host_of[command->deputy];
    command->has_namesake = std::any_of(commands_.begin(), commands_.end(), [&](const auto& other) {
      const bool is_beside =
          other->deputy == command->deputy || (!command->host.empty() && host_of[other->deputy] == command->host);
      return other != command && is_beside && other->process == command->process && other->pid() != 0;
    });
  }
}

bool Sheriff::is_meant(const TrackedCommand& command, const Target& target) const {
  switch (target.kind) {
    case Target::Kind::kCommand:
      return command.command.command_id == target.name;
    case Target::Kind::kGroup:
      return is_in_group(command.command.group, target.name);
    default:
      return true;
  }
}

std::vector<TrackedCommand*> Sheriff::select(const Target& target) {
  std::vector<TrackedCommand*> selected;
  for (const auto& command : commands_) {
    if (is_meant(*command, target)) {
      selected.push_back(command.get());
    }
  }
  if (selected.empty()) {
    throw ConfigurationError(
        fmt::format("there is no {} in the configuration or at any deputy heard", to_string(target)));
  }
  return selected;
}

bool Sheriff::knows(const Target& target) const {
  return std::any_of(commands_.begin(), commands_.end(),
                     [&](const auto& command) { return is_meant(*command, target); });
}

void Sheriff::mark_due(const TrackedCommand& command) {
  if (const auto deputy = deputies_.find(command.deputy); deputy != deputies_.end()) {
    deputy->second.orders_due = true;
  }
}

void Sheriff::start(const Target& target) {
  const std::vector<TrackedCommand*> selected = select(target);
  const bool any_configured =
      std::any_of(selected.begin(), selected.end(), [](const auto* c) { return c->configured; });
  for (TrackedCommand* command : selected) {
    // one of the same name that was found elsewhere is not what the configuration means
    if (command->configured || !any_configured) {
      command->removing = false;
      command->start();
      mark_due(*command);
    }
  }
}

void Sheriff::stop(const Target& target) {
  for (TrackedCommand* command : select(target)) {
    command->stop();
    mark_due(*command);
  }
}

void Sheriff::restart(const Target& target) {
  for (TrackedCommand* command : select(target)) {
    command->removing = false;
    command->restart();
    mark_due(*command);
  }
}

void Sheriff::remove(const Target& target) {
  for (TrackedCommand* command : select(target)) {
    command->removing = true;
    command->stop();
    mark_due(*command);
  }
}

void Sheriff::forget_removed() {
  std::erase_if(commands_, [this](const auto& command) {
    return command->removing && !command->is_listed() && deputies_.contains(command->deputy);
  });
}

bool Sheriff::yielding() const {
  return !config_.observe && other_sheriff_heard_ != 0 && now_.steady - other_sheriff_heard_ < kYieldTime;
}

bool Sheriff::is_heard(const std::string& id) const {
  const auto deputy = deputies_.find(id);
  return deputy != deputies_.end() && now_.steady - deputy->second.heard < kDeputySilence;
}

bool Sheriff::deputies_heard(const Target& target) const {
  return std::all_of(commands_.begin(), commands_.end(),
                     [&](const auto& command) { return !is_meant(*command, target) || is_heard(command->deputy); });
}

void Sheriff::tick(const Instant& now) {
  now_ = now;
  discover();
  watch_deputies();
  if (config_.observe || yielding()) {
    return;
  }
  for (auto& [id, deputy] : deputies_) {
    if (deputy.orders_due || now_.steady - deputy.ordered >= kOrdersPeriod) {
      send_orders(id, deputy);
    }
  }
}

void Sheriff::discover() {
  const bool someone_missing = deputies_.empty() || !deputies_heard({});
  const bool due = !discovered_ || (someone_missing && now_.steady - *discovered_ >= kOrdersPeriod);
  if (config_.observe || !due) {
    return;
  }
  discovered_ = now_.steady;
  luminav_procman::procman_discovery_t discovery{};
  discovery.utime = now_.utime;
  discovery.transmitter_id = config_.id;
  discovery.nonce = 0;
  procman_.publish(channels::kProcmanDiscover, &discovery);
}

void Sheriff::watch_deputies() {
  for (auto& [id, deputy] : deputies_) {
    if (!deputy.silent && !is_heard(id)) {
      deputy.silent = true;
      notice_(fmt::format("deputy {} has not been heard for {} s", id, kDeputySilence / kSecond));
    }
  }
}

void Sheriff::send_orders(const std::string& id, Deputy& deputy) {
  luminav_procman::procman_orders_t orders{};
  // By the deputy's clock where that is ahead: it must not take fresh orders for old ones.
  orders.utime = now_.utime + std::max<std::int64_t>(0, deputy.clock_ahead);
  orders.deputy_id = id;
  orders.sheriff_id = config_.id;
  for (const auto& command : commands_) {
    if (command->deputy == id && !command->removing) {
      luminav_procman::procman_command_desired_t desired{};
      desired.cmd = command->command;
      desired.desired_runid = command->desired_runid;
      desired.force_quit = command->force_quit ? 1 : 0;
      orders.cmds.push_back(desired);
    }
  }
  orders.ncmds = static_cast<std::int32_t>(orders.cmds.size());
  orders_.publish(channels::kProcmanOrders, orders);
  deputy.ordered = now_.steady;
  deputy.orders_due = false;
}

std::vector<CommandState> Sheriff::states(const Target& target) const {
  std::vector<CommandState> states;
  for (const auto& command : commands_) {
    if (is_meant(*command, target)) {
      states.push_back(command->state(is_heard(command->deputy), now_.steady));
    }
  }
  return states;
}

std::vector<DeputyState> Sheriff::deputies() const {
  std::set<std::string> ids;
  for (const auto& command : commands_) {
    ids.insert(command->deputy);
  }
  for (const auto& [id, deputy] : deputies_) {
    ids.insert(id);
  }
  std::vector<DeputyState> states;
  for (const std::string& id : ids) {
    DeputyState state;
    state.id = id;
    state.heard = is_heard(id);
    if (const auto found = deputies_.find(id); found != deputies_.end()) {
      state.clock_ahead = static_cast<double>(found->second.clock_ahead) * 1e-6;
      state.cpu_load = found->second.cpu_load;
      state.memory_total = found->second.memory_total;
      state.memory_free = found->second.memory_free;
    }
    states.push_back(state);
  }
  return states;
}

bool Sheriff::all_ready(const Target& target) const {
  const std::vector<CommandState> all = states(target);
  return !all.empty() && std::all_of(all.begin(), all.end(),
                                     [](const CommandState& state) { return state.condition == Condition::kReady; });
}

bool Sheriff::all_stopped(const Target& target) const {
  return std::all_of(commands_.begin(), commands_.end(),
                     [&](const auto& command) { return !is_meant(*command, target) || command->is_stopped(); });
}

}  // namespace luminav::launcher
