#pragma once

#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"
#include "services/common/ceiling/fixture_map.hpp"
#include "services/surveyor/survey/loop_closing.hpp"
#include "services/surveyor/survey/survey_graph.hpp"

namespace luminav {

/// Where a robot drove, and so would have seen what hangs there.
class PassedFloor {
 public:
  /// `sight` [m]: nearer to the robot a fixture cannot be missed.
  PassedFloor(const std::vector<Pose2>& poses, double sight);
  [[nodiscard]] bool contains(const Eigen::Vector2d& point) const;

 private:
  std::set<std::pair<long, long>> cells_;
};

/// Nearer [m] to the robot no fixture is missed.
double sight_of(const SurveyModel& model);

/// How the map of one part of a drive lies on that of another.
struct PartJoint {
  Pose2 map_from_part;
  std::vector<FixturePair> pairs;  // that are one: index in the map, index in the part
};

/// Parts of a drive whose motion from one to the other nobody measured: the robot was carried, its driver began anew,
/// or they are logs of two drives. Each has a map of its own; maps are joined by the fixtures that they share.
class PartJoining {
 public:
  /// Everything is kept by reference; `sight` [m] as above.
  PartJoining(const SurveyEstimate& map, const SurveyEstimate& part, const CeilingKinds& kinds, double sight);

  /// The motion of the plane that lays most fixtures of the part on fixtures of the map, and fewest where one of the
  /// two drove and saw none; none if another motion does nearly as well, as along a row of equal lamps. Cost: about
  /// a second for two maps of 120 fixtures.
  [[nodiscard]] std::optional<PartJoint> find() const;

  /// The same among motions that a localizer told, each good to half a metre: half as much has to agree.
  [[nodiscard]] std::optional<PartJoint> find_among(const std::vector<Pose2>& told) const;

  /// A part whose path runs through the walls of this map does not lie there; nullptr = no walls are known.
  void keep_out_of(const PriorMap* walls) { walls_ = walls; }

  /// The joint of a robot that was not moved between the last frame of the map and the first of the part, where both
  /// see the same.
  [[nodiscard]] std::optional<PartJoint> find_at_rest(const KeyFrame& last, const KeyFrame& first) const;

 private:
  struct Match {
    PartJoint joint;
    double score = 0.0;
  };
  [[nodiscard]] std::vector<Pose2> candidates() const;
  [[nodiscard]] std::optional<PartJoint> best_of(const std::vector<Pose2>& motions, double min_score) const;
  [[nodiscard]] bool crosses_walls(const Pose2& map_from_part) const;
  [[nodiscard]] Match match(const Pose2& map_from_part, double tolerance) const;
  /// Fixtures of each that the other one passed and did not see, beside a match's pairs.
  [[nodiscard]] int missed(const PartJoint& joint) const;
  /// The motion that fits a match's pairs best, and what it matches then.
  [[nodiscard]] Match refine(const Match& match) const;
  [[nodiscard]] bool is_alike(const SurveyedFixture& a, const Pose2& map_from_b, const SurveyedFixture& b) const;

  const SurveyEstimate& map_;
  const SurveyEstimate& part_;
  const CeilingKinds& kinds_;
  FixtureMap map_index_;
  PassedFloor map_floor_;
  PassedFloor part_floor_;
  const PriorMap* walls_ = nullptr;
};

}  // namespace luminav
