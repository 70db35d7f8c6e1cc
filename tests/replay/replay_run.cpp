#include "tests/replay/replay_run.hpp"

#include <fmt/format.h>

#include <chrono>
#include <ctime>
#include <luminav/odometry_t.hpp>
#include <map>

#include "services/common/log/log_message.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/lcm_conversions.hpp"
#include "tests/replay/log_reading/message_schema.hpp"
#include "tests/replay/replay_inputs.hpp"
#include "tests/replay/replay_nodes.hpp"
#include "tests/replay/replay_tracks.hpp"
#include "tests/replay/replay_verdict.hpp"

namespace luminav {
namespace {

using SteadyClock = std::chrono::steady_clock;

double since(SteadyClock::time_point start) {
  return std::chrono::duration<double>(SteadyClock::now() - start).count();
}

/// Of this thread [s]: what the replay would take on a core of its own.
double cpu_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

class Replay {
 public:
  explicit Replay(const ReplayOptions& options)
      : options_(options),
        chosen_(nodes_for(options)),
        nodes_({options.robot_file, options.building_file, chosen_, options.localizer_seed, options.camera_shift,
                options.utc_offset}),
        writer_(options.out_file) {
    report_.nodes = chosen_;
    nodes_.lcm().subscribe(".*", &Replay::on_message, this);
  }

  ReplayReport run() {
    if (!options_.against_file.empty()) {
      read_reference();
    }
    if (options_.answers_file.empty()) {
      run_nodes();
    } else {
      read_answers();
    }
    report_.sha256 = writer_.finish();
    report_.dropped = nodes_.dropped();
    report_.has_poses = chosen_.contains("localizer");
    tracks_.conclude(options_.tolerances.position);
    append_verdict(options_.tolerances, report_);
    return std::move(report_);
  }

 private:
  void run_nodes() {
    LogReader log(options_.log_file);
    std::set<std::string> wanted = nodes_.inputs();
    wanted.insert(nodes_.outputs().begin(), nodes_.outputs().end());
    wanted.insert(channels::kSimTruth);
    log.load_only(std::move(wanted));
    start_ = SteadyClock::now();
    const double cpu_start = cpu_time();
    std::vector<LogEvent> batch;
    LogEvent event;
    while (log.next(event)) {
      if (!batch.empty() && batch.front().utime != event.utime) {
        feed(batch);
        batch.clear();
        progress(log);
      }
      report_.first_utime = report_.first_utime == 0 ? event.utime : report_.first_utime;
      batch.push_back(std::move(event));
    }
    feed(batch);
    report_.log_s = static_cast<double>(now_ - report_.first_utime) * 1e-6;
    report_.wall_s = since(start_);
    report_.cpu_s = cpu_time() - cpu_start;
    report_.log_damage = log.damage();
    if (options_.show_progress) {
      fmt::print(stderr, "\r\033[K");
    }
  }

  /// What processes answered while somebody else played the log to them.
  void read_answers() {
    std::map<std::int64_t, Pose2> odometry;
    LogReader log(options_.log_file);
    LogEvent event;
    while (log.next(event)) {
      now_ = event.utime;
      report_.first_utime = report_.first_utime == 0 ? event.utime : report_.first_utime;
      if (event.channel == channels::kSimTruth) {
        tracks_.add_truth(event);
      } else if (event.channel == channels::kOdometry) {
        if (const auto message = decoded<odometry_t>(event.data)) {
          odometry[message->utime] = odom_from_robot(*message);
        }
      } else if (options_.against_file.empty() && nodes_.outputs().contains(event.channel)) {
        tracks_.add_recorded(std::move(event));
      }
    }
    report_.log_s = static_cast<double>(now_ - report_.first_utime) * 1e-6;
    LogReader answers(options_.answers_file);
    while (answers.next(event)) {
      if (!nodes_.outputs().contains(event.channel)) {
        continue;
      }
      // they were received today: their own stamp tells where in the drive they belong
      event.utime = MessageSchemas::built_in().integer(event.data, "utime").value_or(now_);
      if (const auto at = odometry.find(event.utime); at != odometry.end()) {
        tracks_.set_odometry(at->second);
      }
      writer_.write(event.utime, event.channel, event.data.data(), event.data.size());
      take_answer(std::move(event));
    }
    report_.log_damage = answers.damage();
  }

  void feed(std::vector<LogEvent>& batch) {
    for (LogEvent& event : batch) {
      now_ = event.utime;
      if (event.channel == channels::kSimTruth) {
        tracks_.add_truth(event);
      }
      if (nodes_.outputs().contains(event.channel)) {
        if (options_.against_file.empty()) {
          tracks_.add_recorded(std::move(event));
        }
      } else if (nodes_.inputs().contains(event.channel)) {
        publish(event);
      } else if (options_.keep_inputs && event.channel == channels::kSimTruth) {
        writer_.write(event.utime, event.channel, event.data.data(), event.data.size());
      }
    }
    drain();
  }

  void publish(LogEvent& event) {
    if (!inputs_.admit(event)) {
      return;
    }
    if (event.channel == channels::kOdometry) {
      if (const auto odometry = decoded<odometry_t>(event.data)) {
        tracks_.set_odometry(odom_from_robot(*odometry));
      }
    }
    nodes_.lcm().publish(event.channel, event.data.data(), static_cast<unsigned int>(event.data.size()));
    ++report_.fed;
  }

  void drain() {
    for (;;) {
      const SteadyClock::time_point start = SteadyClock::now();
      handled_.clear();
      if (nodes_.lcm().handleTimeout(0) <= 0) {
        break;
      }
      StepTime& step = report_.steps[handled_];
      const double seconds = since(start);
      ++step.count;
      step.sum += seconds;
      step.longest = std::max(step.longest, seconds);
    }
  }

  /// Sees every message of the handle, inputs and outputs in the order in which the nodes saw them.
  void on_message(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    handled_ = channel;
    const bool is_output = nodes_.outputs().contains(channel);
    if (is_output || options_.keep_inputs) {
      writer_.write(now_, channel, buffer->data, buffer->data_size);
    }
    if (!is_output) {
      return;
    }
    const auto* bytes = static_cast<const std::uint8_t*>(buffer->data);
    take_answer({now_, channel, {bytes, bytes + buffer->data_size}});
  }

  void take_answer(LogEvent event) {
    ++report_.written;
    tracks_.add_replayed(std::move(event));
  }

  void read_reference() {
    LogReader log(options_.against_file);
    LogEvent event;
    while (log.next(event)) {
      if (nodes_.outputs().contains(event.channel)) {
        tracks_.add_recorded(std::move(event));
      }
    }
  }

  void progress(const LogReader& log) {
    if (!options_.show_progress || since(shown_) < 0.5) {
      return;
    }
    shown_ = SteadyClock::now();
    const double spent = std::max(1e-3, since(start_));
    fmt::print(stderr, "\r{:3.0f} %  {:.0f} s of the drive, {:.0f} times real time ",
               100.0 * static_cast<double>(log.position()) / static_cast<double>(log.size()), elapsed(now_),
               elapsed(now_) / spent);
  }

  [[nodiscard]] double elapsed(std::int64_t utime) const {
    return static_cast<double>(utime - report_.first_utime) * 1e-6;
  }

  ReplayOptions options_;
  std::set<std::string> chosen_;
  ReplayNodes nodes_;
  LogWriter writer_;
  ReplayReport report_;
  ReplayInputs inputs_{options_.camera_shift, report_};
  ReplayTracks tracks_{report_};
  std::int64_t now_ = 0;  // [us] receive time of what is being fed
  std::string handled_;
  SteadyClock::time_point start_;
  SteadyClock::time_point shown_;
};

}  // namespace

ReplayReport replay_log(const ReplayOptions& options) {
  return Replay(options).run();
}

}  // namespace luminav
