#pragma once

#include <lcm/lcm-cpp.hpp>
#include <luminav/node_status_t.hpp>
#include <luminav_procman/procman_deputy_info_t.hpp>
#include <luminav_procman/procman_orders_t.hpp>
#include <luminav_procman/procman_output_t.hpp>
#include <memory>
#include <string>
#include <vector>

#include "services/common/process/channels.hpp"
#include "services/common/process/subscriber.hpp"
#include "services/launcher/deputy/deputy.hpp"
#include "services/launcher/sheriff/sheriff.hpp"
#include "tests/node/launcher/fake_runner.hpp"

namespace luminav::launcher {

/// One network in memory, and time that goes on when the test says so.
class LauncherWorld {
 public:
  LauncherWorld() : subscriber_(lcm) {
    subscriber_.on(channels::kProcmanInfo, &LauncherWorld::on_info, this);
    subscriber_.on(channels::kProcmanOrders, &LauncherWorld::on_orders, this);
    subscriber_.on(channels::kProcmanOutput, &LauncherWorld::on_output, this);
  }

  static Command command(const std::string& name, bool auto_respawn = false) {
    Command command;
    command.name = name;
    command.exec = "$LUMINAV_BIN/" + name + " --x";
    command.deputy = "d";
    command.auto_respawn = auto_respawn;
    return command;
  }

  Deputy& add_deputy(const std::vector<Command>& allowed, std::int64_t nonce = 5) {
    DeputyConfig config;
    config.id = "d";
    config.allowed = allowed;
    config.nonce = nonce;
    config.memory_limit = 50'000'000;
    deputies.push_back(std::make_unique<Deputy>(lcm, config, runner));
    return *deputies.back();
  }

  Sheriff& add_sheriff(const PmdFile& file, const std::string& id, bool observe = false) {
    sheriffs.push_back(std::make_unique<Sheriff>(lcm, file, SheriffConfig{.id = id, .observe = observe}));
    sheriffs.back()->listen_for_readiness(lcm);
    return *sheriffs.back();
  }

  void pump() {
    while (lcm.handleTimeout(0) > 0) {
    }
  }

  /// Everybody ticks every 50 ms, and all messages arrive.
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds * 20.0 + 0.5); ++i) {
      now.steady += 50'000;
      now.utime += 50'000;
      for (const auto& deputy : deputies) {
        deputy->tick(now);
      }
      for (const auto& sheriff : sheriffs) {
        sheriff->tick(now);
      }
      pump();
      for (const auto& sheriff : sheriffs) {
        sheriff->tick(now);
      }
      pump();
    }
  }

  void order(const std::string& sheriff_id, const std::vector<luminav_procman::procman_command_desired_t>& commands,
             std::int64_t age = 0) {
    luminav_procman::procman_orders_t orders{};
    orders.utime = now.utime - age;
    orders.deputy_id = "d";
    orders.sheriff_id = sheriff_id;
    orders.cmds = commands;
    orders.ncmds = static_cast<std::int32_t>(commands.size());
    lcm.publish(channels::kProcmanOrders, &orders);
    pump();
  }

  static luminav_procman::procman_command_desired_t desired(const Command& command, int runid,
                                                            bool force_quit = false) {
    luminav_procman::procman_command_desired_t desired{};
    desired.cmd.command_id = command.name;
    desired.cmd.exec_str = command.exec;
    desired.cmd.group = command.group;
    desired.cmd.auto_respawn = command.auto_respawn ? 1 : 0;
    desired.cmd.stop_signal = static_cast<std::int8_t>(command.stop_signal);
    desired.cmd.stop_time_allowed = static_cast<float>(command.stop_time_allowed);
    desired.desired_runid = runid;
    desired.force_quit = force_quit ? 1 : 0;
    return desired;
  }

  void say_ready(const std::string& process, std::int8_t state = node_status_t::STATE_READY,
                 const std::string& host = "") {
    node_status_t status{};
    status.utime = 1;
    status.host = host;
    status.process = process;
    status.state = state;
    lcm.publish(channels::kNodeStatus, &status);
    pump();
  }

  /// What the deputy said last of one command; pid -1 when it does not list it.
  [[nodiscard]] luminav_procman::procman_command_status_t listed(const std::string& name) const {
    for (const auto& status : info.cmds) {
      if (status.cmd.command_id == name) {
        return status;
      }
    }
    luminav_procman::procman_command_status_t missing{};
    missing.pid = -1;
    return missing;
  }

  lcm::LCM lcm{"memq://"};
  FakeRunner runner;
  Instant now{.steady = 1'000'000'000, .utime = 1'700'000'000'000'000};
  std::vector<std::unique_ptr<Deputy>> deputies;
  std::vector<std::unique_ptr<Sheriff>> sheriffs;
  luminav_procman::procman_deputy_info_t info{};
  int infos = 0;
  int orders_heard = 0;
  std::string last_sheriff;
  std::string output;  // all of PM_OUTPUT

 private:
  void on_info(const luminav_procman::procman_deputy_info_t& message) {
    info = message;
    ++infos;
  }
  void on_orders(const luminav_procman::procman_orders_t& message) {
    ++orders_heard;
    last_sheriff = message.sheriff_id;
  }
  void on_output(const luminav_procman::procman_output_t& message) {
    for (const std::string& text : message.text) {
      output += text;
    }
  }
  Subscriber subscriber_;
};

}  // namespace luminav::launcher
