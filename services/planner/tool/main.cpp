// Plans on a foreign map: what scripts/plan runs.
#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "services/common/building/map_file.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/common/image/picture_file.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/option_values.hpp"
#include "services/planner/path/route_planner.hpp"

namespace {

using namespace luminav;

constexpr int kPixelsPerCell = 3;

void draw(const std::string& file, const RoutePlanner& planner, const Route& route, const RouteRequest& request) {
  const ConfigurationSpace& space = planner.space();
  const GridGeometry& geometry = space.geometry();
  cv::Mat picture(geometry.rows, geometry.columns, CV_8UC3);
  for (int row = 0; row < geometry.rows; ++row) {
    for (int column = 0; column < geometry.columns; ++column) {
      const Cell cell{column, row};
      const auto dearness = static_cast<int>(6.0 * (space.price_at(geometry.centre_of(cell)) - 1.0));
      const auto shade = static_cast<std::uint8_t>(255 - std::min(80, dearness));
      picture.at<cv::Vec3b>(geometry.rows - 1 - row, column) = space.is_solid(cell)     ? cv::Vec3b(40, 40, 40)
                                                               : space.is_blocked(cell) ? cv::Vec3b(170, 170, 190)
                                                                                        : cv::Vec3b(255, shade, shade);
    }
  }
  cv::resize(picture, picture, {}, kPixelsPerCell, kPixelsPerCell, cv::INTER_NEAREST);
  const auto pixel = [&](const Eigen::Vector2d& p) {
    const Eigen::Vector2d cells = (p - geometry.origin) / geometry.resolution;
    return cv::Point(static_cast<int>(cells.x() * kPixelsPerCell),
                     static_cast<int>((geometry.rows - cells.y()) * kPixelsPerCell));
  };
  for (std::size_t i = 1; i < route.points.size(); ++i) {
    cv::line(picture, pixel(route.points[i - 1]), pixel(route.points[i]), {0, 0, 220}, 2, cv::LINE_AA);
  }
  cv::circle(picture, pixel(request.start), 5, {0, 160, 0}, cv::FILLED, cv::LINE_AA);
  cv::circle(picture, pixel(request.goal), 5, {220, 0, 0}, cv::FILLED, cv::LINE_AA);
  write_picture(file, picture);
}

const char* name_of(RouteOutcome outcome) {
  switch (outcome) {
    case RouteOutcome::kFound:
      return "found";
    case RouteOutcome::kGoalOutside:
      return "goal outside the map";
    case RouteOutcome::kGoalBlocked:
      return "goal in or beside an obstacle";
    case RouteOutcome::kStartOutside:
      return "start outside the map";
    case RouteOutcome::kStartEnclosed:
      return "start enclosed by obstacles, or the goal's room is closed";
    case RouteOutcome::kUnreachable:
      return "no way leads there";
  }
  return "";
}

/// Start and goal [m] of the words MAP.yaml X Y X Y.
RouteRequest read_request(const std::vector<std::string>& words, double tolerance) {
  if (words.size() != 5) {
    throw ConfigurationError("needs MAP.yaml X Y X Y; see --help");
  }
  double numbers[4];
  for (std::size_t i = 0; i < 4; ++i) {
    const std::optional<double> number = read_number(words[i + 1]);
    if (!number) {
      throw ConfigurationError(fmt::format("found {}, expected a number [m]", words[i + 1]));
    }
    numbers[i] = *number;
  }
  return {{numbers[0], numbers[1]}, {numbers[2], numbers[3]}, tolerance};
}

nlohmann::json report_of(const Route& route, const ConfigurationSpace& space, double milliseconds) {
  nlohmann::json report = {{"outcome", name_of(route.outcome)},
                           {"found", route.outcome == RouteOutcome::kFound},
                           {"milliseconds", milliseconds},
                           {"columns", space.geometry().columns},
                           {"rows", space.geometry().rows}};
  if (route.outcome == RouteOutcome::kFound) {
    double min = 1e9;
    for (const Eigen::Vector2d& point : route.points) {
      min = std::min(min, space.clearance_at(point));
      report["points"].push_back({point.x(), point.y()});
    }
    report["length_m"] = polyline_length(route.points);
    report["least_clearance_m"] = min;
    report["goal_gap_m"] = route.goal_gap;
  } else if (route.nearest_reachable) {
    report["nearest_reachable"] = {route.nearest_reachable->x(), route.nearest_reachable->y()};
  }
  return report;
}

}  // namespace

int main(int argc, char** argv) {
  return run_guarded("plan", [&] {
    std::vector<std::string> arguments;
    std::string json_file, png_file, mode = "modern", side = "none";
    double resolution = 0.1, tolerance = 0.15, radius = 0.30;
    bool unknown_free = false;
    CommandLine options("plan", "Plans a way on a map of the ROS map_server format.");
    options.positional("ROUTE", arguments, "MAP.yaml X Y X Y: map, start and goal [m]", true)
        .output_file("--json", json_file, "where the way is written")
        .output_file("--png", png_file, "where a picture is written")
        .text("--mode", mode, "paper or modern")
        .number("--resolution", resolution, "cell [m] that the map is brought to")
        .number("--tolerance", tolerance, "[m] a blocked goal may be missed by")
        .number("--radius", radius, "[m] to keep from obstacles at least")
        .text("--keep-side", side, "none, right or left: of corridors wide enough for two")
        .flag("--unknown-free", unknown_free, "plan through what the map does not know");
    if (const auto status = options.parse(argc, argv)) {
      return *status;
    }
    const RouteRequest request = read_request(arguments, tolerance);
    check_option("--mode", mode, {"paper", "modern"});
    check_option("--keep-side", side, {"none", "right", "left"});
    check_option("--resolution", resolution, {0.01, 1.0});
    check_option("--tolerance", tolerance, {0.0, 100.0});
    check_option("--radius", radius, {0.0, 14.0 * resolution});  // as the configuration space allows
    const PriorMap map = resample(read_map(arguments[0]), resolution);
    OccupancyGrid grid(map.geometry);
    grid.prior = map.cells;
    RoutePlannerParams params;
    params.mode = mode == "paper" ? PlannerMode::kPaper : PlannerMode::kModern;
    params.space.hard_radius = radius;
    params.space.unknown_is_free = unknown_free;
    params.shaping.keep_side = side_called(side);
    RoutePlanner planner(params);
    const auto begin = std::chrono::steady_clock::now();
    planner.set_grid(grid, {});
    const Route route = planner.plan(request);
    const double milliseconds =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    nlohmann::json report = report_of(route, planner.space(), milliseconds);
    if (!json_file.empty()) {
      write_whole_file(json_file, report.dump(1) + "\n");
    }
    if (!png_file.empty()) {
      draw(png_file, planner, route, request);
    }
    report.erase("points");
    fmt::print("{}\n", report.dump());
    return route.outcome == RouteOutcome::kFound ? 0 : 1;
  });
}
