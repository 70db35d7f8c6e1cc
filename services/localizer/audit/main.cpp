// Says from where in a building the ceiling does not tell the pose, and what would help.

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/shipped_file.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/common/image/picture_file.hpp"
#include "services/common/process/command_line.hpp"
#include "services/localizer/audit/ambiguity_audit.hpp"

namespace luminav {
namespace {

constexpr std::size_t kMaxStarts = 1000;  // 95 % of them tells the floor's within a few percent
constexpr double kLongDistance = 10.0;    // [m] drawn as red as it gets short of never

std::string in_metres(double distance) {
  return std::isinf(distance) ? "never" : fmt::format("{:.1f} m", distance);
}

/// What was found out.
struct Findings {
  const Building& building;
  const AuditFloor& floor;
  std::vector<AuditStart> starts;
  std::vector<AuditChange> changes;
};

/// Says on standard error what goes on, for a person who waits.
void say(const std::string& what) {
  fmt::print(stderr, "audit: {}\n", what);
}

std::vector<AuditStart> find_distances(const AuditFloor& floor) {
  const std::vector<std::int32_t> places = spread_starts(floor, kMaxStarts);
  say(fmt::format("how far to drive from {} of {} places until the pose is told?", places.size(),
                  floor.ground().points.size()));
  const std::size_t tenth = std::max<std::size_t>(1, places.size() / 10);
  return audit_starts(floor, places, [&](std::size_t done) {
    if (done % tenth == 0 && done < places.size()) {
      say(fmt::format("{} of {} places", done, places.size()));
    }
  });
}

void print(const Findings& findings) {
  const auto& [building, floor, starts, changes] = findings;
  const auto share = [&](const auto& claim) {
    return 100.0 * static_cast<double>(std::count_if(starts.begin(), starts.end(), claim)) /
           static_cast<double>(starts.size());
  };
  fmt::print("{}: {} fixtures, {} of {} places looked at, view of {:.2f} m radius\n", building.name,
             building.fixtures.size(), starts.size(), floor.ground().points.size(), floor.view_radius());
  fmt::print("known at once from {:.0f} % of the places; no fixture in view from {:.0f} %\n",
             share([](const AuditStart& start) { return start.distance == 0.0; }),
             share([&](const AuditStart& start) { return floor.is_blind(start.place); }));
  fmt::print("way to drive until the pose is resolvable: mean {:.2f} m, median {}, 95 % {}, longest {}\n",
             mean_distance(starts), in_metres(distance_quantile(starts, 0.5)),
             in_metres(distance_quantile(starts, 0.95)), in_metres(distance_quantile(starts, 1.0)));
  if (never_share(starts) > 0.0) {
    fmt::print("never resolvable from {:.1f} % of the places: part of the building maps onto itself\n",
               100.0 * never_share(starts));
  }
  for (const AuditChange& change : changes) {
    fmt::print(
        "would help: fixture {} of another kind, or a vent beside it written into the file: mean {:+.2f} m, "
        "never {:+.1f} %\n",
        change.fixture, change.mean_change, 100.0 * change.never_change);
  }
}

void write_json(const std::string& file, const Findings& findings) {
  const auto& [building, floor, starts, changes] = findings;
  const auto finite = [](double distance) {
    return std::isinf(distance) ? nlohmann::json(nullptr) : nlohmann::json(distance);
  };
  nlohmann::json report = {{"building", building.name},
                           {"fixtures", building.fixtures.size()},
                           {"view_radius_m", floor.view_radius()},
                           {"median_way_m", finite(distance_quantile(starts, 0.5))},
                           {"p95_way_m", finite(distance_quantile(starts, 0.95))},
                           {"mean_way_m", mean_distance(starts)},
                           {"never_share", never_share(starts)},
                           {"places_of_floor", floor.ground().points.size()},
                           {"places", nlohmann::json::array()},
                           {"changes", nlohmann::json::array()}};
  for (const AuditStart& start : starts) {
    const Eigen::Vector2d& point = floor.ground().points[static_cast<std::size_t>(start.place)];
    report["places"].push_back({{"x", point.x()},
                                {"y", point.y()},
                                {"blind", floor.is_blind(start.place)},
                                {"twins", start.aliases},
                                {"way_m", finite(start.distance)}});
  }
  for (const AuditChange& change : changes) {
    report["changes"].push_back({{"fixture", change.fixture},
                                 {"mean_way_change_m", change.mean_change},
                                 {"never_share_change", change.never_change}});
  }
  write_whole_file(file, report.dump(1) + "\n");
}

cv::Scalar colour_of(double distance) {
  if (std::isinf(distance)) {
    return {60, 0, 120};
  }
  const double share = std::min(1.0, distance / kLongDistance);
  return {80.0, 220.0 - 160.0 * share, 80.0 + 160.0 * share};  // blue, green, red: green to red
}

void draw_picture(const std::string& file, const Findings& findings) {
  const auto& [building, floor, starts, changes] = findings;
  const std::vector<Eigen::Vector2d>& points = floor.ground().points;
  Eigen::AlignedBox2d box;
  std::for_each(points.begin(), points.end(), [&](const Eigen::Vector2d& point) { box.extend(point); });
  const double margin = 0.8;  // [m]
  const double scale = std::clamp(1500.0 / std::max(1.0, box.sizes().maxCoeff() + 2.0 * margin), 4.0, 80.0);
  const auto pixel = [&](const Eigen::Vector2d& point) {
    return cv::Point(static_cast<int>(scale * (point.x() - box.min().x() + margin)),
                     static_cast<int>(scale * (box.max().y() - point.y() + margin)));
  };
  const cv::Point corner = pixel({box.max().x() + margin, box.min().y() - margin});
  cv::Mat image(corner.y + 1, corner.x + 1, CV_8UC3, cv::Scalar(40, 40, 40));
  const auto fill = [&](const Eigen::Vector2d& point, double half, const cv::Scalar& colour) {
    cv::rectangle(image, pixel(point + Eigen::Vector2d(-half, half)), pixel(point + Eigen::Vector2d(half, -half)),
                  colour, cv::FILLED);
  };
  for (const Eigen::Vector2d& point : points) {
    fill(point, 0.5 * AuditFloor::kCell, {90, 90, 90});
  }
  const double places_per_start = static_cast<double>(points.size()) / static_cast<double>(starts.size());
  for (const AuditStart& start : starts) {  // each as large as its share of the floor, with a rim to tell them apart
    fill(points[static_cast<std::size_t>(start.place)],
         (places_per_start > 1.0 ? 0.35 : 0.5) * AuditFloor::kCell * std::sqrt(places_per_start),
         colour_of(start.distance));
  }
  for (const Fixture& fixture : building.fixtures) {
    std::vector<cv::Point> outline;
    for (const auto& [u, v] : {std::pair(-0.5, -0.5), {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
      outline.push_back(pixel(fixture.world_from_fixture * Eigen::Vector2d(u * fixture.length, v * fixture.width)));
    }
    const bool helps =
        std::any_of(changes.begin(), changes.end(), [&](const AuditChange& c) { return c.fixture == fixture.id; });
    cv::polylines(image, std::vector<std::vector<cv::Point>>{outline}, true,
                  helps ? cv::Scalar(255, 120, 0) : cv::Scalar(255, 255, 255), helps ? 3 : 1, cv::LINE_AA);
    cv::putText(image, std::to_string(fixture.id), pixel(fixture.world_from_fixture.position()),
                cv::FONT_HERSHEY_SIMPLEX, 0.4, cv::Scalar(0, 0, 0), 1, cv::LINE_AA);
  }
  cv::putText(image, fmt::format("green: known at once, red: after {:.0f} m, purple: never", kLongDistance), {8, 16},
              cv::FONT_HERSHEY_SIMPLEX, 0.45, cv::Scalar(255, 255, 255), 1, cv::LINE_AA);
  write_picture(file, image);
}

int run(int argc, char** argv) {
  std::vector<std::string> buildings;
  std::string robot_file;
  std::string json_file;
  std::string png_file;
  CommandLine line("audit",
                   "Says from where in a building the ceiling's fixtures do not tell the pose, how far the "
                   "robot must drive until they do, and which change would help.");
  line.positional("building", buildings, "building file, or its folder", true);
  line.text("--robot", robot_file, "robot file, for the camera; default: robots/p3dx.toml that comes with the project")
      .output_file("--json", json_file, "where the result is written, place by place")
      .output_file("--png", png_file, "where a picture is written");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  if (buildings.size() != 1) {
    throw ConfigurationError("found more than one building, expected one");
  }
  if (robot_file.empty() && (robot_file = shipped_file("robots/p3dx.toml")).empty()) {
    throw ConfigurationError("the camera is known by the robot's file only: give --robot FILE");
  }
  std::filesystem::path file = buildings.front();
  if (std::filesystem::is_directory(file)) {
    file /= "building.toml";
  }
  const Building building = read_building(file);
  const PriorMap walls = building.map_file.empty() ? PriorMap{} : read_map(building.map_file);
  if (building.fixtures.empty()) {
    throw std::runtime_error(file.string() + ": names no fixtures");
  }
  const AuditFloor floor(building, walls, read_robot(std::filesystem::path(robot_file)).camera);
  if (floor.ground().points.empty()) {
    throw std::runtime_error(file.string() + ": its map has no place where a robot could stand");
  }
  std::vector<AuditStart> starts = find_distances(floor);
  say("which change would help?");
  std::vector<AuditChange> changes = best_changes(floor, starts, 3);
  const Findings findings{building, floor, std::move(starts), std::move(changes)};
  print(findings);
  if (!json_file.empty()) {
    write_json(json_file, findings);
  }
  if (!png_file.empty()) {
    draw_picture(png_file, findings);
  }
  return 0;
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  return luminav::run_guarded("audit", [&] { return luminav::run(argc, argv); });
}
