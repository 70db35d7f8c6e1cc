#include "services/localizer/echo_collector.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr std::size_t kMostEchoes = 64;
constexpr std::size_t kFewestEchoes = 3;
constexpr std::int64_t kOldest = 1'000'000;  // [us]
constexpr std::size_t kMostPlaces = 100;     // odometry has drifted since those before
constexpr std::size_t kMostSurfaces = 400;   // likewise
constexpr double kFarAway = 1e9;             // [m]
constexpr double kUsableRange = 0.9;         // of the maximum: beyond it the ring says its maximum for nothing heard

/// Keeps so many, evenly over the ring.
void thin_out(std::vector<PlacedEcho>& echoes, std::size_t most) {
  if (echoes.size() > most) {
    for (std::size_t i = 0; i < most; ++i) {
      echoes[i] = echoes[i * echoes.size() / most];
    }
    echoes.resize(most);
  }
}

}  // namespace

void EchoCollector::add(const SonarScan& scan) {
  for (const SonarEcho& reading : scan.readings) {
    if (reading.has_echo && reading.disc >= 0 && reading.disc < static_cast<int>(sonar_.robot_from_sonar.size()) &&
        reading.range >= sonar_.minimum_range && reading.range < kUsableRange * sonar_.maximum_range) {
      echoes_.push_back(reading);
    }
  }
  if (echoes_.size() > kMostEchoes) {
    echoes_.erase(echoes_.begin(), echoes_.end() - kMostEchoes);
  }
}

void EchoCollector::advance(const Pose2& delta) {
  way_since_ += std::hypot(delta.x, delta.y);
  turn_since_ += std::abs(delta.theta);
}

void EchoCollector::clear() {
  echoes_.clear();
  forget_places();
}

void EchoCollector::forget_places() {
  places_.clear();
  surfaces_.clear();
  way_since_ = kFarAway;
  turn_since_ = 0.0;
}

bool EchoCollector::has_listened_at(const Pose2& odom_from_robot) const {
  return std::any_of(places_.begin(), places_.end(), [&](const Pose2& place) {
    return distance(place, odom_from_robot) < rules_.way &&
           std::abs(wrap_angle(place.theta - odom_from_robot.theta)) < rules_.turn;
  });
}

double EchoCollector::look_at(const Eigen::Vector2d& end_in_odom) {
  const int column = static_cast<int>(std::floor(end_in_odom.x() / rules_.surface));
  const int row = static_cast<int>(std::floor(end_in_odom.y() / rules_.surface));
  auto surface = std::find_if(surfaces_.begin(), surfaces_.end(),
                              [&](const Surface& s) { return s.column == column && s.row == row; });
  if (surface == surfaces_.end()) {
    if (surfaces_.size() >= kMostSurfaces) {
      surfaces_.erase(surfaces_.begin());
    }
    surface = surfaces_.insert(surfaces_.end(), {column, row, 0});
  }
  return ++surface->looks <= rules_.looks ? 1.0 / rules_.looks : 0.0;
}

std::vector<PlacedEcho> EchoCollector::take(std::int64_t utime, const OdometryHistory& history, std::size_t most) {
  if (way_since_ < rules_.way && turn_since_ < rules_.turn) {
    return {};
  }
  const auto now = history.at(utime);
  if (!now || has_listened_at(now->odom_from_robot)) {
    return {};
  }
  std::vector<PlacedEcho> echoes;
  std::vector<bool> has_disc(sonar_.robot_from_sonar.size(), false);
  for (auto reading = echoes_.rbegin(); reading != echoes_.rend(); ++reading) {
    const auto disc = static_cast<std::size_t>(reading->disc);
    const auto then = history.at(reading->utime);
    if (!then || reading->utime > utime || utime - reading->utime > kOldest || has_disc[disc]) {
      continue;
    }
    has_disc[disc] = true;
    const Pose2 now_from_sonar = now->odom_from_robot.inverse() * then->odom_from_robot * sonar_.robot_from_sonar[disc];
    echoes.push_back(
        {now_from_sonar.position(), now_from_sonar * Eigen::Vector2d(reading->range, 0.0), reading->range});
  }
  if (echoes.size() < kFewestEchoes) {
    return {};
  }
  std::erase_if(echoes_, [&](const SonarEcho& reading) { return reading.utime <= utime; });
  way_since_ = 0.0;
  turn_since_ = 0.0;
  if (places_.size() >= kMostPlaces) {
    places_.erase(places_.begin());
  }
  places_.push_back(now->odom_from_robot);
  // before they count for their surfaces: what nobody hears must not use them up
  thin_out(echoes, most);
  for (PlacedEcho& echo : echoes) {
    echo.weight = look_at(now->odom_from_robot * echo.end);
  }
  std::erase_if(echoes, [](const PlacedEcho& echo) { return echo.weight == 0.0; });
  return echoes;
}

}  // namespace luminav
