#include "services/surveyor/survey/carry_search.hpp"

#include <set>

#include "services/localizer/model/ceiling_view.hpp"

namespace luminav {
namespace {

constexpr double kMiddle = 0.25;  // [m] to the border of the view: there nothing comes or goes by itself
constexpr int kLooks = 3;         // key frames that have to agree

class CarrySearch {
 public:
  CarrySearch(const std::vector<KeyFrame>& frames, const std::vector<FixturePass>& passes, const SurveyModel& model)
      : frames_(frames), passes_(passes), model_(model), view_(model.robot.camera) {}

  [[nodiscard]] std::vector<int> search() const {
    std::set<int> vanished;
    std::set<int> appeared;
    for (const FixturePass& pass : passes_) {
      const PassSighting& first = pass.sightings.front();
      const PassSighting& last = pass.sightings.back();
      if (stays_in_view(pass, last, 1)) {
        vanished.insert(last.frame + 1);
      }
      if (stays_in_view(pass, first, -1)) {
        appeared.insert(first.frame);
      }
    }
    std::vector<int> carries;
    for (const int frame : appeared) {
      if (vanished.count(frame) > 0) {
        carries.push_back(frame);
      }
    }
    return carries;
  }

 private:
  /// Whether, by odometry, the fixture of a sighting lay in the middle of the view of the next key frames, forwards or
  /// backwards.
  [[nodiscard]] bool stays_in_view(const FixturePass& pass, const PassSighting& seen, int direction) const {
    const Fixture& kind = model_.kinds.kinds[static_cast<std::size_t>(pass.kind)];
    const KeyFrame& from = frames_[static_cast<std::size_t>(seen.frame)];
    const Pose2 odom_from_fixture = from.odom_from_robot * seen.sighting.robot_from_fixture;
    for (int k = 1; k <= kLooks; ++k) {
      const int index = seen.frame + direction * k;
      if (index < 0 || index >= static_cast<int>(frames_.size())) {
        return false;
      }
      const KeyFrame& frame = frames_[static_cast<std::size_t>(index)];
      if (frame.part != from.part ||
          !view_.is_wholly_visible(frame.odom_from_robot.inverse() * odom_from_fixture, kind, kMiddle)) {
        return false;
      }
    }
    return true;
  }

  const std::vector<KeyFrame>& frames_;
  const std::vector<FixturePass>& passes_;
  const SurveyModel& model_;
  CeilingView view_;
};

}  // namespace

std::vector<int> find_carries(const std::vector<KeyFrame>& frames, const std::vector<FixturePass>& passes,
                              const SurveyModel& model) {
  return CarrySearch(frames, passes, model).search();
}

void split_at(std::vector<KeyFrame>& frames, const std::vector<int>& carries) {
  const std::set<int> first(carries.begin(), carries.end());
  int more = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (first.count(static_cast<int>(i)) > 0) {
      ++more;
      frames[i].steps.clear();
    }
    frames[i].part += more;
  }
}

}  // namespace luminav
