#include "services/surveyor/drive/plan_alignment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "services/common/building/distance_transform.hpp"
#include "services/surveyor/known_building.hpp"
#include "services/surveyor/parts/part_joining.hpp"

namespace luminav {
namespace {

constexpr double kResolution = 0.1;           // [m] of the plan's field
constexpr double kCoarseStep = 0.4;           // [m] between shifts that are tried first,
constexpr double kCoarseTurn = radians(1.0);  // [rad] likewise,
constexpr double kMaxTurn = radians(4.0);     // [rad] beside a quarter turn
constexpr double kCoarseSigma = 0.40;         // [m] by which walls may differ then,
constexpr double kFineSigma = 0.15;           // [m] and in the end: what sonars draw
constexpr std::size_t kCoarsePoints = 250;    // of the walls that are looked at first,
constexpr std::size_t kFinePoints = 4000;     // and in the end
constexpr std::size_t kMaxRefined = 30;       // motions that are refined
constexpr double kApart = 0.8;                // [m] between the middles of two motions that are not the same,
constexpr double kApartTurn = radians(20.0);  // [rad] likewise
constexpr double kMinScore = 0.5;             // share of the walls that agree, from which the best is believed,
constexpr double kMargin = 0.15;              // and by which it has to lead
constexpr double kBorder = 2.0;               // [m] that the survey may reach beyond the plan

/// Every n-th of the points, so that few enough are left.
std::vector<Eigen::Vector2d> thinned(const std::vector<Eigen::Vector2d>& points, std::size_t most) {
  std::vector<Eigen::Vector2d> few;
  const std::size_t step = std::max<std::size_t>(1, (points.size() + most - 1) / most);
  for (std::size_t i = 0; i < points.size(); i += step) {
    few.push_back(points[i]);
  }
  return few;
}

std::vector<Eigen::Vector2d> walls_of(const PriorMap& map) {
  std::vector<Eigen::Vector2d> walls;
  for (int row = 0; row < map.geometry.rows; ++row) {
    for (int column = 0; column < map.geometry.columns; ++column) {
      if (map.cells[map.geometry.index({column, row})] == Prior::kOccupied) {
        walls.push_back(map.geometry.centre_of({column, row}));
      }
    }
  }
  return walls;
}

class WallMatch {
 public:
  WallMatch(const Survey& survey, const PriorMap& map, const PriorMap& plan)
      : plan_(resample(plan, kResolution)), walls_(walls_of(map)) {
    for (const Pose2& pose : survey.estimate.poses) {
      path_.push_back(pose.position());
    }
    for (const Eigen::Vector2d& wall : walls_) {
      middle_ += wall / static_cast<double>(walls_.size());
    }
    coarse_ = agreement(kCoarseSigma);
    fine_ = agreement(kFineSigma);
  }

  [[nodiscard]] std::optional<Pose2> find() const {
    if (walls_.empty()) {
      return std::nullopt;
    }
    std::vector<Motion> motions = coarse_motions();
    for (Motion& motion : motions) {
      motion = refined(motion);
    }
    std::stable_sort(motions.begin(), motions.end(),
                     [](const Motion& a, const Motion& b) { return a.score > b.score; });
    const auto is_rival = [&](const Motion& other) {
      const Motion& best = motions.front();
      const bool is_same =
          (other.middle - best.middle).norm() < kApart && std::abs(wrap_angle(other.theta - best.theta)) < kApartTurn;
      return !is_same && other.score + kMargin > best.score;
    };
    if (motions.empty() || motions.front().score < kMinScore ||
        std::any_of(motions.begin() + 1, motions.end(), is_rival)) {
      return std::nullopt;
    }
    return pose_of(motions.front());
  }

 private:
  /// Turns the walls about their middle, and brings that somewhere on the plan.
  struct Motion {
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();  // [m] on the plan
    double theta = 0.0;                                // [rad]
    double score = -1.0;
  };

  /// 0..1 by cell: how well a wall there agrees with the plan's.
  [[nodiscard]] std::vector<float> agreement(double sigma) const {
    std::vector<bool> is_wall;
    for (const Prior cell : plan_.cells) {
      is_wall.push_back(cell == Prior::kOccupied);
    }
    std::vector<float> field = squared_distances_to(is_wall, static_cast<std::size_t>(plan_.geometry.columns));
    const auto falloff = static_cast<float>(0.5 * std::pow(kResolution / sigma, 2));
    std::transform(field.begin(), field.end(), field.begin(),
                   [&](float squared) { return std::exp(-falloff * squared); });
    return field;
  }

  [[nodiscard]] Pose2 pose_of(const Motion& motion) const {
    const Pose2 turn{0.0, 0.0, motion.theta};
    const Eigen::Vector2d shift = motion.middle - turn * middle_;
    return {shift.x(), shift.y(), motion.theta};
  }

  /// Share of the walls that agree, less what was driven through walls of the plan.
  [[nodiscard]] double score(const Motion& motion, const std::vector<float>& field,
                             const std::vector<Eigen::Vector2d>& walls,
                             const std::vector<Eigen::Vector2d>& path) const {
    const Pose2 motion_of = pose_of(motion);
    const double c = std::cos(motion_of.theta);
    const double s = std::sin(motion_of.theta);
    const auto moved = [&](const Eigen::Vector2d& point) {
      return Eigen::Vector2d(motion_of.x + c * point.x() - s * point.y(), motion_of.y + s * point.x() + c * point.y());
    };
    double agreeing = 0.0;
    for (const Eigen::Vector2d& wall : walls) {
      const Cell cell = plan_.geometry.cell_at(moved(wall));
      agreeing += plan_.geometry.contains(cell) ? static_cast<double>(field[plan_.geometry.index(cell)]) : 0.0;
    }
    double through = 0.0;
    for (const Eigen::Vector2d& point : path) {
      through += plan_.at(moved(point)) == Prior::kOccupied ? 1.0 : 0.0;
    }
    return agreeing / static_cast<double>(walls.size()) -
           through / static_cast<double>(std::max<std::size_t>(1, path.size()));
  }

  /// The best shifts of all directions, no two of them neighbours.
  [[nodiscard]] std::vector<Motion> coarse_motions() const {
    const std::vector<Eigen::Vector2d> walls = thinned(walls_, kCoarsePoints);
    const std::vector<Eigen::Vector2d> path = thinned(path_, kCoarsePoints / 4);
    const Eigen::Vector2d size = kResolution * Eigen::Vector2d(plan_.geometry.columns, plan_.geometry.rows);
    std::vector<Motion> motions;
    for (int quarter = 0; quarter < 4; ++quarter) {
      for (double beside = -kMaxTurn; beside <= kMaxTurn + 1e-9; beside += kCoarseTurn) {
        for (double x = -kBorder; x <= size.x() + kBorder; x += kCoarseStep) {
          for (double y = -kBorder; y <= size.y() + kBorder; y += kCoarseStep) {
            Motion motion{plan_.geometry.origin + Eigen::Vector2d(x, y), wrap_angle(0.5 * kPi * quarter + beside)};
            motion.score = score(motion, coarse_, walls, path);
            motions.push_back(motion);
          }
        }
      }
    }
    std::stable_sort(motions.begin(), motions.end(),
                     [](const Motion& a, const Motion& b) { return a.score > b.score; });
    std::vector<Motion> best;
    for (auto motion = motions.begin(); motion != motions.end() && best.size() < kMaxRefined; ++motion) {
      const bool is_new = std::none_of(best.begin(), best.end(), [&](const Motion& other) {
        return (other.middle - motion->middle).norm() < kApart &&
               std::abs(wrap_angle(other.theta - motion->theta)) < kApartTurn;
      });
      if (is_new) {
        best.push_back(*motion);
      }
    }
    return best;
  }

  /// Climbs from a motion to the best one near it, in ever smaller steps.
  [[nodiscard]] Motion refined(Motion motion) const {
    const std::vector<Eigen::Vector2d> walls = thinned(walls_, kFinePoints);
    motion.score = score(motion, fine_, walls, path_);
    double step = 0.5 * kCoarseStep;
    double turn = 0.5 * kCoarseTurn;
    while (step > 0.01) {
      const Motion before = motion;
      for (const auto& [x, y, theta] : std::array<std::array<double, 3>, 6>{{{step, 0.0, 0.0},
                                                                             {-step, 0.0, 0.0},
                                                                             {0.0, step, 0.0},
                                                                             {0.0, -step, 0.0},
                                                                             {0.0, 0.0, turn},
                                                                             {0.0, 0.0, -turn}}}) {
        Motion other{before.middle + Eigen::Vector2d(x, y), wrap_angle(before.theta + theta)};
        other.score = score(other, fine_, walls, path_);
        motion = other.score > motion.score ? other : motion;
      }
      if (motion.score <= before.score) {
        step *= 0.5;
        turn *= 0.5;
      }
    }
    return motion;
  }

  PriorMap plan_;
  std::vector<Eigen::Vector2d> walls_;                // [m] of the survey
  std::vector<Eigen::Vector2d> path_;                 // [m] of the robot
  Eigen::Vector2d middle_ = Eigen::Vector2d::Zero();  // [m] of the walls
  std::vector<float> coarse_;
  std::vector<float> fine_;
};

}  // namespace

std::optional<Pose2> align_with_fixtures(const Survey& survey, const SurveyModel& model,
                                         const std::filesystem::path& building_file) {
  CeilingKinds kinds = model.kinds;
  const SurveyEstimate file = estimate_of(read_known_building(building_file, kinds));
  const PartJoining joining(file, survey.estimate, kinds, sight_of(model));
  const std::optional<PartJoint> joint = joining.find();
  return joint ? std::optional(joint->map_from_part) : std::nullopt;
}

std::optional<Pose2> align_with_walls(const Survey& survey, const PriorMap& map, const PriorMap& plan) {
  return WallMatch(survey, map, plan).find();
}

}  // namespace luminav
