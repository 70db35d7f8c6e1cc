#include "services/surveyor/drive/drive_collector.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "services/common/ceiling/detection_conversion.hpp"
#include "services/common/image/jpeg_codec.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/lcm_conversions.hpp"
#include "services/common/process/subscriber.hpp"
#include "services/detector/detector.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kLookPeriod = 500'000;   // [us] between looks of a robot that stands: it may be lifted
constexpr double kLongestExposure = 100'000.0;  // [us] that a camera of a moving robot may take

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
  sighting.shape = detection.shape;
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

/// The detector on the images of a drive, as far apart as key frames are.
class DriveCollector::ImageReader {
 public:
  explicit ImageReader(const DetectorConfig& config)
      : detector_(config.params, config.camera, config.catalogue),
        decoder_(config.camera.intrinsics.width, config.camera.intrinsics.height) {}

  /// Nothing where the image is too near to the one before, or damaged.
  std::optional<SightingFrame> read(const camera_image_t& message, const Pose2& odom_from_robot) {
    const Pose2 since = last_.inverse() * odom_from_robot;
    const bool is_due = is_first_ || std::hypot(since.x, since.y) >= kKeyFrameSpacing ||
                        std::abs(since.theta) >= kKeyFrameTurn || message.utime - last_utime_ >= kLookPeriod;
    GreyView view{message.width, message.height, message.data};
    if (!is_due || (message.format == camera_image_t::FORMAT_JPEG && !decode(message, view)) ||
        !detector_.accepts(view)) {
      return std::nullopt;
    }
    is_first_ = false;
    last_ = odom_from_robot;
    last_utime_ = message.utime;
    SightingFrame frame;
    frame.utime = message.utime;
    frame.exposure =
        message.exposure_us > 0.0 && message.exposure_us <= kLongestExposure ? 1e-6 * message.exposure_us : 0.0;
    for (const Detection& detection : detector_.detect(view)) {
      if (detection.covariance.allFinite()) {
        frame.sightings.push_back(to_sighting(detection));
      }
    }
    return frame;
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

DriveCollector::DriveCollector() = default;
DriveCollector::DriveCollector(const DetectorConfig& config) : reader_(std::make_unique<ImageReader>(config)) {
  log_.drive.has_lengths = true;
}
DriveCollector::~DriveCollector() = default;

bool DriveCollector::add(const odometry_t& message) {
  std::vector<OdometryReading>& odometry = log_.drive.odometry;
  if (!is_stamp(message.utime) || !is_possible(message) ||
      (!odometry.empty() && message.utime <= odometry.back().utime)) {
    return false;
  }
  odometry.push_back({message.utime, message.session, odom_from_robot(message), message.linear, message.angular});
  return true;
}

bool DriveCollector::add(const sonar_t& message) {
  const std::size_t before = log_.drive.echoes.size();
  for (int disc = 0; disc < message.count; ++disc) {
    const auto i = static_cast<std::size_t>(disc);
    if (message.fresh[i] != 0 && is_stamp(message.range_utime[i]) && std::isfinite(message.range[i])) {
      log_.drive.echoes.push_back({disc, message.range[i], message.has_echo[i] != 0, message.range_utime[i]});
    }
  }
  return log_.drive.echoes.size() > before;
}

bool DriveCollector::add(const camera_image_t& message) {
  ++log_.images;
  if (reader_ == nullptr || log_.drive.odometry.empty() || !is_stamp(message.utime)) {
    return false;
  }
  std::optional<SightingFrame> frame = reader_->read(message, log_.drive.odometry.back().odom_from_robot);
  if (!frame) {
    return false;
  }
  log_.drive.frames.push_back(*std::move(frame));
  return true;
}

bool DriveCollector::add(const fixture_detections_t& message) {
  if (reader_ != nullptr || !is_stamp(message.utime)) {
    return false;
  }
  log_.drive.frames.push_back(to_frame(message));
  return true;
}

bool DriveCollector::add(const pose_t& message) {
  std::vector<ToldPose>& told = log_.drive.told;
  const Pose2 pose{message.x, message.y, message.theta};
  if (message.state != pose_t::STATE_TRACKING || !is_stamp(message.utime) ||
      !std::isfinite(pose.x + pose.y + pose.theta) || (!told.empty() && message.utime <= told.back().utime)) {
    return false;
  }
  told.push_back({message.utime, pose});
  return true;
}

bool DriveCollector::add(const survey_command_t& message) {
  if (message.action == survey_command_t::ACTION_FINISH && message.name == kExplored) {
    return !std::exchange(log_.is_explored, true);
  }
  const bool is_known = std::any_of(log_.places.begin(), log_.places.end(),
                                    [&](const NamedMoment& place) { return place.command == message.id; });
  if (message.action != survey_command_t::ACTION_PLACE || message.name.empty() || log_.drive.odometry.empty() ||
      is_known) {
    return false;
  }
  std::erase_if(log_.places, [&](const NamedMoment& place) { return place.name == message.name; });
  log_.places.push_back({message.name, log_.drive.odometry.back().utime, message.id});
  return true;
}

template <typename Message>
bool DriveCollector::add_bytes(const void* data, std::size_t size) {
  Message message{};
  return message.decode(data, 0, static_cast<int>(size)) > 0 && add(message);
}

bool DriveCollector::add(std::string_view channel, const void* data, std::size_t size) {
  return (channel == channels::kOdometry && add_bytes<odometry_t>(data, size)) ||
         (channel == channels::kSonar && add_bytes<sonar_t>(data, size)) ||
         (channel == channels::kFixtureDetections && add_bytes<fixture_detections_t>(data, size)) ||
         (channel == channels::kCameraImage && add_bytes<camera_image_t>(data, size)) ||
         (channel == channels::kPose && add_bytes<pose_t>(data, size)) ||
         (channel == channels::kSurveyCommand && add_bytes<survey_command_t>(data, size));
}

SurveyLog DriveCollector::collected() const {
  SurveyLog log = log_;
  log.looked_at = reader_ != nullptr ? log.drive.frames.size() : 0;
  // a stamp from the future must not hold up the frames behind it
  std::stable_sort(log.drive.frames.begin(), log.drive.frames.end(),
                   [](const SightingFrame& a, const SightingFrame& b) { return a.utime < b.utime; });
  measure_gaps(log);
  return log;
}

}  // namespace luminav
