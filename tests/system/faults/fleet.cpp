#include "tests/system/faults/fleet.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <array>
#include <stdexcept>

#include "services/common/process/channels.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/common/process/interrupts.hpp"
#include "services/launcher/sheriff/script_run.hpp"
#include "services/launcher/sheriff/session.hpp"

namespace luminav {
namespace {

void replace(std::string& text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  if (at != std::string::npos) {
    text.replace(at, what.size(), by);
  }
}

launcher::PmdFile plan_commands(const FleetPlan& plan) {
  launcher::PmdFile file = launcher::read_pmd(std::filesystem::path(LUMINAV_SOURCE_DIR) / "launch/demo.pmd");
  std::erase_if(file.commands, [](const launcher::Command& command) {
    return command.group == "viewer" || command.group == "recording";
  });
  for (launcher::Command& command : file.commands) {
    const auto place = plan.placed.find(command.name);
    command.deputy = place != plan.placed.end() ? place->second : "robot";
    if (plan.pty) {
      replace(command.exec, "--port $LUMINAV_SIMULATOR_PORT", "--pty-link $LUMINAV_LINE");
      replace(command.exec, "tcp:127.0.0.1:$LUMINAV_SIMULATOR_PORT", "$LUMINAV_LINE");
    }
    if (command.name == "camera" && !plan.image_url.empty()) {
      command.exec += " --image-url " + plan.image_url;
    }
    const auto words = plan.preload.find(command.name);
    command.exec = words != plan.preload.end() ? words->second + " " + command.exec : command.exec;
  }
  return file;
}

}  // namespace

Fleet::Fleet(FleetPlan plan) : plan_(std::move(plan)), commands_(plan_commands(plan_)) {
  const InsideHost inside(plan_.network);
  lcm_ = open_lcm(plan_.lcm_url);
  lcm_->getFileno();  // makes the receiving socket, here and now
  procman_ = open_lcm(plan_.procman_url);
  procman_->getFileno();
  subscriber_ = std::make_unique<Subscriber>(*lcm_);
  subscriber_->on(channels::kNodeStatus, &Fleet::on_node_status, this);
  make_sheriff();
}

Fleet::~Fleet() {
  for (auto& [id, host] : hosts_) {
    host->stop();
  }
}

void Fleet::make_sheriff() {
  sheriff_.reset();
  sheriff_ = std::make_unique<launcher::Sheriff>(
      *procman_, commands_,
      launcher::SheriffConfig{
          .id = launcher::make_sheriff_id(launcher::Instant::read()),
          .key = plan_.key_file.empty() ? std::nullopt : std::optional(read_command_key(plan_.key_file))});
  sheriff_->report_notices([this](const std::string& notice) { notices_.push_back(notice); });
  sheriff_->listen_for_readiness(*lcm_);
}

TestHost& Fleet::add_host(const std::string& id, const NetworkHost* network,
                          std::map<std::string, std::string> environment, int memory_limit) {
  environment.try_emplace("LUMINAV_BIN", LUMINAV_PROGRAMS);
  if (!plan_.key_file.empty()) {
    environment.try_emplace("LUMINAV_KEY", plan_.key_file.string());
  }
  environment.try_emplace("LUMINAV_SCENARIO", plan_.scenario.file.string());
  environment.try_emplace("LUMINAV_ROBOT", plan_.scenario.robot_file.string());
  environment.try_emplace("LUMINAV_BUILDING", plan_.scenario.building_file.string());
  environment.try_emplace("LUMINAV_SEED", std::to_string(plan_.scenario.seed));
  environment.try_emplace("LUMINAV_SIMULATOR_PORT", "8101");
  environment.try_emplace("LUMINAV_LCM_URL", plan_.lcm_url);
  environment.try_emplace("LUMINAV_LINE", (plan_.folder / "robot-line").string());
  auto& host = hosts_[id];
  host = std::make_unique<TestHost>(
      TestHost::Setup{id, network, plan_.folder / id, plan_.procman_url, std::move(environment), memory_limit},
      commands_);
  host->start();
  return *host;
}

void Fleet::pump(int milliseconds) {
  std::array<pollfd, 2> descriptors{{{lcm_->getFileno(), POLLIN, 0}, {procman_->getFileno(), POLLIN, 0}}};
  ::poll(descriptors.data(), descriptors.size(), milliseconds);
  for (lcm::LCM* lcm : {lcm_.get(), procman_.get()}) {
    while (lcm->handleTimeout(0) > 0) {
    }
  }
  sheriff_->tick(launcher::Instant::read());
  for (const launcher::CommandState& state : sheriff_->states()) {
    auto& [pid, since] = started_[state.name];
    if (state.pid != pid) {
      pid = state.pid;
      since = clock_.utime();
    }
  }
  if (take_interrupt()) {
    throw Interrupted();
  }
}

bool Fleet::pump_until(const std::function<bool()>& done, double seconds) {
  const std::int64_t end = launcher::Instant::read().steady + static_cast<std::int64_t>(seconds * 1e6);
  while (!done()) {
    if (launcher::Instant::read().steady >= end) {
      return false;
    }
    pump();
  }
  return true;
}

void Fleet::pump_for(double seconds) {
  pump_until([] { return false; }, seconds);
}

bool Fleet::run_script(const std::string& name, double time_limit) {
  launcher::ScriptRun script(*sheriff_, commands_, name, time_limit);
  auto progress = launcher::ScriptRun::Progress::kGoingOn;
  while ((progress = script.step(launcher::Instant::read().steady)) == launcher::ScriptRun::Progress::kGoingOn) {
    pump();
  }
  failure_ = progress == launcher::ScriptRun::Progress::kFailed ? script.message() : "";
  return failure_.empty();
}

bool Fleet::move(const std::string& process, const std::string& host) {
  const launcher::Target target{launcher::Target::Kind::kCommand, process};
  sheriff_->stop(target);
  if (!pump_until([&] { return sheriff_->all_stopped(target); }, 10.0)) {
    failure_ = fmt::format("{} did not stop", process);
    return false;
  }
  for (launcher::Command& command : commands_.commands) {
    command.deputy = command.name == process ? host : command.deputy;
  }
  make_sheriff();
  const std::int64_t begun = clock_.utime();
  sheriff_->start(target);
  if (!pump_until([&] { return heard_after(process, begun).has_value(); }, 10.0)) {
    failure_ = fmt::format("{} did not start on {}", process, host);
    return false;
  }
  return true;
}

void Fleet::replace_sheriff() {
  make_sheriff();
}

pid_t Fleet::pid(const std::string& process) const {
  for (const launcher::CommandState& state : sheriff_->states()) {
    if (state.name == process && state.pid > 0) {
      return state.pid;
    }
  }
  return 0;
}

std::int64_t Fleet::started(const std::string& process) const {
  const auto found = started_.find(process);
  return found != started_.end() && found->second.first > 0 ? found->second.second : 0;
}

std::vector<std::string> Fleet::processes() const {
  std::vector<std::string> names;
  for (const launcher::Command& command : commands_.commands) {
    names.push_back(command.name);
  }
  return names;
}

std::optional<std::int64_t> Fleet::heard_after(const std::string& process, std::int64_t utime) const {
  const auto found = heard_.find(process);
  if (found != heard_.end()) {
    for (const std::int64_t moment : found->second) {
      if (moment > utime) {
        return moment;
      }
    }
  }
  return std::nullopt;
}

void Fleet::on_node_status(const node_status_t& status) {
  statuses_[status.process] = status;
  if (status.state == node_status_t::STATE_READY || status.state == node_status_t::STATE_DEGRADED) {
    std::vector<std::int64_t>& moments = heard_[status.process];
    moments.push_back(clock_.utime());
    if (moments.size() > 100) {
      moments.erase(moments.begin());
    }
  }
}

}  // namespace luminav
