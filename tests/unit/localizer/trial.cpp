#include "tests/unit/localizer/trial.hpp"

#include <time.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/unit/localizer/alias_oracle.hpp"

namespace luminav::testing {

namespace {

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Watches a drive beside the truth, and says what it came to.
class TrialJudge {
 public:
  TrialJudge(const SyntheticWorld& world, const TrialPlan& plan)
      : world_(world),
        visibility_(world.visibility()),
        grace_(plan.grace),
        trace_(plan.trace),
        start_(world.utime()),
        oracle_(world) {
    oracle_.follow(world.truth());
  }

  /// Seconds since the drive began.
  [[nodiscard]] double now() const { return 1e-6 * static_cast<double>(world_.utime() - start_); }
  void kidnapped();
  void imaged(const SightingFrame& frame);
  /// Once for each odometry, before the localizer hears of it.
  void resolve();
  /// Once for each odometry, with what the localizer makes of it and how long that took [s].
  void judge(const LocalizerEstimate& estimate, double took);
  [[nodiscard]] const TrialResult& result() const { return result_; }

 private:
  /// What a carry has to do with the moment.
  struct Kidnap {
    bool is_recovering = false;         // it was localized before, and has not been since
    bool awaits_contradiction = false;  // no image has told of it yet
    std::int64_t utime = 0;             // [us]
    bool was_imaged = false;            // an image was taken since
    bool was_seen = false;              // one of them showed something
    double driven = 0.0;                // [m] of the odometer
    double contradicted = -1e9;         // [s]; before a carry nothing is forgiven
  };
  /// The belief beside the truth.
  struct Error {
    double position = 0.0;  // [m]
    double heading = 0.0;   // [rad] at least 0

    [[nodiscard]] bool is_wrong() const { return position > 0.5 || heading > radians(20.0); }
    [[nodiscard]] bool is_right_at_first() const { return position < 0.25 && heading < radians(10.0); }
  };

  void contradict(const Pose2& believed);
  void say(const LocalizerEstimate& estimate, const Error& error);
  void judge_start(const Error& error);
  void judge_tracking(bool is_tracking, const Error& error);
  void add_errors(const PoseBelief& belief, const Error& error);

  static constexpr double kPeriod = 0.1;  // [s] between two odometry readings

  const SyntheticWorld& world_;
  FixtureVisibility visibility_;
  double grace_;
  bool trace_;
  std::int64_t start_;  // [us]
  AliasOracle oracle_;
  bool was_kidnapped_ = false;
  Kidnap kidnap_;
  LocalizerState last_state_ = LocalizerState::kLost;
  std::string last_reason_;
  TrialResult result_;
};

void TrialJudge::kidnapped() {
  const double contradicted = kidnap_.contradicted;
  kidnap_ = {.is_recovering = result_.localized,
             .awaits_contradiction = true,
             .utime = world_.utime(),
             .driven = world_.driven(),
             .contradicted = contradicted};
  was_kidnapped_ = true;
  if (trace_) {
    const Pose2& place = world_.truth();
    std::printf("%7.2f carried to %.2f %.2f %.0f\n", now(), place.x, place.y, degrees(place.theta));
  }
}

void TrialJudge::imaged(const SightingFrame& frame) {
  if (frame.utime > kidnap_.utime) {
    kidnap_.was_imaged = true;
    kidnap_.was_seen = kidnap_.was_seen || !frame.sightings.empty();
  }
}

void TrialJudge::resolve() {
  if (!result_.resolvable && !was_kidnapped_) {
    oracle_.follow(world_.truth());
    result_.resolvable = oracle_.is_resolved();
    result_.resolvable_after = world_.driven();
  }
}

// What is seen where the robot is and fits the believed pose as well contradicts nothing, nor does an image without
// sightings where none is expected.
void TrialJudge::contradict(const Pose2& believed) {
  const bool tells = kidnap_.was_seen || (kidnap_.was_imaged && !visibility_.visible_from(believed, 0.8).empty());
  if (kidnap_.awaits_contradiction && tells && visibility_.contradicts(world_.truth(), believed)) {
    kidnap_.awaits_contradiction = false;
    kidnap_.contradicted = now();
  }
}

void TrialJudge::say(const LocalizerEstimate& estimate, const Error& error) {
  const bool is_tracking = estimate.state == LocalizerState::kTracking;
  if (trace_ && (estimate.state != last_state_ || (!is_tracking && estimate.reason != last_reason_))) {
    std::printf("%7.2f s %6.2f m  state %d  error %.2f m %.1f deg  %s\n", now(), world_.driven(),
                static_cast<int>(estimate.state), error.position, degrees(error.heading), estimate.reason.c_str());
  }
  last_state_ = estimate.state;
  last_reason_ = estimate.reason;
}

void TrialJudge::judge(const LocalizerEstimate& estimate, double took) {
  const bool is_tracking = estimate.state == LocalizerState::kTracking;
  StepTimes& times = is_tracking ? result_.tracking_steps : result_.search_steps;
  times.add({took, took, 1});
  const Pose2& truth = world_.truth();
  const Error error{distance(estimate.belief.pose, truth),
                    std::abs(wrap_angle(estimate.belief.pose.theta - truth.theta))};
  contradict(estimate.belief.pose);
  say(estimate, error);
  if (is_tracking && !result_.localized) {
    judge_start(error);
  }
  if (result_.localized) {
    judge_tracking(is_tracking, error);
    if (is_tracking && !error.is_wrong() && !kidnap_.is_recovering) {
      add_errors(estimate.belief, error);
    }
  }
}

void TrialJudge::judge_start(const Error& error) {
  result_.localized = true;
  result_.correct_first = error.is_right_at_first();
  result_.localized_after = world_.driven();
  result_.localized_time = now();
}

void TrialJudge::judge_tracking(bool is_tracking, const Error& error) {
  const bool is_forgiven = kidnap_.awaits_contradiction || now() - kidnap_.contradicted < grace_;
  if (is_tracking && error.is_wrong() && !is_forgiven) {
    result_.confident_wrong += kPeriod;
  }
  if (kidnap_.is_recovering && is_tracking && !error.is_wrong()) {
    kidnap_.is_recovering = false;
    ++result_.recovered;
    result_.recovery_distance.push_back(world_.driven() - kidnap_.driven);
  }
  if (!kidnap_.is_recovering) {
    result_.after_first += kPeriod;
    result_.tracking_at_end = is_tracking;
  }
}

void TrialJudge::add_errors(const PoseBelief& belief, const Error& error) {
  const Pose2& truth = world_.truth();
  result_.tracking += kPeriod;
  result_.position_errors.push_back(error.position);
  result_.heading_errors.push_back(error.heading);
  const Eigen::Vector3d off(belief.pose.x - truth.x, belief.pose.y - truth.y,
                            wrap_angle(belief.pose.theta - truth.theta));
  result_.nees += off.dot(belief.covariance.inverse() * off) / 3.0;
  const Eigen::Vector2d forward(std::cos(truth.theta), std::sin(truth.theta));
  const Eigen::Vector2d left(-forward.y(), forward.x());
  const Eigen::Matrix2d place = belief.covariance.topLeftCorner<2, 2>();
  result_.nees_forward += std::pow(off.head<2>().dot(forward), 2) / forward.dot(place * forward);
  result_.nees_left += std::pow(off.head<2>().dot(left), 2) / left.dot(place * left);
  result_.nees_heading += off.z() * off.z() / belief.covariance(2, 2);
  if (!visibility_.visible_from(truth, 0.3).empty()) {
    ++result_.in_view;
    result_.position_square += error.position * error.position;
    result_.heading_square += error.heading * error.heading;
  }
}

}  // namespace

void StepTimes::add(const StepTimes& other) {
  sum += other.sum;
  worst = std::max(worst, other.worst);
  count += other.count;
}

TrialResult run_trial(SyntheticWorld& world, Localizer& localizer, const TrialPlan& plan) {
  TrialJudge judge(world, plan);
  std::size_t next_kidnap = 0;
  while (judge.now() < plan.duration) {
    if (next_kidnap < plan.kidnaps.size() && judge.now() >= plan.kidnaps[next_kidnap]) {
      ++next_kidnap;
      world.kidnap(world.draw_free_pose());
      judge.kidnapped();
    }
    SyntheticWorld::Output output = world.step();
    if (output.frame && plan.whole_only) {
      std::erase_if(output.frame->sightings, [](const FixtureSighting& sighting) { return sighting.clipped; });
    }
    if (output.sonar) {
      localizer.add_sonar(*output.sonar);
    }
    if (output.frame) {
      localizer.add_frame(*output.frame);
      judge.imaged(*output.frame);
    }
    if (output.odometry) {
      judge.resolve();
      // images wait for the odometry after them, so this call works on those that came since the last
      const double begin = thread_seconds();
      localizer.add_odometry(*output.odometry);
      const double took = thread_seconds() - begin;
      judge.judge(localizer.estimate(), took);
    }
  }
  return judge.result();
}

}  // namespace luminav::testing
