#include "services/localizer/hypotheses/hypothesis.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kPassedBy = 1.5;  // [m] driven since a fixture was expected last: its pass is over
constexpr std::size_t kMaxConfirmed = 16;
constexpr double kUnlisted = -3.5;
constexpr double kUnlistedInRow = -1.5;  // little more than a fixture that fits costs: a lamp was to be expected there

double share_of_vote(int images, const HypothesisParams& params) {
  return std::min(1.0, static_cast<double>(images) / params.frames_for_full_vote);
}

template <typename Element, typename Claim>
Element& find_or_add(std::vector<Element>& elements, const Claim& claim) {
  const auto found = std::find_if(elements.begin(), elements.end(), claim);
  return found != elements.end() ? *found : elements.emplace_back();
}

/// Moves the score of the votes and absences for which the claims hold to `closed_score`.
template <typename VoteClaim, typename AbsenceClaim>
void settle(Hypothesis& hypothesis, const VoteClaim& is_over, const AbsenceClaim& is_passed,
            const HypothesisParams& params) {
  if (std::none_of(hypothesis.votes.begin(), hypothesis.votes.end(), is_over) &&
      std::none_of(hypothesis.absences.begin(), hypothesis.absences.end(), is_passed)) {
    return;
  }
  Hypothesis over;
  std::copy_if(hypothesis.votes.begin(), hypothesis.votes.end(), std::back_inserter(over.votes), is_over);
  std::copy_if(hypothesis.absences.begin(), hypothesis.absences.end(), std::back_inserter(over.absences), is_passed);
  std::erase_if(hypothesis.votes, is_over);
  std::erase_if(hypothesis.absences, is_passed);
  hypothesis.closed_score += score_of(over, 0.0, params);
}

}  // namespace

void add_evidence(Hypothesis& hypothesis, const ObjectTrack& object, int fixture, double log_likelihood, double weight,
                  int images) {
  ObjectVote& vote = find_or_add(hypothesis.votes, [&](const ObjectVote& v) { return v.object == object.id; });
  vote.object = object.id;
  vote.weight += weight;
  vote.weighted_sum += weight * log_likelihood;
  vote.frames += images;
  vote.fixture = fixture;
  if (fixture >= 0) {
    vote.matches += images;
    if (vote.matches >= 3 && 2 * vote.matches > vote.frames && hypothesis.confirmed.size() < kMaxConfirmed &&
        std::find(hypothesis.confirmed.begin(), hypothesis.confirmed.end(), fixture) == hypothesis.confirmed.end()) {
      hypothesis.confirmed.push_back(fixture);
    }
  }
}

void add_absence(Hypothesis& hypothesis, std::span<const int> expected, std::span<const int> missed, double odometer,
                 int images) {
  for (const int index : expected) {
    FixtureAbsence& absence =
        find_or_add(hypothesis.absences, [&](const FixtureAbsence& w) { return w.fixture == index; });
    absence.fixture = index;
    absence.expected += images;
    absence.odometer = odometer;
    absence.missed += std::find(missed.begin(), missed.end(), index) != missed.end() ? images : 0;
  }
}

double held_by_sonar(const Hypothesis& hypothesis, double best_sonar, const HypothesisParams& params) {
  return std::max(-params.sonar_cap, std::min(0.0, hypothesis.sonar - best_sonar));
}

double score_of(const Hypothesis& hypothesis, double best_sonar, const HypothesisParams& params) {
  double log_posterior =
      hypothesis.closed_score + hypothesis.walls + hypothesis.log_prior + held_by_sonar(hypothesis, best_sonar, params);
  for (const ObjectVote& vote : hypothesis.votes) {
    log_posterior += vote.weighted_sum / std::max(1e-9, vote.weight) * share_of_vote(vote.frames, params);
  }
  for (const FixtureAbsence& absence : hypothesis.absences) {
    const double share = static_cast<double>(absence.missed) / std::max(1, absence.expected);
    log_posterior += std::log(1.0 - (1.0 - params.miss_probability) * share) *
                     std::min(1.0, static_cast<double>(absence.expected) / params.frames_for_full_miss);
  }
  return log_posterior;
}

double log_likelihood_unlisted(const ObjectTrack& object) {
  return object.extends_row ? kUnlistedInRow : kUnlisted;
}

double score_of_misfits(std::span<const ObjectTrack> objects, bool may_be_unlisted, const HypothesisParams& params) {
  double score = 0.0;
  for (const ObjectTrack& object : objects) {
    score += (may_be_unlisted ? log_likelihood_unlisted(object) : params.misfit) * share_of_vote(object.frames, params);
  }
  return score;
}

bool is_same_place(const Pose2& a, const Pose2& b, const HypothesisParams& params) {
  return is_near(a, b, params.merge_distance, params.merge_angle);
}

void settle_what_is_over(Hypothesis& hypothesis, std::span<const ObjectTrack> forgotten, double odometer,
                         const HypothesisParams& params) {
  const auto is_forgotten = [&](const ObjectVote& vote) {
    return std::any_of(forgotten.begin(), forgotten.end(), [&](const ObjectTrack& o) { return o.id == vote.object; });
  };
  const auto is_passed = [&](const FixtureAbsence& absence) { return odometer - absence.odometer > kPassedBy; };
  settle(hypothesis, is_forgotten, is_passed, params);
}

void settle_all(Hypothesis& hypothesis, const HypothesisParams& params) {
  const auto always = [](const auto&) { return true; };
  settle(hypothesis, always, always, params);
}

}  // namespace luminav
