#include "services/surveyor/drive/survey_log.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <luminav/camera_image_t.hpp>
#include <luminav/fixture_detections_t.hpp>
#include <luminav/odometry_t.hpp>
#include <luminav/sonar_t.hpp>
#include <stdexcept>

#include "services/common/ceiling/detection_conversion.hpp"
#include "services/common/image/jpeg_codec.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/lcm_conversions.hpp"
#include "services/common/process/subscriber.hpp"
#include "services/detector/detector.hpp"
#include "services/detector/detector_config.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kLookPeriod = 500'000;  // [us] between looks of a robot that stands: it may be lifted

SightingFrame to_frame(const fixture_detections_t& message) {
  SightingFrame frame;
  frame.utime = message.utime;
  for (const fixture_detection_t& detection : message.detections) {
    if (is_possible(detection) && detection.shape != fixture_detection_t::SHAPE_ELEMENT) {
      frame.sightings.push_back(to_sighting(detection));
    }
  }
  return frame;
}

FixtureShape shape_of(const Detection& detection) {
  return detection.shape == DetectionShape::kSquare  ? FixtureShape::kSquare
         : detection.shape == DetectionShape::kRound ? FixtureShape::kRound
                                                     : FixtureShape::kRectangle;
}

SightingState state_of(const Detection& detection) {
  switch (detection.state) {
    case DetectionState::kLit:
      return SightingState::kLit;
    case DetectionState::kUnlit:
      return SightingState::kUnlit;
    case DetectionState::kHalf:
      return SightingState::kHalf;
    case DetectionState::kUnknown:
      break;
  }
  return SightingState::kUnknown;
}

FixtureSighting to_sighting(const Detection& detection) {
  FixtureSighting sighting;
  sighting.robot_from_fixture = detection.robot_from_fixture;
  sighting.covariance = detection.covariance;
  sighting.shape = shape_of(detection);
  sighting.state = state_of(detection);
  sighting.has_theta = detection.has_theta;
  sighting.length = detection.length * detection.scale.value_or(1.0);
  sighting.width = detection.width;
  sighting.clipped = detection.clipped;
  sighting.near_end_visible = detection.near_end_visible;
  sighting.far_end_visible = detection.far_end_visible;
  sighting.fit = detection.fit;
  return sighting;
}

/// The detector on the images of a log, as far apart as key frames are.
class ImageReader {
 public:
  explicit ImageReader(const DetectorConfig& config)
      : detector_(config.params, config.camera, config.catalogue),
        decoder_(config.camera.intrinsics.width, config.camera.intrinsics.height) {}

  void read(const camera_image_t& message, const Pose2& odom_from_robot, SurveyDrive& drive) {
    const Pose2 since = last_.inverse() * odom_from_robot;
    const bool is_due = is_first_ || std::hypot(since.x, since.y) >= kKeyFrameSpacing ||
                        std::abs(since.theta) >= kKeyFrameTurn || message.utime - last_utime_ >= kLookPeriod;
    GreyView view{message.width, message.height, message.data};
    if (!is_due || (message.format == camera_image_t::FORMAT_JPEG && !decode(message, view)) ||
        !detector_.accepts(view)) {
      return;
    }
    is_first_ = false;
    last_ = odom_from_robot;
    last_utime_ = message.utime;
    SightingFrame frame;
    frame.utime = message.utime;
    for (const Detection& detection : detector_.detect(view)) {
      if (detection.shape != DetectionShape::kElement && detection.covariance.allFinite()) {
        frame.sightings.push_back(to_sighting(detection));
      }
    }
    drive.frames.push_back(frame);
  }

 private:
  bool decode(const camera_image_t& message, GreyView& view) {
    const bool is_whole = decoder_.decode(message.data, decoded_);
    view = decoded_.view();
    return is_whole;
  }

  Detector detector_;
  JpegDecoder decoder_;
  GreyImage decoded_;
  Pose2 last_;  // of odometry, at the last image looked at
  std::int64_t last_utime_ = 0;
  bool is_first_ = true;
};

class LogReader {
 public:
  explicit LogReader(const std::string& file) : log_(file, "r") {
    if (!log_.good()) {
      throw std::runtime_error(file + ": cannot be read as an LCM log");
    }
  }

  /// With a reader, sightings come from the images, else from the detections.
  SurveyLog read(ImageReader* reader) {
    SurveyLog result;
    long whole = 0;  // [bytes] of events
    while (const lcm::LogEvent* event = log_.readNextEvent()) {
      whole = std::ftell(log_.getFilePtr());
      if (event->channel == channels::kOdometry) {
        add_odometry(*event, result.drive);
      } else if (event->channel == channels::kSonar) {
        add_sonar(*event, result.drive);
      } else if (event->channel == channels::kFixtureDetections && reader == nullptr) {
        fixture_detections_t message{};
        if (message.decode(event->data, 0, event->datalen) > 0 && is_stamp(message.utime)) {
          result.drive.frames.push_back(to_frame(message));
        }
      } else if (event->channel == channels::kCameraImage) {
        ++result.images;
        camera_image_t message{};
        if (reader != nullptr && !result.drive.odometry.empty() && message.decode(event->data, 0, event->datalen) > 0 &&
            is_stamp(message.utime)) {
          reader->read(message, result.drive.odometry.back().odom_from_robot, result.drive);
        }
      }
    }
    std::fseek(log_.getFilePtr(), 0, SEEK_END);
    result.is_cut = std::ftell(log_.getFilePtr()) != whole;
    result.drive.has_lengths = reader != nullptr;
    result.looked_at = reader != nullptr ? result.drive.frames.size() : 0;
    // a stamp from the future must not hold up the frames behind it
    std::stable_sort(result.drive.frames.begin(), result.drive.frames.end(),
                     [](const SightingFrame& a, const SightingFrame& b) { return a.utime < b.utime; });
    return result;
  }

 private:
  static void add_odometry(const lcm::LogEvent& event, SurveyDrive& drive) {
    odometry_t message{};
    if (message.decode(event.data, 0, event.datalen) > 0 && is_stamp(message.utime) && is_possible(message) &&
        (drive.odometry.empty() || message.utime > drive.odometry.back().utime)) {
      drive.odometry.push_back(
          {message.utime, message.session, odom_from_robot(message), message.linear, message.angular});
    }
  }

  static void add_sonar(const lcm::LogEvent& event, SurveyDrive& drive) {
    sonar_t message{};
    if (message.decode(event.data, 0, event.datalen) <= 0) {
      return;
    }
    for (int disc = 0; disc < message.count; ++disc) {
      const auto i = static_cast<std::size_t>(disc);
      if (message.fresh[i] != 0 && is_stamp(message.range_utime[i]) && std::isfinite(message.range[i])) {
        drive.echoes.push_back({disc, message.range[i], message.has_echo[i] != 0, message.range_utime[i]});
      }
    }
  }

  lcm::LogFile log_;
};

void measure_gaps(SurveyLog& log) {
  const std::vector<OdometryReading>& odometry = log.drive.odometry;
  std::size_t next = 0;
  double blind = 0.0;
  for (std::size_t i = 1; i < odometry.size(); ++i) {
    if (odometry[i].session != odometry[i - 1].session) {
      continue;
    }
    log.longest_gap = std::max(log.longest_gap, 1e-6 * static_cast<double>(odometry[i].utime - odometry[i - 1].utime));
    const std::size_t before = next;
    while (next < log.drive.frames.size() && log.drive.frames[next].utime <= odometry[i].utime) {
      ++next;
    }
    blind = next > before ? 0.0 : blind + distance(odometry[i - 1].odom_from_robot, odometry[i].odom_from_robot);
    log.blind_way = std::max(log.blind_way, blind);
  }
}

}  // namespace

SurveyLog read_survey_log(const std::string& file, const std::string& robot_file, const CeilingKinds& kinds,
                          SightingSource source) {
  SurveyLog log = LogReader(file).read(nullptr);
  if (log.images > 0 && source == SightingSource::kImagesElseDetections) {
    ImageReader reader(read_detector_config(robot_file, building_of(kinds), "the file of kinds"));
    log = LogReader(file).read(&reader);
  }
  measure_gaps(log);
  return log;
}

}  // namespace luminav
