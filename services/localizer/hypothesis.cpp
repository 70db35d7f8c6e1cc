#include "services/localizer/hypothesis.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace luminav {
namespace {

constexpr double kPassedBy = 1.5;  // [m] driven since a fixture was expected last: its pass is over
constexpr std::size_t kMaxConfirmed = 16;

}  // namespace

void vote(Hypothesis& hypothesis, const SeenObject& object, int fixture, double log_likelihood, double weight,
          int images) {
  auto found = std::find_if(hypothesis.votes.begin(), hypothesis.votes.end(),
                            [&](const ObjectVote& v) { return v.object == object.id; });
  if (found == hypothesis.votes.end()) {
    hypothesis.votes.push_back({});
    found = hypothesis.votes.end() - 1;
    found->object = object.id;
  }
  found->weight += weight;
  found->weighted_sum += weight * log_likelihood;
  found->frames += images;
  found->fixture = fixture;
  if (fixture >= 0) {
    found->matches += images;
    if (found->matches >= 3 && 2 * found->matches > found->frames && hypothesis.confirmed.size() < kMaxConfirmed &&
        std::find(hypothesis.confirmed.begin(), hypothesis.confirmed.end(), fixture) == hypothesis.confirmed.end()) {
      hypothesis.confirmed.push_back(fixture);
    }
  }
}

void watch(Hypothesis& hypothesis, std::span<const int> expected, std::span<const int> missed, double odometer,
           int images) {
  for (const int index : expected) {
    auto watch = std::find_if(hypothesis.watches.begin(), hypothesis.watches.end(),
                              [&](const FixtureWatch& w) { return w.fixture == index; });
    if (watch == hypothesis.watches.end()) {
      hypothesis.watches.push_back({index, 0, 0, odometer});
      watch = hypothesis.watches.end() - 1;
    }
    watch->expected += images;
    watch->odometer = odometer;
    watch->missed += std::find(missed.begin(), missed.end(), index) != missed.end() ? images : 0;
  }
}

double held_by_sonar(const Hypothesis& hypothesis, double best_sonar, const HypothesisParams& params) {
  return std::max(-params.sonar_cap, std::min(0.0, hypothesis.sonar - best_sonar));
}

double score_of(const Hypothesis& hypothesis, double best_sonar, const HypothesisParams& params) {
  double total =
      hypothesis.settled + hypothesis.walls + hypothesis.bonus + held_by_sonar(hypothesis, best_sonar, params);
  for (const ObjectVote& vote : hypothesis.votes) {
    total += vote.weighted_sum / std::max(1e-9, vote.weight) *
             std::min(1.0, static_cast<double>(vote.frames) / params.frames_for_full_vote);
  }
  for (const FixtureWatch& watch : hypothesis.watches) {
    const double share = static_cast<double>(watch.missed) / std::max(1, watch.expected);
    total += std::log(1.0 - (1.0 - params.miss_probability) * share) *
             std::min(1.0, static_cast<double>(watch.expected) / params.frames_for_full_miss);
  }
  return total;
}

bool is_same_place(const Pose2& a, const Pose2& b, const HypothesisParams& params) {
  return distance(a, b) < params.merge_distance && std::abs(wrap_angle(a.theta - b.theta)) < params.merge_angle;
}

namespace {

void settle(Hypothesis& hypothesis, std::vector<ObjectVote> votes, std::vector<FixtureWatch> watches,
            const HypothesisParams& params) {
  if (votes.empty() && watches.empty()) {
    return;
  }
  Hypothesis over;
  over.votes = std::move(votes);
  over.watches = std::move(watches);
  hypothesis.settled += score_of(over, 0.0, params);
}

}  // namespace

void settle_what_is_over(Hypothesis& hypothesis, std::span<const SeenObject> forgotten, double odometer,
                         const HypothesisParams& params) {
  std::vector<ObjectVote> votes;
  const auto is_forgotten = [&](const ObjectVote& vote) {
    return std::any_of(forgotten.begin(), forgotten.end(), [&](const SeenObject& o) { return o.id == vote.object; });
  };
  if (!forgotten.empty()) {
    std::copy_if(hypothesis.votes.begin(), hypothesis.votes.end(), std::back_inserter(votes), is_forgotten);
    std::erase_if(hypothesis.votes, is_forgotten);
  }
  std::vector<FixtureWatch> watches;
  const auto is_passed = [&](const FixtureWatch& watch) { return odometer - watch.odometer > kPassedBy; };
  std::copy_if(hypothesis.watches.begin(), hypothesis.watches.end(), std::back_inserter(watches), is_passed);
  std::erase_if(hypothesis.watches, is_passed);
  settle(hypothesis, std::move(votes), std::move(watches), params);
}

void settle_all(Hypothesis& hypothesis, const HypothesisParams& params) {
  settle(hypothesis, std::exchange(hypothesis.votes, {}), std::exchange(hypothesis.watches, {}), params);
}

}  // namespace luminav
