#include "tests/unit/localizer/trial.hpp"

#include <time.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <limits>

#include "tests/unit/localizer/twin_oracle.hpp"

namespace luminav::testing {

namespace {

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

TrialResult run_trial(SyntheticWorld& world, Localizer& localizer, const TrialPlan& plan) {
  TrialResult result;
  const std::int64_t start = world.utime();
  std::size_t next_carry = 0;
  bool recovering = false;
  double carried_at = 0.0;        // [m] of the odometer
  double contradicted_at = -1e9;  // [s]; before a carry nothing is forgiven
  bool awaiting_contradiction = false;
  std::int64_t carried_utime = 0;   // [us]
  bool imaged_since_carry = false;  // an image was taken
  bool seen_since_carry = false;    // one of them showed something
  TwinOracle oracle(world);
  oracle.follow(world.truth());
  LocalizerState last_state = LocalizerState::kLost;
  std::string last_reason;
  while (true) {
    const double now = 1e-6 * static_cast<double>(world.utime() - start);
    if (now >= plan.duration) {
      break;
    }
    if (next_carry < plan.carries.size() && now >= plan.carries[next_carry]) {
      ++next_carry;
      const Pose2 place = world.draw_free_pose();
      if (plan.trace) {
        std::printf("%7.2f carried to %.2f %.2f %.0f\n", now, place.x, place.y, degrees(place.theta));
      }
      world.carry(place);
      recovering = result.localized;
      awaiting_contradiction = true;
      carried_utime = world.utime();
      imaged_since_carry = false;
      seen_since_carry = false;
      carried_at = world.driven();
    }
    const SyntheticWorld::Output output = world.step();
    if (output.sonar) {
      localizer.add_sonar(*output.sonar);
    }
    if (output.frame) {
      localizer.add_frame(*output.frame);
      if (output.frame->utime > carried_utime) {
        imaged_since_carry = true;
        seen_since_carry = seen_since_carry || !output.frame->sightings.empty();
      }
    }
    if (!output.odometry) {
      continue;
    }
    if (!result.resolvable && next_carry == 0) {
      oracle.follow(world.truth());
      result.resolvable = oracle.is_resolved();
      result.resolvable_after = world.driven();
    }
    // images wait for the odometry after them, so this call works on those that came since the last
    const double begin = thread_seconds();
    localizer.add_odometry(*output.odometry);
    const double took = thread_seconds() - begin;
    const LocalizerEstimate estimate = localizer.estimate();
    StepTimes& times = estimate.state == LocalizerState::kTracking ? result.tracking_steps : result.search_steps;
    times.sum += took;
    times.worst = std::max(times.worst, took);
    ++times.count;
    const Pose2& truth = world.truth();
    const double position_error = distance(estimate.belief.pose, truth);
    const double heading_error = std::abs(wrap_angle(estimate.belief.pose.theta - truth.theta));
    const bool is_tracking = estimate.state == LocalizerState::kTracking;
    const bool is_wrong = position_error > 0.5 || heading_error > radians(20.0);
    // an image contradicts by what is seen in it, or by showing nothing of a fixture expected well inside; one without
    // sightings, of a fixture that the detector misses, tells nobody anything
    if (awaiting_contradiction &&
        (seen_since_carry || (imaged_since_carry && world.fixtures_in_view(estimate.belief.pose, 0.8) > 0))) {
      awaiting_contradiction = false;
      contradicted_at = now;
    }
    if (plan.trace && (estimate.state != last_state || (!is_tracking && estimate.reason != last_reason))) {
      std::printf("%7.2f s %6.2f m  state %d  error %.2f m %.1f deg  %s\n", now, world.driven(),
                  static_cast<int>(estimate.state), position_error, degrees(heading_error), estimate.reason.c_str());
    }
    last_state = estimate.state;
    last_reason = estimate.reason;
    if (is_tracking && !result.localized) {
      result.localized = true;
      result.correct_first = position_error < 0.25 && heading_error < radians(10.0);
      result.localized_after = world.driven();
      result.localized_time = now;
    }
    if (!result.localized) {
      continue;
    }
    const bool forgiven = awaiting_contradiction || now - contradicted_at < plan.grace;
    if (is_tracking && is_wrong && !forgiven) {
      result.confident_wrong += 0.1;
    }
    if (recovering && is_tracking && !is_wrong && now - contradicted_at > 0.0 && !awaiting_contradiction) {
      recovering = false;
      ++result.recovered;
      result.recovery_way.push_back(world.driven() - carried_at);
    }
    if (recovering) {
      continue;
    }
    result.after_first += 0.1;
    result.tracking_at_end = is_tracking;
    if (!is_tracking || is_wrong) {
      continue;
    }
    result.tracking += 0.1;
    result.position_errors.push_back(position_error);
    result.heading_errors.push_back(heading_error);
    const Eigen::Vector3d error(estimate.belief.pose.x - truth.x, estimate.belief.pose.y - truth.y,
                                wrap_angle(estimate.belief.pose.theta - truth.theta));
    result.nees += error.dot(estimate.belief.covariance.inverse() * error) / 3.0;
    const Eigen::Vector2d forward(std::cos(truth.theta), std::sin(truth.theta));
    const Eigen::Vector2d left(-forward.y(), forward.x());
    const Eigen::Matrix2d place = estimate.belief.covariance.topLeftCorner<2, 2>();
    result.nees_forward += std::pow(error.head<2>().dot(forward), 2) / forward.dot(place * forward);
    result.nees_left += std::pow(error.head<2>().dot(left), 2) / left.dot(place * left);
    result.nees_heading += error.z() * error.z() / estimate.belief.covariance(2, 2);
    if (world.fixtures_in_view(truth, 0.3) > 0) {
      ++result.in_view;
      result.position_square += position_error * position_error;
      result.heading_square += heading_error * heading_error;
    }
  }
  return result;
}

}  // namespace luminav::testing
