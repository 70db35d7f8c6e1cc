#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <sstream>
#include <vector>

#include "services/mapper/grid_mapper.hpp"

namespace luminav {
namespace {

constexpr std::array<double, 8> kDirections = {-90.0, -37.5, -22.5, -7.5, 7.5, 22.5, 37.5, 90.0};  // [degrees]

std::vector<std::vector<double>> numbers_of(const std::string& name) {
  std::ifstream in(std::string(LUMINAV_SOURCE_DIR) + "/tests/data/sonar_corridor/" + name);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::vector<double> row;
    for (double value = 0.0; words >> value;) {
      row.push_back(value);
    }
    if (!row.empty()) {
      rows.push_back(row);
    }
  }
  return rows;
}

/// A wall of the corridor as fitted to the side echoes.
struct Wall {
  double offset;   // [m] y at x = 0
  double heading;  // [rad]
  double y_at(double x) const { return offset + std::tan(heading) * x; }
};
constexpr Wall kRight{-0.906, 0.33 * kPi / 180.0};
constexpr Wall kLeft{1.189, 0.01 * kPi / 180.0};

class SonarCorridor : public ::testing::Test {
 protected:
  SonarCorridor() : mapper_(params(), nothing_known(), 8) {
    const auto ranges = numbers_of("measurement.txt");
    const auto poses = numbers_of("poses.txt");
    std::array<double, 8> last{};
    for (std::size_t i = 0; i < std::min(ranges.size(), poses.size()); ++i) {
      const Pose2 robot{poses[i][1] * 1e-3, poses[i][2] * 1e-3, wrap_angle(radians(0.1 * poses[i][3]))};
      for (std::size_t disc = 0; disc < 8; ++disc) {
        const double range = ranges[i][disc + 1] * 1e-3;
        const bool stands = i > 0 && poses[i][1] == poses[i - 1][1] && poses[i][2] == poses[i - 1][2];
        if (!stands || range != last[disc]) {
          const Pose2 sonar = robot * Pose2{0.0, 0.0, radians(kDirections[disc])};
          mapper_.integrate({static_cast<int>(disc), static_cast<std::int64_t>(ranges[i][0] * 1e3), robot, sonar, range,
                             range < 5.0});
        }
        last[disc] = range;
      }
      mapper_.mark_robot(robot);
    }
  }

  static GridMapperParams params() {
    GridMapperParams params;
    params.sonar.half_angle = radians(10.0);
    params.sonar.minimum_range = 0.17;
    return params;
  }
  static PriorMap nothing_known() {
    PriorMap map{{0.1, {-6.0, -6.0}, 270, 130}, {}};
    map.cells.assign(map.geometry.size(), Prior::kUnknown);
    return map;
  }
  [[nodiscard]] bool has_wall_at(double x, double y) const {
    const Cell cell = mapper_.grid().geometry.cell_at({x, y});
    for (int row = cell.row - 1; row <= cell.row + 1; ++row) {
      for (int column = cell.column - 1; column <= cell.column + 1; ++column) {
        if (mapper_.is_occupied({column, row})) {
          return true;
        }
      }
    }
    return false;
  }
  /// Line through the occupied cells within 0.3 m of where the wall is.
  [[nodiscard]] Wall fitted(const Wall& wall) const {
    double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
    for (int row = 0; row < mapper_.grid().geometry.rows; ++row) {
      for (int column = 0; column < mapper_.grid().geometry.columns; ++column) {
        const Eigen::Vector2d p = mapper_.grid().geometry.centre_of({column, row});
        if (mapper_.is_occupied({column, row}) && p.x() > 0.5 && p.x() < 10.0 &&
            std::abs(p.y() - wall.y_at(p.x())) < 0.3) {
          n += 1.0;
          x += p.x();
          y += p.y();
          xx += p.x() * p.x();
          xy += p.x() * p.y();
        }
      }
    }
    const double slope = (n * xy - x * y) / (n * xx - x * x);
    return {(y - slope * x) / n, std::atan(slope)};
  }

  GridMapper mapper_;
};

TEST_F(SonarCorridor, HasBothWallsWhereTheyAre) {
  for (const Wall& wall : {kRight, kLeft}) {
    int points = 0;
    int found = 0;
    for (double x = 0.5; x <= 10.0; x += 0.05) {
      ++points;
      found += has_wall_at(x, wall.y_at(x)) ? 1 : 0;
    }
    EXPECT_GE(found, 0.9 * points);
  }
}

TEST_F(SonarCorridor, HasStraightAndParallelWalls) {
  const Wall right = fitted(kRight);
  const Wall left = fitted(kLeft);
  EXPECT_NEAR(left.y_at(5.0) - right.y_at(5.0), 2.10, 0.10);
  EXPECT_LT(std::abs(left.heading - right.heading), radians(1.0));
}

TEST_F(SonarCorridor, IsFreeBetweenThem) {
  const PriorMap map = mapper_.combined();
  int cells = 0;
  int free = 0;
  for (double x = 0.55; x < 12.0; x += 0.1) {
    for (double y = -0.45; y < 0.8; y += 0.1) {
      ++cells;
      free += map.at({x, y}) == Prior::kFree ? 1 : 0;
    }
  }
  EXPECT_GE(free, 0.96 * cells);
}

}  // namespace
}  // namespace luminav
