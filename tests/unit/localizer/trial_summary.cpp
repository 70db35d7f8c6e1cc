#include "tests/unit/localizer/trial_summary.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace luminav::testing {
namespace {

double quantile(std::vector<double> values, double share) {
  if (values.empty()) {
    return 0.0;
  }
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

void append(std::vector<double>& to, const std::vector<double>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

double mean_us(const StepTimes& times) {
  return 1e6 * times.sum / std::max(1.0, static_cast<double>(times.count));
}

}  // namespace

void TrialSummary::add(const TrialResult& result) {
  ++runs_;
  if (result.localized) {
    ++localized_;
    distances_.push_back(result.localized_after);
    times_.push_back(result.localized_time);
  }
  if (result.resolvable) {
    resolvable_.push_back(result.resolvable_after);
  }
  correct_ += result.correct_first ? 1 : 0;
  at_end_ += result.tracking_at_end ? 1 : 0;
  sum_.recovered += result.recovered;
  append(sum_.recovery_distance, result.recovery_distance);
  append(sum_.position_errors, result.position_errors);
  append(sum_.heading_errors, result.heading_errors);
  sum_.confident_wrong += result.confident_wrong;
  sum_.search_steps.add(result.search_steps);
  sum_.tracking_steps.add(result.tracking_steps);
  sum_.tracking += result.tracking;
  sum_.after_first += result.after_first;
  sum_.position_square += result.position_square;
  sum_.heading_square += result.heading_square;
  sum_.in_view += result.in_view;
  sum_.nees += result.nees;
  sum_.nees_forward += result.nees_forward;
  sum_.nees_left += result.nees_left;
  sum_.nees_heading += result.nees_heading;
}

bool TrialSummary::is_flawless(const TrialResult& result) const {
  return result.localized && result.correct_first && result.confident_wrong <= 0.0 && result.recovered >= kidnaps_;
}

void TrialSummary::print(const char* searcher) const {
  print_starts();
  print_tracking();
  if (kidnaps_ > 0) {
    std::printf("carries recovered %d of %ld, after m: median %.2f p95 %.2f\n", sum_.recovered, kidnaps_ * localized_,
                quantile(sum_.recovery_distance, 0.5), quantile(sum_.recovery_distance, 0.95));
  }
  print_steps(searcher);
}

void TrialSummary::print_starts() const {
  std::printf("runs %ld  localized %ld  correct %ld  tracking at end %ld  confident wrong %.1f s in all\n", runs_,
              localized_, correct_, at_end_, sum_.confident_wrong);
  std::printf("localized after m: median %.2f p95 %.2f max %.2f; s: median %.1f p95 %.1f\n", quantile(distances_, 0.5),
              quantile(distances_, 0.95), quantile(distances_, 1.0), quantile(times_, 0.5), quantile(times_, 0.95));
  std::printf("resolvable after m: median %.2f p95 %.2f in %zu runs; localized / resolvable: median %.2f p95 %.2f\n",
              quantile(resolvable_, 0.5), quantile(resolvable_, 0.95), resolvable_.size(),
              quantile(distances_, 0.5) / std::max(0.01, quantile(resolvable_, 0.5)),
              quantile(distances_, 0.95) / std::max(0.01, quantile(resolvable_, 0.95)));
}

void TrialSummary::print_tracking() const {
  const double in_view = std::max<double>(1.0, static_cast<double>(sum_.in_view));
  const double samples = std::max<double>(1.0, static_cast<double>(sum_.position_errors.size()));
  std::printf("tracking ratio %.4f  in view rms %.1f mm %.2f deg  p95 %.1f mm %.2f deg  max %.0f mm  nees/dof %.2f\n",
              sum_.tracking / std::max(0.1, sum_.after_first), 1e3 * std::sqrt(sum_.position_square / in_view),
              degrees(std::sqrt(sum_.heading_square / in_view)), 1e3 * quantile(sum_.position_errors, 0.95),
              degrees(quantile(sum_.heading_errors, 0.95)), 1e3 * quantile(sum_.position_errors, 1.0),
              sum_.nees / samples);
  std::printf("squared error / variance: forward %.2f left %.2f heading %.2f\n", sum_.nees_forward / samples,
              sum_.nees_left / samples, sum_.nees_heading / samples);
}

void TrialSummary::print_steps(const char* searcher) const {
  const double search = mean_us(sum_.search_steps);
  const double follow = mean_us(sum_.tracking_steps);
  std::printf("step us: %s %.1f (worst %.0f)  Kalman filter %.1f (worst %.0f)  ratio %.1f\n", searcher, search,
              1e6 * sum_.search_steps.worst, follow, 1e6 * sum_.tracking_steps.worst, search / std::max(1e-3, follow));
  std::printf("%.2f s of computing for %.0f s of driving\n", sum_.search_steps.sum + sum_.tracking_steps.sum,
              duration_ * static_cast<double>(runs_));
}

}  // namespace luminav::testing
