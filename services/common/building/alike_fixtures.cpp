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
    const int turns = marks_[a].period == 0.0 ? 16 : static_cast<int>(std::lround(2.0 * kPi / marks_[a].period));
    for (int turn = 0; turn < turns; ++turn) {
      const Pose2 turned = marks_[b].pose * Pose2{0.0, 0.0, wrap_angle(2.0 * kPi * turn / turns)};
      const Pose2 b_from_a = turned * marks_[a].pose.inverse();  // both in the world
      if (maps_onto(a, b, b_from_a) && maps_onto(b, a, b_from_a.inverse())) {
        return true;
      }
    }
    return false;
  }

 private:
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
    if (group.size() > 1 && group.size() > result.largest_group.size()) {
      result.largest_group = std::move(group);
    }
  }
  return result;
}

}  // namespace luminav
