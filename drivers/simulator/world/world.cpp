#include "drivers/simulator/world/world.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "drivers/simulator/world/lamp_state.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr double kDoorGap = 0.05;       // [m] a door closes only when nobody stands in it
constexpr int kBumpTicks = 20;          // a bump takes 0.2 s
constexpr double kStallReported = 0.1;  // [s] at least
constexpr double kFree = 1e-9;          // [m] less is contact
constexpr double kWalking = 0.25;       // [m/s] a bumper that touches at this speed hurts nobody
constexpr double kBumperTravel = 5e-3;  // [m]
// Of a Create 2, robot frame [m].
const std::array<Vector2d, 4> kCliffSensors = {Vector2d{0.11, 0.13}, {0.165, 0.05}, {0.165, -0.05}, {0.11, -0.13}};
constexpr double kWheelOffset = 0.1175;  // [m] to each side

std::deque<ScenarioEvent> by_time(const std::vector<ScenarioEvent>& events) {
  std::deque<ScenarioEvent> sorted(events.begin(), events.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const ScenarioEvent& a, const ScenarioEvent& b) { return a.at < b.at; });
  return sorted;
}

template <typename Items>
std::optional<std::size_t> index_of(const Items& items, int id) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].id == id) {
      return i;
    }
  }
  return std::nullopt;
}

/// Starts and ends gently, 0 to 1.
double smooth_step(double fraction) {
  const double t = std::clamp(fraction, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace

World::World(std::uint64_t seed, const WorldTruth& truth)
    : truth_(truth),
      events_(by_time(truth.events)),
      scene_(truth_),
      robot_(truth_, seed),
      sonar_(truth_.robot.sonar, seed),
      floor_(truth_.floor_tilt, seed),
      people_(truth_.people, scene_),
      dock_(truth_.dock, seed),
      faults_(truth_.robot.sonar) {
  state_.world_from_robot = truth_.start;
  state_.daylight = truth_.daylight;
  state_.lamp_states = truth_.lamp_states;
  state_.door_open.assign(truth_.building.doors.size(), true);
  door_wanted_open_ = state_.door_open;
  footprint_ = transform(truth_.start, truth_.robot.footprint);
  separation_ = scene_.separation(footprint_);
  state_.clearance = separation_.nearest();
  measure_motion(truth_.start);
}

WheelReport World::step(const MotorCommand& command) {
  ++ticks_;
  start_due_events();
  move_doors();
  people_.step(kTick, robot_among_people());
  const Pose2 before = state_.world_from_robot;
  WheelReport report;
  if (carry_) {
    robot_.stall();
    carry();
  } else {
    separation_.of[static_cast<std::size_t>(SolidKind::kPerson)] = scene_.person_distance(footprint_);
    report = drive(command);
    push();
    if (truth_.feels_touch) {
      feel(report);
    }
    contacts_.release(separation_);
  }
  state_.clearance = state_.carried ? Separation::kNoneNear : separation_.nearest();
  measure_motion(before);
  constexpr double kStill = 0.01;  // [m/s], [rad/s]
  dock_.step(state_.world_from_robot, std::abs(state_.linear) < kStill && std::abs(state_.angular) < kStill,
             state_.carried);
  report.left = faults_.count(0, report.left, time());
  report.right = faults_.count(1, report.right, time());
  return report;
}

double World::measure_sonar(int disc) {
  // measured all the same: what other discs hear does not depend on a fault
  return faults_.hear(disc, sonar_.measure(scene_, state_.world_from_robot, disc), time());
}

void World::start_due_events() {
  while (!events_.empty() && events_.front().at <= time()) {
    start(events_.front());
    events_.pop_front();
  }
  robot_.set_grip(faults_.grip(time()));
  state_.camera_unplugged = faults_.is_camera_unplugged(time());
  state_.serial_unplugged = faults_.is_serial_unplugged(time());
}

void World::start(const ScenarioEvent& event) {
  const auto set_lamps = [this](const std::vector<int>& ids, std::int8_t lamp_state) {
    for (const int id : ids) {
      if (const auto index = index_of(truth_.building.fixtures, id)) {
        state_.lamp_states[*index] = lamp_state;
      }
    }
  };
  switch (event.kind) {
    case EventKind::kCarry:
      carry_ = Carry{state_.world_from_robot, event.pose, time(), event.duration};
      state_.carries += state_.carried ? 0 : 1;
      state_.carried = true;
      break;
    case EventKind::kBump:
      bump_ = {{event.pose.x / kBumpTicks, event.pose.y / kBumpTicks, event.pose.theta / kBumpTicks}, kBumpTicks};
      break;
    case EventKind::kLight:
      state_.daylight = event.daylight.value_or(state_.daylight);
      set_lamps(event.on, kLampOn);
      set_lamps(event.off, kLampOff);
      break;
    case EventKind::kDoor:
      if (const auto index = index_of(truth_.building.doors, event.id)) {
        door_wanted_open_[*index] = event.open;
      }
      break;
    case EventKind::kLamp:
      if (const auto index = index_of(truth_.building.fixtures, event.id)) {
        Pose2& offset = state_.lamp_offsets[static_cast<std::int32_t>(*index)];
        offset = {offset.x + event.pose.x, offset.y + event.pose.y, wrap_angle(offset.theta + event.pose.theta)};
      }
      break;
    case EventKind::kSlip:
    case EventKind::kUnplug:
    case EventKind::kDeafen:
    case EventKind::kStick:
    case EventKind::kFreeze:
      faults_.start(event, time());
      break;
    case EventKind::kCover:
      break;  // the simulated camera does this
    case EventKind::kKill:
    case EventKind::kClock:
      break;  // the program that runs the scenario does these
  }
}

void World::move_doors() {
  for (std::size_t i = 0; i < scene_.doors(); ++i) {
    if (door_wanted_open_[i] == state_.door_open[i]) {
      continue;
    }
    const Polygon& leaf = scene_.door_leaf(i);
    const bool robot_in_it = !state_.carried && distance(leaf, footprint_) < kDoorGap;
    const bool person_in_it = std::any_of(people().begin(), people().end(), [&leaf](const Disc& person) {
      return distance(leaf, person.centre) < person.radius + kDoorGap;
    });
    if (door_wanted_open_[i] || (!robot_in_it && !person_in_it)) {
      state_.door_open[i] = door_wanted_open_[i];
      scene_.set_door_closed(i, !state_.door_open[i]);
      separation_ = scene_.separation(footprint_);
    }
  }
}

void World::carry() {
  const double fraction = carry_->duration > 0.0 ? (time() - carry_->begin) / carry_->duration : 1.0;
  state_.world_from_robot = interpolate(carry_->from, carry_->to, smooth_step(fraction));
  footprint_ = transform(state_.world_from_robot, truth_.robot.footprint);
  separation_ = scene_.separation(footprint_);
  contacts_.release(separation_);
  // nobody puts a robot down on somebody's feet
  if (fraction >= 1.0 && separation_.to(SolidKind::kPerson) >= kPersonGap) {
    carry_.reset();
    state_.carried = false;
  }
}

WheelReport World::drive(const MotorCommand& command) {
  const WheelStep wheels = robot_.step(kTick, command);
  if (wheels.left == 0.0 && wheels.right == 0.0) {
    return {0.0, 0.0, time() < stalled_until_};
  }
  const std::optional<Separation> blocked = try_move(state_.world_from_robot * wheels.robot_from_next);
  if (!blocked) {
    return {wheels.left, wheels.right, time() < stalled_until_};
  }
  const bool is_gentle = truth_.feels_touch && std::abs(state_.linear) <= kWalking;
  if (robot_.hold(contacts_.touch(*blocked, is_gentle))) {
    return {wheels.left, wheels.right, false};
  }
  stalled_until_ = time() + kStallReported;
  return {0.0, 0.0, true};
}

void World::push() {
  if (bump_.ticks == 0) {
    return;
  }
  --bump_.ticks;
  const Pose2& here = state_.world_from_robot;
  const Pose2 next{here.x + bump_.per_tick.x, here.y + bump_.per_tick.y, wrap_angle(here.theta + bump_.per_tick.theta)};
  if (try_move(next)) {
    bump_.ticks = 0;
  }
}

void World::feel(WheelReport& report) {
  const Pose2& here = state_.world_from_robot;
  for (const int side : {0, 1}) {
    const double angle = radians(side == 0 ? 40.0 : -40.0);
    const Pose2 pressed = here * Pose2{kBumperTravel * std::cos(angle), kBumperTravel * std::sin(angle), 0.0};
    const Separation separation = scene_.separation(transform(pressed, truth_.robot.footprint));
    report.bumpers |= separation.nearest() < kFree ? 1 << side : 0;
  }
  const auto is_over_hole = [&](const Vector2d& in_robot) {
    return std::any_of(truth_.holes.begin(), truth_.holes.end(),
                       [&](const Polygon& hole) { return distance(hole, here * in_robot) <= 0.0; });
  };
  for (std::size_t i = 0; i < kCliffSensors.size(); ++i) {
    report.cliffs |= is_over_hole(kCliffSensors[i]) ? 1 << i : 0;
  }
  report.drop_left = is_over_hole({0.0, kWheelOffset});
  report.drop_right = is_over_hole({0.0, -kWheelOffset});
  contacts_.observe_fall(report.drop_left || report.drop_right);
}

std::optional<Separation> World::try_move(const Pose2& next) {
  Polygon outline = transform(next, truth_.robot.footprint);
  const Separation separation = scene_.separation(outline);
  for (std::size_t kind = 0; kind < kSolidKinds; ++kind) {
    if (separation.of[kind] < kFree && separation_.of[kind] >= kFree) {
      return separation;
    }
  }
  state_.world_from_robot = next;
  footprint_ = std::move(outline);
  separation_ = separation;
  return std::nullopt;
}

void World::measure_motion(const Pose2& before) {
  const Pose2& now = state_.world_from_robot;
  const double middle = before.theta + 0.5 * wrap_angle(now.theta - before.theta);
  state_.linear = ((now.x - before.x) * std::cos(middle) + (now.y - before.y) * std::sin(middle)) / kTick;
  state_.angular = wrap_angle(now.theta - before.theta) / kTick;
  contacts_.observe_motion(kTick, state_.linear, state_.angular);
  const Vector2d tilt = floor_.tilt_at(now.position());
  state_.roll = std::cos(now.theta) * tilt.x() + std::sin(now.theta) * tilt.y();
  state_.pitch = -std::sin(now.theta) * tilt.x() + std::cos(now.theta) * tilt.y();
}

}  // namespace luminav
