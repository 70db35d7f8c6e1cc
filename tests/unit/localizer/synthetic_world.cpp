#include "tests/unit/localizer/synthetic_world.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace luminav::testing {
namespace {

constexpr double kStep = 1.0 / 30.0;  // [s]
constexpr double kRadius = 0.30;      // [m] that the wandering robot keeps free

constexpr double kSlanted = 1.19;  // over a beam of 13 degrees either way, of a wall at 20 degrees of incidence
constexpr double kLostAtRightAngle = 0.01;

using Reaches = std::array<double, 5>;  // [m] to the first wall, from side to side of a beam

/// A smooth wall at more than some 20 degrees of incidence sends a ping away, and so may one that ends in the beam.
bool is_slanted(const Reaches& reaches) {
  const auto [nearest, farthest] = std::minmax_element(reaches.begin(), reaches.end());
  return *farthest > kSlanted * *nearest;
}

void fill(PriorMap& map, double x0, double y0, double x1, double y1, Prior value) {
  for (int row = 0; row < map.geometry.rows; ++row) {
    for (int column = 0; column < map.geometry.columns; ++column) {
      const Eigen::Vector2d c = map.geometry.centre_of({column, row});
      if (c.x() > x0 && c.x() < x1 && c.y() > y0 && c.y() < y1) {
        map.cells[map.geometry.index({column, row})] = value;
      }
    }
  }
}

PriorMap walled(double width, double height) {
  PriorMap map;
  map.geometry = {
      0.1, {0.0, 0.0}, static_cast<int>(std::lround(width * 10)), static_cast<int>(std::lround(height * 10))};
  map.cells.assign(map.geometry.size(), Prior::kOccupied);
  fill(map, 0.2, 0.2, width - 0.2, height - 0.2, Prior::kFree);
  return map;
}

Fixture fixture_at(int id, double x, double y, double theta, double width) {
  Fixture fixture;
  fixture.id = id;
  fixture.world_from_fixture = {x, y, theta};
  fixture.length = 1.2;
  fixture.width = width;
  return fixture;
}

}  // namespace

TestBuilding symmetric_corridor(int fixtures, double pitch) {
  TestBuilding result;
  result.walls = walled(fixtures * pitch, 2.4);
  for (int i = 0; i < fixtures; ++i) {
    result.building.fixtures.push_back(fixture_at(i + 1, (i + 0.5) * pitch, 1.2, 0.0, 0.3));
  }
  return result;
}

TestBuilding two_rooms() {
  TestBuilding result;
  result.walls = walled(14.0, 7.0);
  fill(result.walls, 8.0, 0.0, 8.2, 7.0, Prior::kOccupied);
  fill(result.walls, 7.9, 2.0, 8.3, 3.2, Prior::kFree);
  int id = 1;
  for (const double x : {1.5, 4.0, 6.5}) {
    for (const double y : {1.6, 5.2}) {
      result.building.fixtures.push_back(fixture_at(id++, x, y, 0.0, 0.3));
    }
  }
  for (const double y : {1.4, 3.6, 5.8}) {
    result.building.fixtures.push_back(fixture_at(id++, 10.6, y, 0.5 * kPi, 0.15));
  }
  result.building.fixtures.push_back(fixture_at(id++, 12.8, 2.4, 0.0, 0.15));
  return result;
}

SyntheticWorld::SyntheticWorld(const Building& believed, const PriorMap& walls, const RobotDescription& robot,
                               const SyntheticOptions& options)
    : believed_(believed),
      robot_(robot),
      options_(options),
      generator_(options.seed * 7919 + 17),
      true_building_(believed),
      map_walls_(walls),
      true_robot_(robot) {
  const double k = options.perfect ? 0.0 : (options.calibrated ? 0.1 : 1.0);
  const double wheels = options.wheel_errors ? k : 0.0;
  const double optics = options.camera_errors ? k : 0.0;
  const double fixture_position =
      options.perfect || !options.fixture_errors ? 0.0 : (options.calibrated ? 0.003 : 0.010);
  const double fixture_heading =
      options.perfect || !options.fixture_errors ? 0.0 : radians(options.calibrated ? 0.2 : 0.5);
  const double scale = 1.0 + gauss(0.01 * wheels);
  const double ratio = gauss(0.005 * wheels);
  scale_left_ = scale * (1.0 - 0.5 * ratio);
  scale_right_ = scale * (1.0 + 0.5 * ratio);
  true_base_ = robot.wheel_base * (1.0 + gauss(0.01 * wheels));
  CameraDescription& camera = true_robot_.camera;
  camera.mounting.roll += gauss(radians(0.5) * optics);
  camera.mounting.pitch += gauss(radians(0.5) * optics);
  camera.mounting.yaw += gauss(radians(0.5) * optics);
  camera.mounting.z *= 1.0 + gauss(0.01 * optics);
  camera.time_offset += gauss(options.time_errors ? 0.020 * k : 0.0);
  camera.intrinsics.distortion[0] += gauss(0.01 * optics);
  const double ceiling = 1.0 + gauss(0.005 * optics);
  true_building_.ceiling_height *= ceiling;
  for (Fixture& fixture : true_building_.fixtures) {
    fixture.world_from_fixture.x += gauss(fixture_position);
    fixture.world_from_fixture.y += gauss(fixture_position);
    fixture.world_from_fixture.theta += gauss(fixture_heading);
    fixture.height *= ceiling;
    lit_.push_back(uniform(0.0, 1.0) >= options.off_ratio);
    never_seen_.push_back(!lit_.back() && uniform(0.0, 1.0) < options.overlooked);
  }
  PriorMap with_boxes = walls;
  for (int i = 0; i < options.unknown_boxes && !walls.cells.empty(); ++i) {
    const Pose2 place = draw_free_pose();
    fill(with_boxes, place.x - 0.25, place.y - 0.2, place.x + 0.25, place.y + 0.2, Prior::kOccupied);
  }
  walls_ = WallField(with_boxes);
  for (int i = 0; i < options.clutter && !believed.fixtures.empty(); ++i) {
    Fixture thing =
        believed
            .fixtures[static_cast<std::size_t>(uniform(0.0, 0.999) * static_cast<double>(believed.fixtures.size()))];
    thing.world_from_fixture = draw_free_pose();
    clutter_.push_back(thing);
  }
  truth_ = options.start ? *options.start : draw_free_pose();
  while (!options.start && walls_.distance_to_wall(truth_.position()) < kRadius + 0.1) {
    truth_ = draw_free_pose();
  }
}

double SyntheticWorld::uniform(double min, double max) {
  // not std::uniform_real_distribution, whose bytes differ between libraries
  return min + (max - min) * static_cast<double>(generator_() >> 11) * 0x1.0p-53;
}

double SyntheticWorld::gauss(double sigma) {
  const double u = 1.0 - uniform(0.0, 1.0);
  return sigma * std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * kPi * uniform(0.0, 1.0));
}

Pose2 SyntheticWorld::draw_free_pose() {
  const GridGeometry& geometry = map_walls_.map().geometry;
  for (int i = 0; i < 100000; ++i) {
    const Pose2 pose{geometry.origin.x() + uniform(0.0, geometry.columns * geometry.resolution),
                     geometry.origin.y() + uniform(0.0, geometry.rows * geometry.resolution),
                     wrap_angle(uniform(-kPi, kPi))};
    if (map_walls_.is_free(pose.position()) && map_walls_.distance_to_wall(pose.position()) > kRadius + 0.1) {
      return pose;
    }
  }
  return {};
}

void SyntheticWorld::kidnap(const Pose2& pose) {
  truth_ = pose;
  linear_ = 0.0;
  angular_ = 0.0;
  wanted_turn_ = 0.0;
  held_until_ = utime_ + 2'000'000;
}

void SyntheticWorld::steer() {
  if (utime_ < held_until_) {
    return;  // in somebody's hands: the wheels stand still
  }
  const auto room = [&](double turn) {
    const double heading = truth_.theta + turn;
    const Eigen::Vector2d direction(std::cos(heading), std::sin(heading));
    return walls_.range_to_wall(truth_.position() + 0.05 * direction, direction, 4.0);
  };
  double speed = options_.speed;
  double turn = 0.0;
  if (options_.spin_distance > 0.0 && driven_ - spun_at_ > options_.spin_distance && std::abs(wanted_turn_) <= 0.02) {
    wanted_turn_ = spin_;
    spin_ = -spin_;
    spun_at_ = driven_;
  }
  if (std::abs(wanted_turn_) > 0.02) {
    speed = 0.0;
    turn = std::clamp(3.0 * wanted_turn_, -1.0, 1.0);
  } else if (std::min({room(0.0), room(0.4), room(-0.4)}) < 0.55 ||
             walls_.distance_to_wall((truth_ * Eigen::Vector2d(0.25, 0.0)).eval()) < 0.25) {
    double best = 0.0;
    for (int i = 0; i < 8; ++i) {
      const double candidate = uniform(-kPi, kPi);
      const double free = std::min({room(candidate), room(candidate + 0.25), room(candidate - 0.25)});
      if (free > best) {
        best = free;
        wanted_turn_ = candidate;
      }
    }
    speed = 0.0;
  } else {
    turn = std::clamp(0.8 * (room(0.7) - room(-0.7)), -0.4, 0.4);
  }
  linear_ += std::clamp(speed - linear_, -1.0 * kStep, 0.5 * kStep);
  angular_ += std::clamp(turn - angular_, -2.1 * kStep, 2.1 * kStep);
}

Pose2 SyntheticWorld::truth_later(double seconds) const {
  const double turn = angular_ * seconds;
  const double distance = linear_ * seconds;
  return truth_ * Pose2{distance * std::cos(0.5 * turn), distance * std::sin(0.5 * turn), turn};
}

SyntheticWorld::Output SyntheticWorld::step() {
  steer();
  const double turn = angular_ * kStep;
  const double distance = linear_ * kStep;
  wanted_turn_ -= std::abs(wanted_turn_) > 0.02 ? turn : wanted_turn_;
  truth_ = truth_later(kStep);
  driven_ += std::abs(distance);
  const double k = options_.perfect || !options_.odometry_noise ? 0.0 : 1.0;
  const double noisy_distance = std::abs(distance) + 0.5 * true_base_ * std::abs(turn);
  // what the encoders make of it
  const double left = (distance - 0.5 * true_base_ * turn) / scale_left_;
  const double right = (distance + 0.5 * true_base_ * turn) / scale_right_;
  const double seen_distance = 0.5 * (left + right) + gauss(k * 0.01 * std::sqrt(noisy_distance));
  const double seen_turn = (right - left) / robot_.wheel_base + gauss(k * radians(0.5) * std::sqrt(noisy_distance));
  odom_ =
      odom_ * Pose2{seen_distance * std::cos(0.5 * seen_turn), seen_distance * std::sin(0.5 * seen_turn), seen_turn};
  since_floor_ += std::abs(distance);
  if (since_floor_ > 1.0) {
    since_floor_ = 0.0;
    const double tilt = options_.perfect || !options_.floor_errors ? 0.0 : radians(0.1);
    floor_roll_ = gauss(tilt);
    floor_pitch_ = gauss(tilt);
  }
  utime_ += static_cast<std::int64_t>(std::lround(1e6 * kStep));
  ++tick_;
  Output output;
  if (tick_ % 2 == 0) {
    SightingFrame frame = look(truth_, linear_, angular_);
    pending_.emplace_back(utime_ + static_cast<std::int64_t>(1e6 * options_.image_latency), std::move(frame));
  }
  if (tick_ % 3 == 0) {
    output.odometry = OdometryReading{utime_, 1, odom_, seen_distance / kStep, seen_turn / kStep};
    output.sonar = hear();
  }
  if (!pending_.empty() && pending_.front().first <= utime_) {
    output.frame = std::move(pending_.front().second);
    pending_.pop_front();
  }
  return output;
}

std::optional<FixtureSighting> SyntheticWorld::see(const Fixture& fixture, const Pose2& pose, bool exact) {
  CameraMounting mounting = true_robot_.camera.mounting;
  mounting.roll += floor_roll_;
  mounting.pitch += floor_pitch_;
  const CeilingCamera camera(true_robot_.camera.intrinsics, mounting);
  const CeilingCamera believed(robot_.camera.intrinsics, robot_.camera.mounting);
  (void)pose;
  // each point is seen when its row is read
  const auto pixel_of = [&](double along) -> std::optional<Eigen::Vector2d> {
    const Eigen::Vector2d on_ceiling = fixture.world_from_fixture * Eigen::Vector2d(along, 0.0);
    std::optional<Eigen::Vector2d> pixel = camera.pixel_of_ceiling_point(truth_.inverse() * on_ceiling, fixture.height);
    for (int i = 0; i < 2 && pixel; ++i) {
      const double late = exact ? 0.0 : (pixel->y() - 239.5) * true_robot_.camera.row_time;
      pixel = camera.pixel_of_ceiling_point(truth_later(late).inverse() * on_ceiling, fixture.height);
    }
    return pixel;
  };
  constexpr int kPoints = 25;
  double first = 1.0;
  double last = -1.0;
  for (int i = 0; i < kPoints; ++i) {
    const double share = -0.5 + (i + 0.5) / kPoints;
    const auto pixel = pixel_of(share * fixture.length);
    if (pixel && camera.is_in_image(*pixel, 2.0)) {
      first = std::min(first, share - 0.5 / kPoints);
      last = std::max(last, share + 0.5 / kPoints);
    }
  }
  if (last - first < 0.25) {
    return std::nullopt;
  }
  const bool near_end = first < -0.49;
  const bool far_end = last > 0.49;
  const auto near_px = pixel_of(first * fixture.length);
  const auto far_px = pixel_of(last * fixture.length);
  if (!near_px || !far_px) {
    return std::nullopt;
  }
  const double believed_height = believed_.ceiling_height;
  const auto near = believed.point_on_ceiling(*near_px, believed_height);
  const auto far = believed.point_on_ceiling(*far_px, believed_height);
  if (!near || !far) {
    return std::nullopt;
  }
  const Eigen::Vector2d axis = (*far - *near).normalized();
  const double visible = (*far - *near).norm();
  Eigen::Vector2d centre = 0.5 * (*near + *far);
  double along_sigma = 0.002;
  if (near_end && !far_end) {
    centre = *near + 0.5 * fixture.length * axis;
  } else if (far_end && !near_end) {
    centre = *far - 0.5 * fixture.length * axis;
  } else if (!near_end) {
    along_sigma = std::max(0.05, 0.6 * (fixture.length - visible));
  }
  const double k = options_.perfect ? 1e-3 : 1.0;
  const double across_sigma = 0.002;
  const double heading_sigma = radians(0.05) * fixture.length / visible;
  FixtureSighting sighting;
  const Eigen::Vector2d across(-axis.y(), axis.x());
  centre += k * (gauss(0.002) * axis + gauss(across_sigma) * across);
  double theta = std::atan2(axis.y(), axis.x()) + k * gauss(heading_sigma);
  if (uniform(0.0, 1.0) < 0.5) {
    theta += kPi;  // half a turn is all the same
  }
  sighting.robot_from_fixture = {centre.x(), centre.y(), wrap_angle(theta)};
  sighting.covariance.setZero();
  sighting.covariance.topLeftCorner<2, 2>() =
      along_sigma * along_sigma * axis * axis.transpose() + across_sigma * across_sigma * across * across.transpose();
  sighting.covariance(2, 2) = heading_sigma * heading_sigma;
  sighting.shape = fixture.shape;
  sighting.length = visible;
  sighting.width = fixture.width;
  sighting.clipped = !near_end || !far_end;
  sighting.near_end_visible = near_end;
  sighting.far_end_visible = far_end;
  return sighting;
}

SightingFrame SyntheticWorld::look(const Pose2& pose, double, double) {
  SightingFrame frame;
  // the stamp is wrong by the camera's true time offset
  frame.utime = utime_ - static_cast<std::int64_t>(
                             std::lround(1e6 * (true_robot_.camera.time_offset - robot_.camera.time_offset)));
  for (std::size_t i = 0; i < true_building_.fixtures.size(); ++i) {
    const Fixture& fixture = true_building_.fixtures[i];
    if (distance(fixture.world_from_fixture, pose) > 3.0 || never_seen_[i]) {
      continue;
    }
    auto sighting = see(fixture, pose, false);
    if (sighting && uniform(0.0, 1.0) >= (lit_[i] ? options_.miss_lit : options_.miss_unlit)) {
      sighting->state = lit_[i] ? SightingState::kLit : SightingState::kUnlit;
      frame.sightings.push_back(*sighting);
    }
  }
  for (const Fixture& thing : clutter_) {
    if (distance(thing.world_from_fixture, pose) < 2.0) {
      const auto sighting = see(thing, pose, false);
      if (sighting && uniform(0.0, 1.0) < 0.5) {
        frame.sightings.push_back(*sighting);
      }
    }
  }
  if (uniform(0.0, 1.0) < options_.false_alarm && !true_building_.fixtures.empty()) {
    Fixture thing = true_building_.fixtures.front();
    thing.world_from_fixture = pose * Pose2{uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-kPi, kPi)};
    if (const auto sighting = see(thing, pose, true)) {
      frame.sightings.push_back(*sighting);
    }
  }
  return frame;
}

FixtureVisibility SyntheticWorld::visibility() const {
  std::vector<Fixture> fixtures;
  for (std::size_t i = 0; i < true_building_.fixtures.size(); ++i) {
    if (!never_seen_[i]) {
      fixtures.push_back(true_building_.fixtures[i]);
    }
  }
  return {std::move(fixtures), CeilingCamera(true_robot_.camera.intrinsics, true_robot_.camera.mounting)};
}

SonarScan SyntheticWorld::hear() {
  SonarScan scan;
  scan.utime = utime_;
  const int discs = static_cast<int>(robot_.sonar.robot_from_sonar.size());
  for (int i = 0; i < std::min(5, discs); ++i) {
    const int disc = next_disc_;
    next_disc_ = (next_disc_ + 3) % std::max(1, discs);
    SonarEcho reading{disc, robot_.sonar.maximum_range, false, utime_};
    const Pose2 world_from_sonar = truth_ * robot_.sonar.robot_from_sonar[static_cast<std::size_t>(disc)];
    Reaches reaches{};
    for (std::size_t ray = 0; ray < reaches.size(); ++ray) {
      const double heading = world_from_sonar.theta + (0.45 * static_cast<double>(ray) - 0.9) * robot_.sonar.half_angle;
      reaches[ray] = walls_.range_to_wall(world_from_sonar.position(), {std::cos(heading), std::sin(heading)},
                                          robot_.sonar.maximum_range);
    }
    double range = *std::min_element(reaches.begin(), reaches.end());
    const double lost = is_slanted(reaches) ? options_.sonar_dropout : kLostAtRightAngle;
    const double chance = uniform(0.0, 1.0);
    if (chance < 0.03) {
      range = uniform(0.3, range);  // somebody walks by
    } else if (chance < 0.03 + lost) {
      range = std::min(robot_.sonar.maximum_range,
                       range + uniform(0.0, 4.0));  // reflected away, heard over a detour or not
    }
    if (range < robot_.sonar.maximum_range - 0.05) {
      reading.range = std::max(robot_.sonar.minimum_range, range + gauss(0.01));
      reading.has_echo = true;
    }
    scan.readings.push_back(reading);
  }
  return scan;
}

}  // namespace luminav::testing
