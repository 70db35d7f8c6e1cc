#include "services/surveyor/fixture_layout.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kWallClearance = 0.75;  // [m] from a fixture's centre to a wall: half a tube and a hand
constexpr double kVentSize = 0.6;        // [m] one ceiling tile
constexpr double kDetectorSize = 0.12;   // [m] diameter of a smoke detector

double to_millimetres(double value) {
  return std::round(value * 1000.0) / 1000.0;
}

double clamp_between(double value, double low, double high) {
  return low > high ? 0.5 * (low + high) : std::clamp(value, low, high);
}

}  // namespace

FixtureLayout::FixtureLayout(const FloorPlanParams& params, Building& building)
    : params_(params), building_(building), rng_(params.seed * 2 + 1) {
  room_theta_ = chance(0.5) ? 0.5 * kPi : 0.0;
}

double FixtureLayout::uniform(double low, double high) {
  return low + (high - low) * static_cast<double>(rng_() >> 11) * 0x1p-53;
}

bool FixtureLayout::chance(double probability) {
  return uniform(0.0, 1.0) < probability;
}

bool FixtureLayout::is_taken(const Eigen::Vector2d& position, double radius) const {
  const auto near = [&](const Pose2& pose) { return (pose.position() - position).norm() < radius; };
  return std::any_of(building_.fixtures.begin(), building_.fixtures.end(),
                     [&](const Fixture& fixture) { return near(fixture.world_from_fixture); }) ||
         std::any_of(building_.elements.begin(), building_.elements.end(),
                     [&](const CeilingElement& element) { return near(element.world_from_element); });
}

void FixtureLayout::hang(const Eigen::Vector2d& position, double theta, bool in_corridor) {
  const double reach = 0.3;  // [m] how far a shifted one may go
  hang_in({position.array() - kWallClearance - reach, position.array() + kWallClearance + reach}, position, theta,
          params_.kind == FixtureKind::kMixed ? FixtureKind::kTubes : params_.kind, in_corridor);
}

void FixtureLayout::hang_in(const FloorRectangle& area, const Eigen::Vector2d& position, double theta, FixtureKind kind,
                            bool in_corridor) {
  const double irregularity = params_.irregularity;
  if (chance(0.12 * irregularity)) {
    return;  // never installed
  }
  if (chance(0.12 * irregularity) && !in_corridor) {
    theta += 0.5 * kPi;
  }
  const double shift = 0.3 * irregularity;
  const double x = position.x() + uniform(-shift, shift);
  const double y = position.y() + uniform(-shift, shift);
  Fixture fixture;
  fixture.id = static_cast<int>(building_.fixtures.size()) + 1;
  fixture.height = params_.ceiling_height;
  fixture.world_from_fixture = {
      to_millimetres(clamp_between(x, area.low.x() + kWallClearance, area.high.x() - kWallClearance)),
      to_millimetres(clamp_between(y, area.low.y() + kWallClearance, area.high.y() - kWallClearance)),
      wrap_angle(theta)};
  if (kind == FixtureKind::kTubes) {
    fixture.width = in_corridor ? 0.15 : 0.3;
    fixture.lamps = in_corridor ? 1 : 2;
  } else if (kind == FixtureKind::kDownlights && in_corridor) {
    fixture.shape = FixtureShape::kRound;
    fixture.length = fixture.width = 0.25;
    fixture.lamps = 1;
  } else {
    fixture.shape = FixtureShape::kSquare;
    fixture.length = fixture.width = 0.6;
    fixture.lamps = 4;
  }
  building_.fixtures.push_back(fixture);
}

void FixtureLayout::light_corridor(const FloorRectangle& corridor) {
  const bool along_x = corridor.size().x() >= corridor.size().y();
  const double length = along_x ? corridor.size().x() : corridor.size().y();
  const int count = std::max(1, static_cast<int>(std::lround(length / params_.pitch)));
  const double theta = along_x ? 0.0 : 0.5 * kPi;
  for (int i = 0; i < count; ++i) {
    Eigen::Vector2d position = corridor.centre();
    (along_x ? position.x() : position.y()) =
        (along_x ? corridor.low.x() : corridor.low.y()) + (i + 0.5) * length / count;
    const FixtureKind kind = params_.kind == FixtureKind::kMixed ? FixtureKind::kTubes : params_.kind;
    if (!is_taken(position, 1.2)) {  // where two corridors cross, one fixture is enough
      hang_in(corridor, position, theta, kind, true);
    }
    if (i % 3 == 2 && i + 1 < count) {
      (along_x ? position.x() : position.y()) += 0.5 * length / count + uniform(-0.4, 0.4) * params_.irregularity;
      add_detector(position);
    }
  }
}

void FixtureLayout::light_room(const FloorRectangle& room) {
  const int columns = std::max(1, static_cast<int>(std::lround(room.size().x() / params_.pitch)));
  const int rows = std::max(1, static_cast<int>(std::lround(room.size().y() / params_.pitch)));
  FixtureKind kind = params_.kind;
  if (kind == FixtureKind::kMixed) {
    kind = chance(0.5) ? FixtureKind::kTubes : FixtureKind::kPanels;
  }
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector2d position(room.low.x() + (column + 0.5) * room.size().x() / columns,
                                     room.low.y() + (row + 0.5) * room.size().y() / rows);
      hang_in(room, position, room_theta_, kind, false);
    }
  }
  for (int attempt = 0; attempt < 5 && chance(0.7); ++attempt) {
    const Eigen::Vector2d position(uniform(room.low.x() + 0.6, room.high.x() - 0.6),
                                   uniform(room.low.y() + 0.6, room.high.y() - 0.6));
    if (!is_taken(position, 1.1)) {
      add_vent(position);
      break;
    }
  }
  add_detector(room.centre());
}

void FixtureLayout::add_vent(const Eigen::Vector2d& position) {
  building_.elements.push_back({.kind = ElementKind::kVent,
                                .world_from_element = {to_millimetres(position.x()), to_millimetres(position.y()), 0.0},
                                .length = kVentSize,
                                .width = kVentSize});
}

void FixtureLayout::add_detector(const Eigen::Vector2d& position) {
  if (is_taken(position, 0.8)) {
    return;
  }
  building_.elements.push_back({.kind = ElementKind::kDetector,
                                .world_from_element = {to_millimetres(position.x()), to_millimetres(position.y()), 0.0},
                                .length = kDetectorSize,
                                .width = kDetectorSize});
}

}  // namespace luminav
