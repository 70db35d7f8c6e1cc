#include "services/localizer/hypotheses/echo_collector.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr std::size_t kMaxEchoes = 64;
constexpr std::size_t kFewestEchoes = 3;
constexpr std::int64_t kOldest = 1'000'000;  // [us]
constexpr std::size_t kMaxPlaces = 100;      // odometry has drifted since those before
constexpr std::size_t kMaxSurfaces = 800;    // likewise
constexpr double kFarAway = 1e9;             // [m]
constexpr double kUsableRange = 0.9;         // of the maximum: beyond it the ring says its maximum for nothing heard
constexpr double kSurelyHeard = 0.8;         // of the maximum: a wall that faces the disc echoes from there
constexpr std::int64_t kAlive = 20'000'000;  // [us] after an echo in which a disc's silence counts
constexpr double kFarther = 0.5;             // [m] by which an earlier reading of a disc went farther than its newest
constexpr double kPassage = 1.0;             // [m] from the disc: what passes there passes on from there
constexpr double kSector = radians(30.0);
constexpr int kPassageLooks = 2;  // beams that pass a place one way and count: one in a hundred is silent by chance

/// Keeps so many, evenly over the ring.
void thin_out(std::vector<PlacedEcho>& echoes, std::size_t max) {
  if (echoes.size() > max) {
    for (std::size_t i = 0; i < max; ++i) {
      echoes[i] = echoes[i * echoes.size() / max];
    }
    echoes.resize(max);
  }
}

}  // namespace

void EchoCollector::add(const SonarScan& scan) {
  for (const SonarEcho& reading : scan.readings) {
    const auto disc = static_cast<std::size_t>(reading.disc);
    if (reading.disc < 0 || disc >= sonar_.robot_from_sonar.size()) {
      continue;
    }
    const bool is_echo = reading.has_echo && reading.range < kUsableRange * sonar_.maximum_range;
    if (is_echo && reading.range >= sonar_.minimum_range) {
      heard_utime_[disc] = reading.utime;
      echoes_.push_back(reading);
    } else if (!is_echo && heard_utime_[disc] != 0 && reading.utime - heard_utime_[disc] < kAlive) {
      echoes_.push_back({reading.disc, kSurelyHeard * sonar_.maximum_range, false, reading.utime});
    }
  }
  if (echoes_.size() > kMaxEchoes) {
    echoes_.erase(echoes_.begin(), echoes_.end() - kMaxEchoes);
  }
}

void EchoCollector::advance(const Pose2& delta) {
  distance_since_ += std::hypot(delta.x, delta.y);
  turn_since_ += std::abs(delta.theta);
}

void EchoCollector::clear() {
  echoes_.clear();
  forget_places();
}

void EchoCollector::begin_for(int list) {
  if (list != list_) {
    list_ = list;
    forget_places();
  }
}

void EchoCollector::forget_places() {
  places_.clear();
  surfaces_.clear();
  distance_since_ = kFarAway;
  turn_since_ = 0.0;
}

bool EchoCollector::has_listened_at(const Pose2& odom_from_robot) const {
  return std::any_of(places_.begin(), places_.end(), [&](const Pose2& place) {
    return is_near(place, odom_from_robot, params_.sonar_test_distance, params_.sonar_turn);
  });
}

double EchoCollector::look_at(const Eigen::Vector2d& place_in_odom, int sector, int max_looks) {
  const int column = static_cast<int>(std::floor(place_in_odom.x() / params_.sonar_surface));
  const int row = static_cast<int>(std::floor(place_in_odom.y() / params_.sonar_surface));
  auto surface = std::find_if(surfaces_.begin(), surfaces_.end(), [&](const Surface& s) {
    return s.column == column && s.row == row && s.sector == sector;
  });
  if (surface == surfaces_.end()) {
    if (surfaces_.size() >= kMaxSurfaces) {
      surfaces_.erase(surfaces_.begin());
    }
    surface = surfaces_.insert(surfaces_.end(), {column, row, sector, 0});
  }
  return ++surface->looks <= max_looks ? 1.0 / max_looks : 0.0;
}

std::vector<PlacedEcho> EchoCollector::place_readings(int disc, std::int64_t utime, const OdometryReading& now,
                                                      const OdometryHistory& history) const {
  std::vector<PlacedEcho> readings;
  const Pose2& robot_from_sonar = sonar_.robot_from_sonar[static_cast<std::size_t>(disc)];
  for (auto reading = echoes_.rbegin(); reading != echoes_.rend(); ++reading) {
    if (reading->disc != disc || reading->utime > utime || utime - reading->utime > kOldest) {
      continue;
    }
    if (const auto then = history.at(reading->utime)) {
      const Pose2 now_from_sonar = now.odom_from_robot.inverse() * then->odom_from_robot * robot_from_sonar;
      readings.push_back({now_from_sonar.position(), now_from_sonar * Eigen::Vector2d(reading->range, 0.0),
                          reading->range, reading->has_echo ? 1.0 : 0.0});
    }
  }
  return readings;
}

std::vector<PlacedEcho> EchoCollector::take(std::int64_t utime, const OdometryHistory& history, std::size_t max) {
  if (distance_since_ < params_.sonar_test_distance && turn_since_ < params_.sonar_turn) {
    return {};
  }
  const auto now = history.at(utime);
  if (!now || has_listened_at(now->odom_from_robot)) {
    return {};
  }
  std::vector<PlacedEcho> echoes;    // the newest reading of each disc
  std::vector<PlacedEcho> passages;  // doorways passed since the last collection
  for (std::size_t disc = 0; disc < sonar_.robot_from_sonar.size(); ++disc) {
    const std::vector<PlacedEcho> readings = place_readings(static_cast<int>(disc), utime, *now, history);
    if (readings.empty()) {
      continue;
    }
    const auto goes_farther = [&](const PlacedEcho& reading) {
      return reading.range > readings.front().range + kFarther;
    };
    echoes.push_back(readings.front());
    // One beam in a hundred is silent by chance: whoever picks the freest of several must see two in a row.
    const auto pair =
        std::adjacent_find(readings.begin(), readings.end(), [&](const PlacedEcho& later, const PlacedEcho& earlier) {
          return goes_farther(later) && goes_farther(earlier);
        });
    if (pair != readings.end()) {
      passages.insert(passages.end(), pair, pair + 2);
      passages.end()[-1].weight = passages.end()[-2].weight = 0.0;
    }
  }
  if (echoes.size() < kFewestEchoes) {
    return {};
  }
  std::erase_if(echoes_, [&](const SonarEcho& reading) { return reading.utime <= utime; });
  distance_since_ = 0.0;
  turn_since_ = 0.0;
  if (places_.size() >= kMaxPlaces) {
    places_.erase(places_.begin());
  }
  places_.push_back(now->odom_from_robot);
  // before they count for their surfaces: what nobody hears must not use them up
  thin_out(echoes, max);
  thin_out(passages, max);
  echoes.insert(echoes.begin(), passages.begin(), passages.end());
  for (PlacedEcho& echo : echoes) {
    const Eigen::Vector2d along = (echo.end - echo.disc) / echo.range;
    const double heading = wrap_angle(now->odom_from_robot.theta + std::atan2(along.y(), along.x()));
    const int sector = static_cast<int>(std::floor((heading + kPi) / kSector));
    echo.weight = echo.weight > 0.0 ? look_at(now->odom_from_robot * echo.end, kNoSector, params_.sonar_looks) : 0.0;
    echo.passage_weight =
        look_at(now->odom_from_robot * Eigen::Vector2d(echo.disc + kPassage * along), sector, kPassageLooks);
  }
  std::erase_if(echoes, [](const PlacedEcho& echo) { return echo.weight == 0.0 && echo.passage_weight == 0.0; });
  return echoes;
}

}  // namespace luminav
