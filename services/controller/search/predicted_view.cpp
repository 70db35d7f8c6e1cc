#include "services/controller/search/predicted_view.hpp"

#include <cmath>

namespace luminav {
namespace {

constexpr double kSureWithin = 0.65;  // of the view's radius: a fixture farther off may be seen or not
constexpr double kSamePlace = 0.6;    // [m] fixtures as near as that are seen as one
constexpr double kSameAxis = 0.4;     // [rad] and no more turned than that

}  // namespace

std::optional<PredictedView> predict(const CeilingForecast& forecast, const PossiblePose& pose,
                                     const Eigen::Vector2d& place, bool is_known_floor) {
  const Eigen::Vector2d there = pose.world_from_odom * place;
  if (!forecast.knows(there)) {
    return std::nullopt;
  }
  PredictedView view;
  view.is_wall = !is_known_floor && !forecast.has_room(there);
  view.fixture = view.is_wall ? nullptr : forecast.fixture_above(there);
  if (view.fixture != nullptr) {
    if ((view.fixture->world_from_fixture.position() - there).norm() > kSureWithin * forecast.view_radius()) {
      return std::nullopt;
    }
    view.odom_from_fixture = pose.odom_from_world * view.fixture->world_from_fixture;
  }
  return view;
}

bool look_alike(const PredictedView& a, const PredictedView& b) {
  if (a.is_wall || b.is_wall || a.fixture == nullptr || b.fixture == nullptr) {
    return a.is_wall == b.is_wall && a.fixture == b.fixture;
  }
  const double period = symmetry_period(a.fixture->shape);
  const double turn = wrap_angle(a.odom_from_fixture.theta - b.odom_from_fixture.theta);
  return a.fixture->shape == b.fixture->shape && std::abs(a.fixture->length - b.fixture->length) < 0.1 &&
         distance(a.odom_from_fixture, b.odom_from_fixture) < kSamePlace &&
         (period == 0.0 || std::abs(std::remainder(turn, period)) < kSameAxis);
}

}  // namespace luminav
