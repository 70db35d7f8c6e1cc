#include "tests/replay/comparison/pose_track.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace luminav {
namespace {

constexpr double kWrongPosition = 0.5;           // [m] the system's bound of "confidently wrong"
constexpr double kWrongHeading = radians(20.0);  // [rad]
constexpr std::int64_t kPatience = 1'000'000;    // [us] states may differ that long: a vote falls a frame later

double seconds(std::int64_t microseconds) {
  return static_cast<double>(microseconds) * 1e-6;
}

double root_mean_square(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += value * value;
  }
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) {
    return 0.0;
  }
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

void ReferenceTrack::add(std::int64_t utime, const Pose2& pose, bool excused) {
  if (!points_.empty() && utime <= points_.back().utime) {
    return;
  }
  if (excused) {
    excused_until_ = utime + kGraceAfterCarry;
  }
  points_.push_back({utime, pose, utime < excused_until_});
}

std::optional<Pose2> ReferenceTrack::at(std::int64_t utime) const {
  const auto after = std::lower_bound(points_.begin(), points_.end(), utime,
                                      [](const Point& p, std::int64_t t) { return p.utime < t; });
  if (after == points_.end()) {
    return std::nullopt;
  }
  if (after->utime == utime) {
    return after->excused ? std::nullopt : std::optional(after->pose);
  }
  if (after == points_.begin()) {
    return std::nullopt;
  }
  const Point& before = *std::prev(after);
  if (before.excused || after->excused || after->utime - before.utime > kLongestGap) {
    return std::nullopt;
  }
  return interpolate(before.pose, after->pose, seconds(utime - before.utime) / seconds(after->utime - before.utime));
}

PoseSample sample_of(const pose_t& message) {
  return {message.utime, {message.x, message.y, message.theta}, message.state, message.estimator};
}

TrackFigures measure(const std::vector<PoseSample>& track, const ReferenceTrack& reference) {
  TrackFigures figures;
  std::vector<double> position_errors;
  std::vector<double> heading_errors;
  double watched = 0.0;
  double tracking = 0.0;
  for (std::size_t i = 0; i < track.size(); ++i) {
    const PoseSample& sample = track[i];
    const double duration =
        i == 0 ? 0.0 : seconds(std::clamp<std::int64_t>(sample.utime - track[i - 1].utime, 0, 1'000'000));
    const bool is_tracking = sample.state == pose_t::STATE_TRACKING;
    ++figures.poses;
    figures.state_changes += i > 0 && sample.state != track[i - 1].state ? 1 : 0;
    if (is_tracking && figures.localized_s < 0.0) {
      figures.localized_s = seconds(sample.utime - track.front().utime);
    }
    if (figures.localized_s >= 0.0) {
      watched += duration;
      tracking += is_tracking ? duration : 0.0;
    }
    const std::optional<Pose2> truth = is_tracking ? reference.at(sample.utime) : std::nullopt;
    if (!truth) {
      continue;
    }
    ++figures.compared;
    position_errors.push_back(distance(sample.pose, *truth));
    heading_errors.push_back(std::abs(wrap_angle(sample.pose.theta - truth->theta)));
    if (position_errors.back() > kWrongPosition || heading_errors.back() > kWrongHeading) {
      figures.wrong_s += duration;
      figures.wrong_utime = figures.wrong_utime == 0 ? sample.utime : figures.wrong_utime;
    }
  }
  figures.tracking_ratio = watched > 0.0 ? tracking / watched : 0.0;
  figures.position_rms = root_mean_square(position_errors);
  figures.position_p95 = quantile(position_errors, 0.95);
  figures.position_max =
      position_errors.empty() ? 0.0 : *std::max_element(position_errors.begin(), position_errors.end());
  figures.heading_rms = root_mean_square(heading_errors);
  figures.heading_p95 = quantile(heading_errors, 0.95);
  return figures;
}

std::optional<std::int64_t> first_departure(const std::vector<PoseSample>& recorded,
                                            const std::vector<PoseSample>& replayed, double limit) {
  std::int64_t states_differ_since = 0;
  auto was = recorded.begin();
  for (const PoseSample& is : replayed) {
    while (was != recorded.end() && was->utime < is.utime) {
      ++was;
    }
    if (was == recorded.end()) {
      break;
    }
    if (was->utime != is.utime) {
      continue;
    }
    if (was->state != is.state) {
      states_differ_since = states_differ_since == 0 ? is.utime : states_differ_since;
      if (is.utime - states_differ_since > kPatience) {
        return states_differ_since;
      }
      continue;
    }
    states_differ_since = 0;
    if (is.state == pose_t::STATE_TRACKING && distance(was->pose, is.pose) > limit) {
      return is.utime;
    }
  }
  return std::nullopt;
}

}  // namespace luminav
