#include "services/controller/safety/sonar_watch.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kDoubt = 3.0;     // pieces of evidence from which a disc is doubted
constexpr double kLife = 2.0;      // pieces that a range which changes takes back
constexpr int kDeadDiscs = 2;      // so many leave a gap that no neighbour covers
constexpr double kSpacing = 0.10;  // [m] or
constexpr double kTurn = 0.17;     // [rad] between two readings of a disc that say something new
constexpr double kFarther = 0.4;   // [m] behind a wall that faces it: that was not heard
constexpr double kAlong = 0.15;    // [m] of own way along its axis, over which a disc's range has to change
// Without pose or map: so far no half of a ring is silent between walls and furniture.
constexpr double kQuietWay = 4.0;   // [m]
constexpr double kQuietTurn = 0.5;  // [m/rad] what turning counts for in it

std::string numbers_of(const std::vector<std::size_t>& discs) {
  std::string text;
  for (std::size_t i = 0; i < discs.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == discs.size() ? " and " : ", ") + std::to_string(discs[i]);
  }
  return text;
}

}  // namespace

void SonarWatch::forget_motion() {
  for (Disc& disc : discs_) {
    disc.last.reset();
    disc.counted.reset();
    disc.same.reset();
  }
  for (Half* half : {&ahead_, &back_}) {
    half->quiet = 0.0;
    half->odom_from_robot.reset();
    half->counted.reset();
  }
}

SonarWatch::Half& SonarWatch::half_of(std::size_t disc) {
  return ring_.robot_from_sonar[disc].x >= 0.0 ? ahead_ : back_;
}

bool SonarWatch::is_new_place(const std::optional<Pose2>& counted, const SonarFiring& firing) const {
  if (!counted) {
    return true;
  }
  const Pose2 moved = counted->inverse() * firing.odom_from_robot;
  return std::hypot(moved.x, moved.y) > kSpacing || std::abs(moved.theta) > kTurn;
}

bool SonarWatch::says_the_same(Disc& disc, const SonarFiring& firing) const {
  if (!disc.same || !hear_the_same(*disc.same, firing)) {
    disc.same.reset();
    if (firing.has_echo) {
      disc.same = firing;
    }
    return false;
  }
  if (moved_along_axis(ring_, *disc.same, firing) < kAlong) {
    return false;
  }
  disc.same->odom_from_robot = firing.odom_from_robot;
  return true;
}

bool SonarWatch::is_silent_half(std::size_t disc, const SonarFiring& firing, bool is_stuck) {
  Half& half = half_of(disc);
  if (half.odom_from_robot) {
    const Pose2 moved = half.odom_from_robot->inverse() * firing.odom_from_robot;
    half.quiet += std::hypot(moved.x, moved.y) + kQuietTurn * std::abs(moved.theta);
  }
  half.odom_from_robot = firing.odom_from_robot;
  half.quiet = firing.has_echo && !is_stuck ? 0.0 : half.quiet;
  return half.quiet > kQuietWay;
}

void SonarWatch::add(const SonarFiring& firing, const Place& place) {
  Disc& disc = discs_[firing.disc];
  // One that was stuck and falls silent changes, too: it may stand before nothing now.
  const bool is_lively =
      disc.last && (firing.has_echo ? !hear_the_same(*disc.last, firing) : disc.last->has_echo && disc.is_stuck);
  const bool is_stuck = says_the_same(disc, firing);
  const bool is_half_silent = is_silent_half(firing.disc, firing, is_stuck);
  const bool is_unheard = place.wall && (!firing.has_echo || firing.range > *place.wall + kFarther);
  const bool is_deaf = is_unheard || (!place.is_known && is_half_silent && !firing.has_echo);
  disc.last = firing;
  Half& half = half_of(firing.disc);
  if (is_lively || (place.wall && firing.has_echo && !is_unheard && !is_stuck)) {
    disc.evidence = std::max(0.0, disc.evidence - kLife);
    half.evidence = std::max(0.0, half.evidence - kLife);
  } else if (is_stuck || is_deaf) {
    disc.is_stuck = firing.has_echo;
    count(firing, disc.counted, disc.evidence);
    count(firing, half.counted, half.evidence);
  }
}

void SonarWatch::count(const SonarFiring& firing, std::optional<Pose2>& counted, double& evidence) const {
  if (is_new_place(counted, firing)) {
    evidence = std::min(kDead, evidence + 1.0);
    counted = firing.odom_from_robot;
  }
}

std::vector<std::size_t> SonarWatch::discs_above(double evidence) const {
  std::vector<std::size_t> discs;
  for (std::size_t i = 0; i < discs_.size(); ++i) {
    if (discs_[i].evidence >= evidence) {
      discs.push_back(i);
    }
  }
  return discs;
}

SonarTrust SonarWatch::trust() const {
  const double halves = ahead_.evidence + back_.evidence;
  if (halves >= kDead || static_cast<int>(discs_above(kDead).size()) >= kDeadDiscs) {
    return SonarTrust::kDead;
  }
  return halves >= kDoubt || !discs_above(kDoubt).empty() ? SonarTrust::kDoubted : SonarTrust::kTrusted;
}

std::string SonarWatch::reason() const {
  const SonarTrust trust = this->trust();
  if (trust == SonarTrust::kTrusted) {
    return "";
  }
  const bool is_half = ahead_.evidence + back_.evidence >= kDoubt;
  const std::vector<std::size_t> discs = discs_above(is_half ? 1.0 : kDoubt);
  const bool is_stuck = std::all_of(discs.begin(), discs.end(), [&](std::size_t i) { return discs_[i].is_stuck; });
  return (discs.size() == 1 ? "sonar " : "sonars ") + numbers_of(discs) +
         (is_stuck ? " measured the same while the robot moved" : " heard nothing where walls must be") +
         (trust == SonarTrust::kDead ? ": it stands" : ": it drives slowly");
}

}  // namespace luminav
