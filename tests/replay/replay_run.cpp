#include "tests/replay/replay_run.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <ctime>
#include <luminav/fixture_detections_t.hpp>
#include <luminav/map_command_t.hpp>
#include <luminav/odometry_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <map>

#include "services/common/process/channels.hpp"
#include "services/common/process/lcm_conversions.hpp"
#include "tests/replay/message_schema.hpp"
#include "tests/replay/replay_nodes.hpp"
#include "tests/replay/replay_verdict.hpp"

namespace luminav {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr int kTrailEvery = 5;  // poses

double since(SteadyClock::time_point start) {
  return std::chrono::duration<double>(SteadyClock::now() - start).count();
}

/// Of this thread [s]: what the replay would take on a core of its own.
double cpu_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

template <typename Message>
std::optional<Message> decoded(const std::vector<std::uint8_t>& data) {
  Message message{};
  if (message.decode(data.data(), 0, static_cast<int>(data.size())) < 0) {
    return std::nullopt;
  }
  return message;
}

template <typename Message>
std::vector<std::uint8_t> encoded(const Message& message) {
  std::vector<std::uint8_t> data(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(data.data(), 0, static_cast<int>(data.size()));
  return data;
}

/// The newest tile of each place of a map. Only those are unpacked, when the map is wanted.
class NewestTiles {
 public:
  void add(const std::vector<std::uint8_t>& data) {
    auto tile = decoded<grid_tile_t>(data);
    if (!tile || !is_possible(*tile)) {
      return;
    }
    if (!(geometry_of(*tile) == geometry_)) {
      geometry_ = geometry_of(*tile);
      tiles_.clear();
    }
    tiles_[{tile->tile_row, tile->tile_column}] = std::move(*tile);
  }

  [[nodiscard]] std::optional<OccupancyGrid> grid() const {
    if (tiles_.empty()) {
      return std::nullopt;
    }
    OccupancyGrid grid(geometry_);
    for (const auto& [place, tile] : tiles_) {
      [[maybe_unused]] const bool applied = apply_tile(tile, grid);
    }
    return grid;
  }

 private:
  GridGeometry geometry_;
  std::map<std::pair<int, int>, grid_tile_t> tiles_;
};

/// Which channels a log has.
std::set<std::string> contents_of(const std::string& file) {
  std::set<std::string> contents;
  LogReader log(file);
  log.load_only({});
  LogEvent event;
  // every stage has spoken within the first 20 s, requests apart
  std::int64_t first = 0;
  while (log.next(event) && (first == 0 || event.utime - first < 20'000'000)) {
    first = first == 0 ? event.utime : first;
    contents.insert(event.channel);
  }
  return contents;
}

std::set<std::string> nodes_for(const ReplayOptions& options) {
  const std::set<std::string> contents = contents_of(options.log_file);
  const auto needs = [](const std::string& node) -> std::vector<std::string> {
    return node == "detector" ? std::vector<std::string>{channels::kCameraImage}
                              : std::vector<std::string>{channels::kOdometry};
  };
  std::set<std::string> nodes = options.nodes;
  if (nodes.empty()) {
    nodes.insert(replayable_nodes().begin(), replayable_nodes().end());
    if (!contents.contains(channels::kCameraImage)) {
      nodes.erase("detector");
    }
  }
  for (const std::string& node : nodes) {
    for (const std::string& channel : needs(node)) {
      if (!contents.contains(channel)) {
        throw std::runtime_error(
            fmt::format("{}: has no {}, so the {} cannot be replayed", options.log_file, channel, node));
      }
    }
  }
  return nodes;
}

class Replay {
 public:
  explicit Replay(const ReplayOptions& options)
      : options_(options),
        chosen_(nodes_for(options)),
        nodes_({options.robot_file, options.building_file, chosen_, options.localizer_seed, options.camera_shift}),
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
    conclude();
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
        on_truth(event);
      } else if (event.channel == channels::kOdometry) {
        if (const auto message = decoded<odometry_t>(event.data)) {
          odometry[message->utime] = odom_from_robot(*message);
        }
      } else if (options_.against_file.empty() && nodes_.outputs().contains(event.channel)) {
        take_recorded(std::move(event));
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
        odometry_ = at->second;
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
        on_truth(event);
      }
      if (nodes_.outputs().contains(event.channel)) {
        if (options_.against_file.empty()) {
          take_recorded(std::move(event));
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
    if (MessageSchemas::built_in().find(event.fingerprint()) == nullptr) {
      if (foreign_.insert(event.channel).second) {
        report_.failures.push_back(
            fmt::format("{}: recorded with another version of its type (fingerprint {:016x}), {:.1f} s after the start",
                        event.channel, event.fingerprint(), elapsed(event.utime)));
      }
      return;
    }
    if (event.channel == channels::kMapCommand) {
      const auto command = decoded<map_command_t>(event.data);
      if (!command || command->action != map_command_t::ACTION_CLEAR_EVIDENCE) {
        report_.remarks.push_back(fmt::format("MAP_COMMAND {:.1f} s after the start left out: it loads or saves a file",
                                              elapsed(event.utime)));
        return;
      }
    } else if (event.channel == channels::kRobotStatus) {
      const auto status = decoded<robot_status_t>(event.data);
      if (status && robots_.insert(status->robot).second && robots_.size() == 2) {
        report_.failures.push_back(fmt::format("two robots are in the log ({}), their messages cannot be told apart",
                                               fmt::join(robots_, ", ")));
      }
    } else if (event.channel == channels::kOdometry) {
      if (const auto odometry = decoded<odometry_t>(event.data)) {
        odometry_ = odom_from_robot(*odometry);
      }
    } else if (event.channel == channels::kFixtureDetections && options_.camera_shift != 0.0) {
      shift(event);
    }
    nodes_.lcm().publish(event.channel, event.data.data(), static_cast<unsigned int>(event.data.size()));
    ++report_.fed;
  }

  void shift(LogEvent& event) const {
    if (auto detections = decoded<fixture_detections_t>(event.data)) {
      for (fixture_detection_t& detection : detections->detections) {
        detection.x += options_.camera_shift;
      }
      event.data = encoded(*detections);
    }
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
    if (event.channel == channels::kPose) {
      if (const auto pose = decoded<pose_t>(event.data)) {
        replayed_.push_back(sample_of(*pose));
        odometries_.push_back(odometry_);
      }
    } else if (event.channel == channels::kGridTile) {
      tiles_.add(event.data);
    }
    report_.divergence.replayed(std::move(event));
  }

  void take_recorded(LogEvent event) {
    if (event.channel == channels::kPose) {
      if (const auto pose = decoded<pose_t>(event.data)) {
        recorded_.push_back(sample_of(*pose));
      }
    } else if (event.channel == channels::kGridTile) {
      recorded_tiles_.add(event.data);
    }
    report_.divergence.recorded(std::move(event));
  }

  void read_reference() {
    LogReader log(options_.against_file);
    LogEvent event;
    while (log.next(event)) {
      if (nodes_.outputs().contains(event.channel)) {
        take_recorded(std::move(event));
      }
    }
  }

  void on_truth(const LogEvent& event) {
    if (const auto truth = decoded<sim_truth_t>(event.data)) {
      truth_.add(truth->utime, {truth->x, truth->y, truth->theta}, truth->carried != 0);
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

  void conclude() {
    ReplayReport& r = report_;
    r.dropped = nodes_.dropped();
    r.divergence.finish();
    r.has_truth = !truth_.empty();
    r.has_poses = chosen_.contains("localizer");
    if (!r.has_truth) {
      for (const PoseSample& sample : recorded_) {
        if (sample.state == pose_t::STATE_TRACKING) {
          truth_.add(sample.utime, sample.pose, false);
        }
      }
    }
    r.recorded = measure(recorded_, truth_);
    r.replayed = measure(replayed_, truth_);
    r.departed = first_departure(recorded_, replayed_, options_.tolerances.position);
    r.grid = tiles_.grid();
    r.map = compare_maps(recorded_tiles_.grid(), r.grid);
    for (std::size_t i = 0; i < replayed_.size(); i += kTrailEvery) {
      const PoseSample& sample = replayed_[i];
      r.trail.push_back({truth_.at(sample.utime).value_or(r.trail.empty() ? sample.pose : r.trail.back().truth),
                         sample.pose, odometries_[i], sample.state, sample.estimator});
    }
    for (std::size_t i = 0; i < recorded_.size(); i += kTrailEvery) {
      if (recorded_[i].state == pose_t::STATE_TRACKING) {
        r.recorded_trail.push_back(recorded_[i].pose);
      }
    }
    append_verdict(options_.tolerances, r);
  }

  [[nodiscard]] double elapsed(std::int64_t utime) const {
    return static_cast<double>(utime - report_.first_utime) * 1e-6;
  }

  ReplayOptions options_;
  std::set<std::string> chosen_;
  ReplayNodes nodes_;
  LogWriter writer_;
  ReplayReport report_;
  std::int64_t now_ = 0;  // [us] receive time of what is being fed
  std::string handled_;
  std::set<std::string> foreign_;
  std::set<std::string> robots_;
  Pose2 odometry_;
  std::vector<PoseSample> recorded_;
  std::vector<PoseSample> replayed_;
  std::vector<Pose2> odometries_;  // one for each of replayed_
  ReferenceTrack truth_;
  NewestTiles tiles_;
  NewestTiles recorded_tiles_;
  SteadyClock::time_point start_;
  SteadyClock::time_point shown_;
};

}  // namespace

ReplayReport replay_log(const ReplayOptions& options) {
  return Replay(options).run();
}

}  // namespace luminav
