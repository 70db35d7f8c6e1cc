#include "tests/evaluation/sensing/sensing_survey.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "drivers/camera/truth_message.hpp"
#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

// A detection belongs to a fixture when it is that near to where the fixture is in the image.
constexpr double kAlongGate = 0.30;   // [m]
constexpr double kAcrossGate = 0.15;  // [m]
constexpr double kTurnGate = radians(10.0);
constexpr double kSameFalseAlarm = 0.3;  // [m] from one frame to the next
constexpr std::size_t kMaxErrors = 60;   // kept of a class
constexpr std::size_t kMaxFalseAlarms = 200;

FixtureShape shape_of(const fixture_detection_t& detection) {
  return detection.shape == fixture_detection_t::SHAPE_SQUARE  ? FixtureShape::kSquare
         : detection.shape == fixture_detection_t::SHAPE_ROUND ? FixtureShape::kRound
                                                               : FixtureShape::kRectangle;
}

Eigen::Matrix3d covariance_of(const fixture_detection_t& detection) {
  Eigen::Matrix3d covariance;
  for (int i = 0; i < 9; ++i) {
    covariance(i / 3, i % 3) = detection.covariance[i];
  }
  return covariance;
}

/// The detection beside what the image says of the fixture; nothing when it is not that fixture.
std::optional<MeasuredSighting> compare(const fixture_detection_t& detection, const FixtureView& view,
                                        const Fixture& fixture) {
  if (shape_of(detection) != fixture.shape) {
    return std::nullopt;
  }
  const bool bar = fixture.shape == FixtureShape::kRectangle;
  const double period = symmetry_period(fixture.shape);
  const Pose2 seen{detection.x, detection.y, detection.theta};
  const double turn = detection.has_theta ? wrap_modulo(seen.theta - view.robot_from_line.theta, period) : 0.0;
  const bool reversed = bar && std::abs(wrap_angle(seen.theta - view.robot_from_line.theta)) > 0.5 * kPi;
  MeasuredSighting measured;
  measured.near_end = (reversed ? detection.far_end_visible : detection.near_end_visible) != 0;
  measured.far_end = (reversed ? detection.near_end_visible : detection.far_end_visible) != 0;
  const Pose2 expected =
      bar ? view.robot_from_fixture(measured.near_end, measured.far_end) : view.robot_from_fixture(true, true);
  const Eigen::Vector2d error = expected.inverse() * seen.position();
  if (std::abs(turn) > kTurnGate || std::abs(error.x()) > kAlongGate || std::abs(error.y()) > kAcrossGate) {
    return std::nullopt;
  }
  const double c = std::cos(expected.theta);
  const double s = std::sin(expected.theta);
  Eigen::Matrix3d to_fixture;
  to_fixture << c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0;
  const Eigen::Matrix3d covariance = to_fixture * covariance_of(detection) * to_fixture.transpose();
  measured.along = error.x();
  measured.across = error.y();
  measured.turn = turn;
  measured.sigma_along = std::sqrt(std::max(covariance(0, 0), 1e-12));
  measured.sigma_across = std::sqrt(std::max(covariance(1, 1), 1e-12));
  measured.sigma_turn = std::sqrt(std::max(covariance(2, 2), 1e-12));
  measured.correlation = covariance(1, 2) / (measured.sigma_across * measured.sigma_turn);
  measured.length = detection.length - (view.seen_to - view.seen_from);
  measured.width = detection.width - fixture.width;
  measured.fit = detection.fit;
  measured.state = detection.state;
  measured.clipped = detection.clipped != 0;
  if (view.near_end && !view.far_end) {  // as if it were the far one
    measured.along = -measured.along;
    measured.across = -measured.across;
    std::swap(measured.near_end, measured.far_end);
  }
  return measured;
}

MeasuredFalseAlarm false_alarm_of(const fixture_detection_t& detection) {
  MeasuredFalseAlarm alarm;
  alarm.robot_from_fixture = {detection.x, detection.y, detection.theta};
  std::copy(std::begin(detection.covariance), std::end(detection.covariance), alarm.covariance.begin());
  alarm.length = detection.length;
  alarm.width = detection.width;
  alarm.fit = detection.fit;
  alarm.shape = detection.shape;
  alarm.state = detection.state;
  alarm.near_end = detection.near_end_visible != 0;
  alarm.far_end = detection.far_end_visible != 0;
  alarm.clipped = detection.clipped != 0;
  return alarm;
}

/// At most `max` of the values, spread evenly over them.
template <typename Value>
std::vector<Value> thinned(const std::vector<Value>& values, std::size_t max) {
  if (values.size() <= max) {
    return values;
  }
  std::vector<Value> kept;
  for (std::size_t i = 0; i < max; ++i) {
    kept.push_back(values[(2 * i + 1) * values.size() / (2 * max)]);
  }
  return kept;
}

struct Correlation {
  double product = 0.0;
  double scale = 0.0;
  void add(double a, double b, double variance) {
    product += a * b;
    scale += variance;
  }
  [[nodiscard]] double value() const { return scale > 0.0 ? std::clamp(product / scale, 0.0, 0.999) : 0.0; }
};

/// 0..1: where an error across stands among those of its class, which are sorted.
double rank_of(const MeasuredSighting& sighting, const std::vector<MeasuredSighting>& sorted) {
  const auto at = std::lower_bound(sorted.begin(), sorted.end(), sighting,
                                   [](const auto& a, const auto& b) { return a.across < b.across; });
  return (static_cast<double>(at - sorted.begin()) + 0.5) / static_cast<double>(sorted.size() + 1);
}

}  // namespace

SensingSurvey::SensingSurvey(lcm::LCM& lcm, const WorldTruth& world, const Building& believed,
                             const CameraDescription& believed_camera, std::uint64_t seed)
    : world_(world),
      viewer_(world, believed, believed_camera),
      light_(world_.building, seed),
      offset_(1e6 * world.robot.camera.time_offset),
      subscriber_(lcm) {
  subscriber_.on(channels::kSimTruth, &SensingSurvey::on_truth, this);
  subscriber_.on(channels::kFixtureDetections, &SensingSurvey::on_detections, this);
}

void SensingSurvey::on_truth(const sim_truth_t& truth) {
  if (!truth_.add(truth_sample(truth)) || truth.carried != 0) {
    last_pose_.reset();
  }
}

void SensingSurvey::on_detections(const fixture_detections_t& detections) {
  const double middle = static_cast<double>(detections.utime) + offset_;
  const auto moment =
      truth_.empty() ? std::nullopt : moment_at(truth_, middle, 1e6 * world_.robot.camera.row_time * detections.height);
  if (!moment) {
    last_pose_.reset();
    return;
  }
  const Pose2& pose = moment->pose.world_from_robot;
  const int motion = last_pose_ ? motion_class(*last_pose_, pose) : kMotionClasses - 1;
  ++result_.frames;
  light_.set(truth_.newest().daylight, truth_.newest().lamps);
  viewer_.look(*moment, truth_.newest().moved, 0.03, views_);
  std::vector<bool> matched(detections.detections.size(), false);
  for (const FixtureView& view : views_) {
    const Fixture& fixture = world_.building.fixtures[view.index];
    const bool burns = light_.emission(static_cast<int>(view.index), middle) > 0.0;
    const bool half = truth_.newest().lamps[view.index] == simulated::LampState::kHalf;
    SurveyedSighting surveyed;
    surveyed.sighting =
        class_of(fixture.shape, light_of(burns, half, world_.unlit_darker[view.index]), view, moment->angular);
    surveyed.fixture = view.index;
    surveyed.frame = detections.sequence;
    surveyed.motion = motion;
    for (std::size_t i = 0; i < matched.size(); ++i) {
      if (!matched[i] && detections.detections[i].shape != fixture_detection_t::SHAPE_ELEMENT) {
        surveyed.seen = compare(detections.detections[i], view, fixture);
        if (surveyed.seen) {
          matched[i] = true;
          break;
        }
      }
    }
    result_.sightings.push_back(surveyed);
  }
  note_false_alarms(detections, matched, pose);
  last_pose_ = pose;
}

void SensingSurvey::note_false_alarms(const fixture_detections_t& detections, const std::vector<bool>& matched,
                                      const Pose2& pose) {
  std::vector<Pose2> now;
  for (std::size_t i = 0; i < matched.size(); ++i) {
    const fixture_detection_t& detection = detections.detections[i];
    if (matched[i] || detection.shape == fixture_detection_t::SHAPE_ELEMENT) {
      continue;
    }
    const Pose2 world_from_alarm = pose * Pose2{detection.x, detection.y, detection.theta};
    const bool known = std::any_of(last_false_alarms_.begin(), last_false_alarms_.end(), [&](const Pose2& last) {
      return distance(last, world_from_alarm) < kSameFalseAlarm;
    });
    if (!known) {
      ++result_.false_begins;
      result_.false_alarms.push_back(false_alarm_of(detection));
    }
    ++result_.false_frames;
    now.push_back(world_from_alarm);
  }
  last_false_alarms_ = std::move(now);
}

DetectorBehaviour fit_behaviour(const std::vector<SensingSurveyResult>& runs, const std::string& mode,
                                const std::string& source) {
  DetectorBehaviour behaviour;
  behaviour.mode = mode;
  behaviour.source = source;
  std::int64_t frames = 0;
  std::int64_t false_frames = 0;
  std::int64_t false_begins = 0;
  std::vector<MeasuredFalseAlarm> alarms;
  for (const SensingSurveyResult& run : runs) {
    frames += run.frames;
    false_frames += run.false_frames;
    false_begins += run.false_begins;
    alarms.insert(alarms.end(), run.false_alarms.begin(), run.false_alarms.end());
    for (const SurveyedSighting& surveyed : run.sightings) {
      auto& bin = behaviour.bins[static_cast<std::size_t>(surveyed.sighting.index())];
      ++bin.shown;
      if (surveyed.seen) {
        ++bin.seen;
        const int errors = DetectorBehaviour::class_of_errors(surveyed.sighting).index();
        behaviour.sightings[static_cast<std::size_t>(errors)].push_back(*surveyed.seen);
      }
    }
  }
  behaviour.prepare();
  std::array<Correlation, kMotionClasses> seen;
  std::array<Correlation, kMotionClasses> error;
  for (const SensingSurveyResult& run : runs) {
    std::map<std::size_t, const SurveyedSighting*> last;  // by fixture
    for (const SurveyedSighting& now : run.sightings) {
      const SurveyedSighting*& before = last[now.fixture];
      if (before != nullptr && before->frame + 1 == now.frame) {
        const auto motion = static_cast<std::size_t>(now.motion);
        const double p = behaviour.seen_probability(now.sighting);
        const double q = behaviour.seen_probability(before->sighting);
        // How much two outcomes of the same draw vary together, at most: the smaller of the two chances is common.
        seen[motion].add((now.seen ? 1.0 : 0.0) - p, (before->seen ? 1.0 : 0.0) - q, std::min(p, q) - p * q);
        if (now.seen && before->seen) {
          const double a = rank_of(*now.seen, behaviour.errors(now.sighting));
          const double b = rank_of(*before->seen, behaviour.errors(before->sighting));
          error[motion].add(a - 0.5, b - 0.5, 1.0 / 12.0);
        }
      }
      before = &now;
    }
  }
  for (std::size_t motion = 0; motion < kMotionClasses; ++motion) {
    behaviour.keep_seen[motion] = seen[motion].value();
    behaviour.keep_error[motion] = error[motion].value();
  }
  for (auto& list : behaviour.sightings) {
    list = thinned(list, kMaxErrors);
  }
  behaviour.false_alarms = thinned(alarms, kMaxFalseAlarms);
  behaviour.false_alarms_begin = frames > 0 ? static_cast<double>(false_begins) / static_cast<double>(frames) : 0.0;
  behaviour.false_alarms_last =
      false_frames > 0 ? static_cast<double>(false_frames - false_begins) / static_cast<double>(false_frames) : 0.0;
  behaviour.prepare();
  return behaviour;
}

}  // namespace luminav
