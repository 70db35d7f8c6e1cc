#include "services/surveyor/drive/survey_log.hpp"

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

}  // namespace luminav
