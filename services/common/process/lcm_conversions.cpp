#include "services/common/process/lcm_conversions.hpp"

#include <cmath>

namespace luminav {
namespace {

constexpr double kFarthest = 1e5;    // [m]
constexpr double kMaxTurns = 1e3;    // [rad] of a heading; it ought to be wrapped
constexpr double kFastest = 10.0;    // [m/s]
constexpr double kQuickest = 100.0;  // [rad/s]

/// Odometry and poses alike; a comparison with what is no number is false.
template <typename Message>
bool is_possible_motion(const Message& message) {
  return std::abs(message.x) <= kFarthest && std::abs(message.y) <= kFarthest && std::abs(message.theta) <= kMaxTurns &&
         std::abs(message.linear) <= kFastest && std::abs(message.angular) <= kQuickest;
}

}  // namespace

bool is_possible(const odometry_t& message) {
  return is_possible_motion(message);
}

bool is_possible(const pose_t& message) {
  return is_possible_motion(message);
}

}  // namespace luminav
