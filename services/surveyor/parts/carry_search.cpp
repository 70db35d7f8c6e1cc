#include "services/surveyor/parts/carry_search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <set>

#include "services/common/ceiling/ceiling_view.hpp"

namespace luminav {
namespace {

constexpr double kMiddle = 0.25;             // [m] to the border of the view: there nothing comes or goes by itself
constexpr double kStill = 0.02;              // [m] that wheels at rest may tell,
constexpr double kStillTurn = radians(1.0);  // [rad] likewise
constexpr double kElsewhere = 0.3;           // [m] beyond which a fixture is another one, or was moved past,
constexpr double kElsewhereTurn = radians(20.0);  // [rad] likewise
constexpr int kLooks = 3;                         // key frames that have to agree
constexpr std::int64_t kLift = 1'000'000;         // [us] that wheels rest at least when somebody lifts the robot

bool is_the_same(const FixtureSighting& a, const FixtureSighting& b) {
  const double turned =
      std::abs(wrap_modulo(a.robot_from_fixture.theta - b.robot_from_fixture.theta, symmetry_period(a.shape)));
  return a.shape == b.shape && distance(a.robot_from_fixture, b.robot_from_fixture) < kElsewhere &&
         (!a.has_theta || !b.has_theta || turned < kElsewhereTurn);
}

/// Whether one of those seen before hangs where one of those seen after does, all in one frame.
bool share_one(const std::vector<FixtureSighting>& before, const std::vector<FixtureSighting>& after) {
  return std::any_of(before.begin(), before.end(), [&](const FixtureSighting& a) {
    return std::any_of(after.begin(), after.end(), [&](const FixtureSighting& b) { return is_the_same(a, b); });
  });
}

std::vector<FixtureSighting> whole_of(const std::vector<FixtureSighting>& sightings) {
  std::vector<FixtureSighting> whole;
  std::copy_if(sightings.begin(), sightings.end(), std::back_inserter(whole),
               [](const FixtureSighting& sighting) { return !sighting.clipped; });
  return whole;
}

/// What a robot whose wheels stand sees first and last.
class Standstill {
 public:
  void begin(const Pose2& odom_from_robot) {
    odom_from_robot_ = odom_from_robot;
    first_.reset();
    last_.reset();
  }
  [[nodiscard]] bool has_ended(const Pose2& odom_from_robot) const {
    const Pose2 since = odom_from_robot_.inverse() * odom_from_robot;
    return std::hypot(since.x, since.y) > kStill || std::abs(since.theta) > kStillTurn;
  }
  void add(const SightingFrame& frame) {
    if (!whole_of(frame.sightings).empty()) {
      first_ = first_.value_or(frame);
      last_ = frame;
    }
  }
  /// Fixtures that are whole in view have gone, and others have come. One that is cut off hangs there still.
  [[nodiscard]] bool was_lifted() const {
    return first_ && last_->utime - first_->utime >= kLift &&
           !share_one(whole_of(first_->sightings), last_->sightings) &&
           !share_one(first_->sightings, whole_of(last_->sightings));
  }
  [[nodiscard]] std::int64_t last_utime() const { return last_->utime; }

 private:
  Pose2 odom_from_robot_;
  std::optional<SightingFrame> first_;
  std::optional<SightingFrame> last_;
};

class CarrySearch {
 public:
  CarrySearch(const std::vector<KeyFrame>& frames, const std::vector<FixturePass>& passes, const SurveyModel& model)
      : frames_(frames), passes_(passes), model_(model), view_(model.robot.camera) {}

  [[nodiscard]] std::vector<int> search() const {
    std::map<int, std::vector<FixtureSighting>> vanished;  // by the first key frame without them; frame of odometry
    std::map<int, std::vector<FixtureSighting>> appeared;  // by the first with them
    for (const FixturePass& pass : passes_) {
      const PassSighting& first = pass.sightings.front();
      const PassSighting& last = pass.sightings.back();
      if (stays_in_view(pass, last, 1)) {
        vanished[last.frame + 1].push_back(in_odometry(last));
      }
      if (stays_in_view(pass, first, -1)) {
        appeared[first.frame].push_back(in_odometry(first));
      }
    }
    std::vector<int> carries;
    for (const auto& [frame, after] : appeared) {
      const auto before = vanished.find(frame);
      // one that hangs where it hung was only seen badly: a sighting far from the one before begins a new pass
      if (before != vanished.end() && !share_one(before->second, after)) {
        carries.push_back(frame);
      }
    }
    return carries;
  }

 private:
  [[nodiscard]] FixtureSighting in_odometry(const PassSighting& seen) const {
    FixtureSighting sighting = seen.sighting;
    sighting.robot_from_fixture =
        frames_[static_cast<std::size_t>(seen.frame)].odom_from_robot * sighting.robot_from_fixture;
    return sighting;
  }

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

std::vector<std::int64_t> find_lifts(const SurveyDrive& drive) {
  std::vector<std::int64_t> lifts;
  if (drive.odometry.empty()) {
    return lifts;
  }
  Standstill standstill;
  standstill.begin(drive.odometry.front().odom_from_robot);
  std::size_t next = 0;
  for (const OdometryReading& reading : drive.odometry) {
    if (standstill.has_ended(reading.odom_from_robot)) {
      if (standstill.was_lifted()) {
        lifts.push_back(standstill.last_utime());
      }
      standstill.begin(reading.odom_from_robot);
    }
    for (; next < drive.frames.size() && drive.frames[next].utime <= reading.utime; ++next) {
      standstill.add(drive.frames[next]);
    }
  }
  return lifts;
}

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
