#include "drivers/simulator/world/world.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "drivers/simulator/world/lamp_state.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr double kPersonGap = 0.1;      // [m] to the robot at which people stop
constexpr double kDoorGap = 0.05;       // [m] a door closes only when nobody stands in it
constexpr int kBumpTicks = 20;          // a bump takes 0.2 s
constexpr double kSpinning = 0.3;       // probability that blocked wheels spin instead of stalling
constexpr double kStallReported = 0.1;  // [s] at least
constexpr double kFree = 1e-9;          // [m] less is contact
constexpr double kWalking = 0.25;       // [m/s] a bumper that touches at this speed hurts nobody
constexpr double kBumperTravel = 5e-3;  // [m]
// Of a Create 2, robot frame [m].
const std::array<Vector2d, 4> kCliffSensors = {Vector2d{0.11, 0.13}, {0.165, 0.05}, {0.165, -0.05}, {0.11, -0.13}};
constexpr double kWheelOffset = 0.1175;  // [m] to each side

std::vector<ScenarioEvent> by_time(std::vector<ScenarioEvent> events) {
  std::stable_sort(events.begin(), events.end(),
                   [](const ScenarioEvent& a, const ScenarioEvent& b) { return a.at < b.at; });
  return events;
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
      contact_random_(seed, "contact"),
      dock_random_(seed, "dock"),
      deaf_until_(static_cast<std::size_t>(sonar_.discs()), 0.0),
      stuck_until_(static_cast<std::size_t>(sonar_.discs()), 0.0),
      ranges_(static_cast<std::size_t>(sonar_.discs()), truth_.robot.sonar.maximum_range) {
  for (const WalkingPerson& person : truth_.people) {
    people_.emplace_back(person);
  }
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
  walk_people();
  walk_visitors();
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
  dock();
  report.left = time() < frozen_until_[0] ? 0.0 : report.left;
  report.right = time() < frozen_until_[1] ? 0.0 : report.right;
  return report;
}

double World::measure_sonar(int disc) {
  const auto i = static_cast<std::size_t>(disc);
  // drawn all the same: what other discs hear does not depend on it
  const double range = sonar_.measure(scene_, state_.world_from_robot, disc);
  if (time() < deaf_until_[i]) {
    return truth_.robot.sonar.maximum_range;
  }
  ranges_[i] = time() < stuck_until_[i] ? ranges_[i] : range;
  return ranges_[i];
}

void World::start_dead_sense(const ScenarioEvent& event) {
  const double until = time() + event.duration;
  if (event.kind == EventKind::kFreeze) {
    if (event.device != "camera") {  // the simulated camera freezes by itself
      frozen_until_[event.device == "encoder_left" ? 0 : 1] = until;
    }
    return;
  }
  std::vector<double>& discs = event.kind == EventKind::kDeafen ? deaf_until_ : stuck_until_;
  for (std::size_t i = 0; i < discs.size(); ++i) {
    const bool is_named = std::find(event.discs.begin(), event.discs.end(), static_cast<int>(i)) != event.discs.end();
    discs[i] = event.discs.empty() || is_named ? until : discs[i];
  }
}

void World::start_due_events() {
  while (next_event_ < events_.size() && events_[next_event_].at <= time()) {
    start(events_[next_event_++]);
  }
  if (time() >= slip_until_) {
    robot_.set_grip(1.0);
  }
  state_.camera_unplugged = time() < camera_unplugged_until_;
  state_.serial_unplugged = time() < serial_unplugged_until_;
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
    case EventKind::kSlip:
      robot_.set_grip(event.factor);
      slip_until_ = time() + event.duration;
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
    case EventKind::kUnplug:
      (event.device == "camera" ? camera_unplugged_until_ : serial_unplugged_until_) = time() + event.duration;
      break;
    case EventKind::kLamp:
      if (const auto index = index_of(truth_.building.fixtures, event.id)) {
        Pose2& offset = state_.lamp_offsets[static_cast<std::int32_t>(*index)];
        offset = {offset.x + event.pose.x, offset.y + event.pose.y, wrap_angle(offset.theta + event.pose.theta)};
      }
      break;
    case EventKind::kDeafen:
    case EventKind::kStick:
    case EventKind::kFreeze:
      start_dead_sense(event);
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

void World::walk_people() {
  for (std::size_t i = 0; i < people_.size(); ++i) {
    const Vector2d& here = people_[i].position();
    people_[i].step(kTick, [&](const Vector2d& next, bool is_beside_line) {
      if (!state_.carried) {
        const double gap = distance(footprint_, next) - kPersonRadius;
        if (gap < kPersonGap && gap < distance(footprint_, here) - kPersonRadius) {
          return Obstruction::kRobot;
        }
      }
      for (std::size_t door = 0; door < scene_.doors(); ++door) {
        if (scene_.is_door_closed(door) && distance(scene_.door_leaf(door), next) < kPersonRadius) {
          return Obstruction::kDoor;
        }
      }
      if (is_beside_line && !stands_clear(next, 0.0)) {
        return Obstruction::kWall;
      }
      return Obstruction::kNone;
    });
    scene_.set_person(i, people_[i].position());
  }
}

bool World::is_free(const Vector2d& point, double room) const {
  if (!state_.carried && distance(footprint_, point) - kPersonRadius < kPersonGap) {
    return false;
  }
  return stands_clear(point, room);
}

bool World::stands_clear(const Vector2d& point, double room) const {
  const double side = 2.0 * (kPersonRadius + room);
  const Separation separation = scene_.separation(rectangle({point.x(), point.y(), 0.0}, side, side));
  return separation.to(SolidKind::kWall) > 0.0 && separation.to(SolidKind::kBox) > 0.0;
}

bool World::add_visitor(const VisitorHabit& habit) {
  constexpr double kBehind = 1.3;  // [m] from the robot's middle
  constexpr double kRoom = 0.25;   // [m] to all sides: nobody waits in a doorway
  constexpr int kDirections = 16;
  const Pose2& robot = state_.world_from_robot;
  for (int i = 0; i < kDirections; ++i) {
    const int turn = (i % 2 == 0 ? 1 : -1) * ((i + 1) / 2);  // straight behind it first
    const double theta = robot.theta + kPi + 2.0 * kPi * turn / kDirections;
    const Vector2d direction(std::cos(theta), std::sin(theta));
    bool is_open = true;
    for (double reach = 0.7; reach <= kBehind && is_open; reach += 0.2) {
      is_open = is_free(robot.position() + reach * direction);
    }
    if (is_open && is_free(robot.position() + kBehind * direction, kRoom)) {
      visitors_.emplace_back(habit, robot.position() + kBehind * direction);
      place_people();
      return true;
    }
  }
  return false;
}

bool World::add_bystander(const Vector2d& position) {
  if (!is_free(position)) {
    return false;
  }
  visitors_.emplace_back(VisitorHabit{.speed = 0.0}, position);
  place_people();
  return true;
}

void World::remove_visitors() {
  std::erase_if(visitors_, [](const Visitor& visitor) { return visitor.follows(); });
  place_people();
}

void World::remove_bystanders() {
  std::erase_if(visitors_, [](const Visitor& visitor) { return !visitor.follows(); });
  place_people();
}

const Visitor* World::visitor() const {
  const auto found =
      std::find_if(visitors_.begin(), visitors_.end(), [](const Visitor& visitor) { return visitor.follows(); });
  return found == visitors_.end() ? nullptr : &*found;
}

void World::place_people() {
  scene_.set_people(people_.size() + visitors_.size());
  for (std::size_t i = 0; i < visitors_.size(); ++i) {
    scene_.set_person(people_.size() + i, visitors_[i].position());
  }
}

void World::walk_visitors() {
  for (Visitor& visitor : visitors_) {
    const double gap = distance(footprint_, visitor.position());
    visitor.step(kTick, state_.world_from_robot, [&](const Vector2d& next) {
      // away from the robot he may always go
      return is_free(next) || (gap < kPersonRadius + kPersonGap && distance(footprint_, next) > gap);
    });
  }
  std::erase_if(visitors_, [](const Visitor& visitor) { return visitor.is_gone(); });
  place_people();
}

void World::dock() {
  if (!truth_.dock) {
    return;
  }
  constexpr double kStill = 0.01;  // [m/s], [rad/s]
  const Dock& there = *truth_.dock;
  const Pose2& robot = state_.world_from_robot;
  if (state_.carried || distance(robot, there.pose) > there.reach ||
      std::abs(wrap_angle(robot.theta - there.pose.theta)) > there.heading) {
    docking_ = Docking::kAway;
  } else if (docking_ == Docking::kAway && std::abs(state_.linear) < kStill && std::abs(state_.angular) < kStill) {
    docking_ = dock_random_.happens(there.contact) ? Docking::kContact : Docking::kMissed;
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
  if (contacts_.touch(*blocked, is_gentle)) {
    spinning_ = contact_random_.happens(kSpinning);
  }
  if (spinning_) {
    return {wheels.left, wheels.right, false};
  }
  robot_.stall();
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
  const bool falls = report.drop_left || report.drop_right;
  if (falls && !has_fallen_) {
    contacts_.fall();
  }
  has_fallen_ = falls;
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
