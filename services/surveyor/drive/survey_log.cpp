#include "services/surveyor/drive/survey_log.hpp"

#include <algorithm>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <stdexcept>

#include "services/surveyor/drive/drive_collector.hpp"

namespace luminav {
namespace {

/// Hands all that a log has to the collector; whether the log ends inside a message.
bool read_into(const std::string& file, DriveCollector& collector) {
  lcm::LogFile log(file, "r");
  if (!log.good()) {
    throw std::runtime_error(file + ": cannot be read as an LCM log");
  }
  long whole = 0;  // [bytes] of events
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    whole = std::ftell(log.getFilePtr());
    collector.add(event->channel, event->data, static_cast<std::size_t>(event->datalen));
  }
  std::fseek(log.getFilePtr(), 0, SEEK_END);
  return std::ftell(log.getFilePtr()) != whole;
}

constexpr std::int64_t kBetweenLogs = 10'000'000;  // [us] where clocks tell nothing

/// By how much [us] a log's times have to be moved to lie behind those of another.
std::int64_t shift_behind(const SurveyLog& before, const SurveyLog& log) {
  if (before.drive.odometry.empty() || log.drive.odometry.empty()) {
    return 0;
  }
  const std::int64_t end = before.drive.odometry.back().utime + kBetweenLogs;
  return std::max<std::int64_t>(0, end - log.drive.odometry.front().utime);
}

/// Appends what has a time, moved.
template <typename Timed>
void append(std::vector<Timed>& all, const std::vector<Timed>& more, std::int64_t shift) {
  for (Timed each : more) {
    each.utime += shift;
    all.push_back(std::move(each));
  }
}

SurveyLog read_with(const std::string& file, DriveCollector& collector) {
  const bool is_cut = read_into(file, collector);
  SurveyLog log = collector.collected();
  log.is_cut = is_cut;
  return log;
}

}  // namespace

SurveyLog read_survey_log(const std::string& file, const std::string& robot_file, const CeilingKinds& kinds,
                          SightingSource source) {
  DriveCollector by_detections;
  const SurveyLog log = read_with(file, by_detections);
  if (log.images == 0 || source == SightingSource::kDetections) {
    return log;
  }
  DriveCollector by_images(read_detector_config(robot_file, building_of(kinds), "the file of kinds"));
  return read_with(file, by_images);
}

SurveyLog one_after_another(const std::vector<SurveyLog>& logs) {
  SurveyLog all = logs.at(0);
  for (auto log = logs.begin() + 1; log != logs.end(); ++log) {
    const std::int64_t shift = shift_behind(all, *log);
    const std::size_t before = all.drive.odometry.size();
    append(all.drive.odometry, log->drive.odometry, shift);
    append(all.drive.frames, log->drive.frames, shift);
    append(all.drive.echoes, log->drive.echoes, shift);
    append(all.drive.told, log->drive.told, shift);
    append(all.places, log->places, shift);
    const bool begins_anew = before > 0 && before < all.drive.odometry.size();
    const std::int64_t other = begins_anew ? all.drive.odometry[before - 1].session + 1 : 0;
    const std::int64_t own = begins_anew ? all.drive.odometry[before].session : 0;
    for (std::size_t i = before; i < all.drive.odometry.size(); ++i) {
      all.drive.odometry[i].session += other - own;  // each log may have numbered its sessions from 1
    }
    all.drive.has_lengths = all.drive.has_lengths && log->drive.has_lengths;
    all.images += log->images;
    all.looked_at += log->looked_at;
    all.longest_gap = std::max(all.longest_gap, log->longest_gap);
    all.blind_way = std::max(all.blind_way, log->blind_way);
    all.is_cut = all.is_cut || log->is_cut;
    all.is_explored = all.is_explored || log->is_explored;
  }
  return all;
}

}  // namespace luminav
