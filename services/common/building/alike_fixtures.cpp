#include "services/common/building/alike_fixtures.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kSamePlace = 0.15;               // [m]
constexpr double kSameHeading = 8.0 / 180 * kPi;  // [rad]

/// Fixture or element, as a camera sees it.
struct CeilingMark {
  int look = 0;         // equal for equal kind and size
  double period = 0.0;  // [rad] 0 = no orientation
  Pose2 pose;
};

int look_of(int kind, double length, double width) {
  const auto steps = [](double metres) { return static_cast<int>(std::lround(metres / 0.05)); };
  return (kind * 1000 + steps(length)) * 1000 + steps(width);
}

std::vector<CeilingMark> marks_of(const Building& building) {
  std::vector<CeilingMark> marks;
  for (const Fixture& fixture : building.fixtures) {
    marks.push_back({look_of(static_cast<int>(fixture.shape), fixture.length, fixture.width),
                     symmetry_period(fixture.shape), fixture.world_from_fixture});
  }
  for (const CeilingElement& element : building.elements) {
    marks.push_back({look_of(10 + static_cast<int>(element.kind), element.length, element.width),
                     element.kind == ElementKind::kDetector ? 0.0 : 0.5 * kPi, element.world_from_element});
  }
  return marks;
}

bool is_same(const CeilingMark& mark, const Pose2& pose, const CeilingMark& other) {
  if (mark.look != other.look || distance(pose, other.pose) > kSamePlace) {
    return false;
  }
  return mark.period == 0.0 || std::abs(std::remainder(pose.theta - other.pose.theta, mark.period)) <= kSameHeading;
}

class Surroundings {
 public:
  explicit Surroundings(const Building& building) : marks_(marks_of(building)), near_(building.fixtures.size()) {
    for (std::size_t i = 0; i < near_.size(); ++i) {
      for (std::size_t j = 0; j < marks_.size(); ++j) {
        if (j != i && distance(marks_[i].pose, marks_[j].pose) < kSurroundings) {
          near_[i].push_back(j);
        }
      }
    }
  }

  [[nodiscard]] bool alike(std::size_t a, std::size_t b) const {
    if (marks_[a].look != marks_[b].look) {
      return false;
    }
    const std::vector<double> turns = turns_onto(a, b);
    return std::any_of(turns.begin(), turns.end(), [&](double turn) {
      const Pose2 b_from_a = Pose2{marks_[b].pose.x, marks_[b].pose.y, turn} *
                             Pose2{-marks_[a].pose.x, -marks_[a].pose.y, 0.0};  // both in the world
      return maps_onto(a, b, b_from_a) && maps_onto(b, a, b_from_a.inverse());
    });
  }
  /// A round fixture among nothing but round things.
  [[nodiscard]] bool tells_no_heading(std::size_t i) const {
    return marks_[i].period == 0.0 &&
           std::all_of(near_[i].begin(), near_[i].end(), [&](std::size_t j) { return marks_[j].period == 0.0; });
  }

 private:
  /// Turns [rad] under which `a` may lie on `b`; of round ones those that lay the nearest mark on its like.
  [[nodiscard]] std::vector<double> turns_onto(std::size_t a, std::size_t b) const {
    std::vector<double> turns;
    if (marks_[a].period > 0.0) {
      for (int i = 0; i < std::lround(2.0 * kPi / marks_[a].period); ++i) {
        turns.push_back(wrap_angle(marks_[b].pose.theta - marks_[a].pose.theta + i * marks_[a].period));
      }
      return turns;
    }
    const auto nearest = std::min_element(near_[a].begin(), near_[a].end(), [&](std::size_t i, std::size_t j) {
      return distance(marks_[a].pose, marks_[i].pose) < distance(marks_[a].pose, marks_[j].pose);
    });
    if (nearest == near_[a].end()) {
      return {0.0};
    }
    const auto direction = [&](std::size_t from, std::size_t to) {
      const Eigen::Vector2d apart = marks_[to].pose.position() - marks_[from].pose.position();
      return std::atan2(apart.y(), apart.x());
    };
    for (const std::size_t j : near_[b]) {
      if (marks_[j].look == marks_[*nearest].look) {
        turns.push_back(wrap_angle(direction(b, j) - direction(a, *nearest)));
      }
    }
    return turns;
  }

  /// Whether all that is clearly near `a` is found near `b`; the rim may differ, since it is cut by a hair.
  [[nodiscard]] bool maps_onto(std::size_t a, std::size_t b, const Pose2& motion) const {
    return std::all_of(near_[a].begin(), near_[a].end(), [&](std::size_t i) {
      if (distance(marks_[i].pose, marks_[a].pose) > kSurroundings - 2.0 * kSamePlace) {
        return true;
      }
      const Pose2 moved = motion * marks_[i].pose;
      return std::any_of(near_[b].begin(), near_[b].end(),
                         [&](std::size_t j) { return is_same(marks_[i], moved, marks_[j]); });
    });
  }

  std::vector<CeilingMark> marks_;
  std::vector<std::vector<std::size_t>> near_;
};

}  // namespace

AlikeFixtures find_alike_fixtures(const Building& building) {
  const Surroundings surroundings(building);
  AlikeFixtures result;
  for (std::size_t i = 0; i < building.fixtures.size(); ++i) {
    std::vector<std::size_t> group = {i};
    for (std::size_t j = 0; j < building.fixtures.size(); ++j) {
      if (j != i && surroundings.alike(i, j)) {
        group.push_back(j);
      }
    }
    result.fixtures += group.size() > 1 ? 1 : 0;
    result.without_heading += surroundings.tells_no_heading(i) ? 1 : 0;
    if (group.size() > 1 && group.size() > result.largest_group.size()) {
      result.largest_group = std::move(group);
    }
  }
  return result;
}

}  // namespace luminav
