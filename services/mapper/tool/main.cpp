// Draws a map from foreign ranges and poses: what scripts/map runs.
#include <fmt/format.h>

#include <fstream>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "services/common/building/map_file.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/image/picture_file.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/option_values.hpp"
#include "services/mapper/grid_mapper.hpp"

namespace {

using namespace luminav;

using Row = std::vector<double>;

/// Numbers of a text file, a row a line; separated by commas, blanks or tabs. A first line of words is skipped.
std::vector<Row> read_table(const std::string& file) {
  std::ifstream in(file);
  if (!in) {
    throw std::runtime_error(file + ": cannot be read");
  }
  std::vector<Row> rows;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    Row row;
    std::string word;
    bool is_header = false;
    while (words >> word) {
      std::size_t used = 0;
      double value = 0.0;
      try {
        value = std::stod(word, &used);
      } catch (const std::exception&) {
        used = 0;
      }
      if (used != word.size() || !std::isfinite(value)) {
        is_header = number == 1;
        if (!is_header) {
          throw std::runtime_error(fmt::format("{}:{}: {} is not a number", file, number, word));
        }
      }
      row.push_back(value);
    }
    if (!is_header && !row.empty()) {
      rows.push_back(row);
    }
  }
  return rows;
}

struct Units {
  double time = 1e-6;  // [s] of one
  double range = 1.0;  // [m] of one
  double angle = 1.0;  // [rad] of one
};

GridGeometry geometry_for(const std::vector<Pose2>& poses, double margin, double resolution) {
  Eigen::Vector2d low = poses.front().position();
  Eigen::Vector2d high = low;
  for (const Pose2& pose : poses) {
    low = low.cwiseMin(pose.position());
    high = high.cwiseMax(pose.position());
  }
  GridGeometry geometry;
  geometry.resolution = resolution;
  geometry.origin = ((low.array() - margin) / resolution).floor() * resolution;
  geometry.columns = static_cast<int>(std::ceil((high.x() + margin - geometry.origin.x()) / resolution));
  geometry.rows = static_cast<int>(std::ceil((high.y() + margin - geometry.origin.y()) / resolution));
  if (geometry.columns > 4096 || geometry.rows > 4096) {
    throw std::runtime_error(
        fmt::format("the poses span {} x {} cells, must be at most 4096 x 4096", geometry.columns, geometry.rows));
  }
  return geometry;
}

void draw(const std::string& file, const GridMapper& mapper, const std::vector<Pose2>& poses) {
  constexpr int kPixels = 4;
  const GridGeometry& geometry = mapper.grid().geometry;
  cv::Mat picture(geometry.rows, geometry.columns, CV_8UC3);
  for (int row = 0; row < geometry.rows; ++row) {
    for (int column = 0; column < geometry.columns; ++column) {
      const double log_odds = mapper.grid().evidence[geometry.index({column, row})] / kEvidencePerLogOdds;
      const auto grey = static_cast<std::uint8_t>(255.0 / (1.0 + std::exp(2.0 * log_odds)));
      picture.at<cv::Vec3b>(geometry.rows - 1 - row, column) =
          mapper.is_occupied({column, row}) ? cv::Vec3b(0, 0, 0) : cv::Vec3b(grey, grey, grey);
    }
  }
  cv::resize(picture, picture, {}, kPixels, kPixels, cv::INTER_NEAREST);
  for (const Pose2& pose : poses) {
    const Eigen::Vector2d cells = (pose.position() - geometry.origin) / geometry.resolution;
    cv::circle(picture,
               {static_cast<int>(cells.x() * kPixels), static_cast<int>((geometry.rows - cells.y()) * kPixels)}, 1,
               {0, 0, 220}, cv::FILLED);
  }
  write_picture(file, picture);
}

/// Poses of the first rows [m, rad]; throws where a row does not fit that of the ranges beside it.
std::vector<Pose2> read_poses(const std::vector<Row>& pose_rows, const std::vector<Row>& ranges, std::size_t discs,
                              std::size_t count, const Units& units) {
  std::vector<Pose2> poses;
  for (std::size_t i = 0; i < count; ++i) {
    const Row& row = pose_rows[i];
    if (ranges[i].size() != discs + 1 || row.size() != 4 || ranges[i][0] != row[0]) {
      throw std::runtime_error(
          fmt::format("row {}: needs a time and {} ranges, a time and a pose, the times equal", i + 1, discs));
    }
    poses.push_back({row[1] * units.range, row[2] * units.range, wrap_angle(row[3] * units.angle)});
  }
  return poses;
}

GridMapper make_mapper(const RobotDescription& robot, SonarModelKind kind, const GridGeometry& geometry) {
  GridMapperParams params;
  params.sonar.kind = kind;
  params.sonar.half_angle = robot.sonar.half_angle;
  params.sonar.minimum_range = robot.sonar.minimum_range;
  params.sonar.maximum_range = robot.sonar.maximum_range;
  params.robot_radius = robot.inscribed_radius();
  const PriorMap prior{geometry, std::vector<Prior>(geometry.size(), Prior::kUnknown)};
  return {params, prior, static_cast<int>(robot.sonar.robot_from_sonar.size())};
}

void integrate(const std::vector<Row>& ranges, const std::vector<Pose2>& poses, const SonarRing& ring,
               const Units& units, GridMapper& mapper) {
  const std::size_t discs = ring.robot_from_sonar.size();
  std::vector<double> last(discs, -1.0);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto utime = static_cast<std::int64_t>(ranges[i][0] * units.time * 1e6) + 1;
    for (std::size_t disc = 0; disc < discs; ++disc) {
      const double range = ranges[i][disc + 1] * units.range;
      // rings that fire one disc after the other repeat the others' readings: each counts once
      const bool is_repeated = range == last[disc] && i > 0 && distance(poses[i], poses[i - 1]) < 1e-9;
      last[disc] = range;
      if (!is_repeated) {
        mapper.integrate({static_cast<int>(disc), utime, poses[i], poses[i] * ring.robot_from_sonar[disc], range,
                          range < ring.maximum_range});
      }
    }
    mapper.mark_robot(poses[i]);
  }
}

}  // namespace

int main(int argc, char** argv) {
  return run_guarded("map", [&] {
    std::string robot_file, ranges_file, poses_file, out_file, png_file, mode = "modern";
    Units units;
    std::int64_t max_rows = 0;
    double resolution = 0.1;
    CommandLine options(
        "map",
        "Draws a map from sonar ranges and poses. Each line of RANGES: time, then one range per disc of "
        "the robot's file; each line of POSES: time, x, y, heading; same times.");
    options.robot_file(robot_file)
        .text("--csv", ranges_file, "ranges", true)
        .text("--poses", poses_file, "poses", true)
        .output_file("--out", out_file, "map.yaml to write, with its PGM beside it")
        .output_file("--png", png_file, "picture to write")
        .text("--mode", mode, "paper (line) or modern (cone)")
        .number("--time-unit", units.time, "[s] of one unit of time, 0.001 for milliseconds")
        .number("--length-unit", units.range, "[m] of one unit of length, 0.001 for millimetres")
        .number("--angle-unit", units.angle, "[rad] of one unit of heading, 0.0174533 for degrees")
        .number("--resolution", resolution, "[m] side of a cell")
        .integer("--rows", max_rows, "use that many rows; 0 = all");
    if (const auto status = options.parse(argc, argv)) {
      return *status;
    }
    check_option("--mode", mode, {"paper", "modern"});
    check_option("--resolution", resolution, {0.01, 1.0});
    check_option("--time-unit", units.time, kPositive);
    check_option("--length-unit", units.range, kPositive);
    check_option("--angle-unit", units.angle, kPositive);
    check_option("--rows", static_cast<double>(max_rows), kNotNegative);
    const RobotDescription robot = read_robot(robot_file);
    const std::vector<Row> ranges = read_table(ranges_file);
    const std::vector<Row> pose_rows = read_table(poses_file);
    const std::size_t discs = robot.sonar.robot_from_sonar.size();
    if (ranges.size() != pose_rows.size() || ranges.empty()) {
      throw std::runtime_error(
          fmt::format("{} rows of ranges and {} of poses, must be equal and above 0", ranges.size(), pose_rows.size()));
    }
    const std::size_t count =
        max_rows > 0 ? std::min(ranges.size(), static_cast<std::size_t>(max_rows)) : ranges.size();
    const std::vector<Pose2> poses = read_poses(pose_rows, ranges, discs, count, units);
    GridMapper mapper = make_mapper(robot, mode == "paper" ? SonarModelKind::kLine : SonarModelKind::kCone,
                                    geometry_for(poses, 1.0 + robot.sonar.maximum_range, resolution));
    integrate(ranges, poses, robot.sonar, units, mapper);
    const PriorMap map = mapper.combined();
    fmt::print("{{\"rows\":{},\"columns\":{},\"cells_high\":{},\"occupied\":{},\"free\":{}}}\n", count,
               map.geometry.columns, map.geometry.rows,
               std::count(map.cells.begin(), map.cells.end(), Prior::kOccupied),
               std::count(map.cells.begin(), map.cells.end(), Prior::kFree));
    if (!out_file.empty()) {
      write_map(out_file, map);
    }
    if (!png_file.empty()) {
      draw(png_file, mapper, poses);
    }
    return 0;
  });
}
