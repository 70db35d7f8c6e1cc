// Says from where in a building the ceiling does not tell the pose, and what would help.

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <future>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
#include <thread>
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

constexpr double kLongDistance = 10.0;  // [m] drawn as red as it gets short of never

std::string in_metres(double distance) {
  return std::isinf(distance) ? "never" : fmt::format("{:.1f} m", distance);
}

/// What was found out, with the length [m] of the walk that resolves each place.
struct Findings {
  const Building& building;
  const AmbiguityAudit& audit;
  std::vector<double> distances;
  std::vector<AuditChange> changes;

  /// Way [m] that a share of the places needs at most; infinite when more than the rest never resolve.
  [[nodiscard]] double distance_quantile(double share) const {
    std::vector<double> sorted = distances;
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
  }
};

/// Says on standard error what goes on, for a person who waits.
void say(const std::string& what) {
  fmt::print(stderr, "audit: {}\n", what);
}

void say_share(std::size_t done, std::size_t count) {
  const std::size_t tenth = std::max<std::size_t>(1, count / 10);
  if (done % tenth == 0 && done < count) {
    say(fmt::format("{} of {} places", done, count));
  }
}

// Each thread takes a stretch of neighbouring places.
std::vector<double> resolving_distances(const RivalGround& ground) {
  std::atomic<std::size_t> done = 0;
  const std::size_t count = ground.points.size();
  const std::size_t threads = std::max(1U, std::thread::hardware_concurrency());
  std::vector<double> distances(count);
  std::vector<std::future<void>> stretches;
  for (std::size_t t = 0; t < threads; ++t) {
    stretches.push_back(std::async(std::launch::async, [&, t] {
      ResolvingWalk walk(ground);
      for (std::size_t i = t * count / threads; i < (t + 1) * count / threads; ++i) {
        distances[i] = walk.length(static_cast<std::int32_t>(i));
        say_share(++done, count);
      }
    }));
  }
  for (std::future<void>& stretch : stretches) {
    stretch.get();
  }
  return distances;
}

void print(const Findings& findings) {
  const auto& [building, audit, distances, changes] = findings;
  const auto count = static_cast<double>(distances.size());
  const auto known_at_once = static_cast<double>(std::count(distances.begin(), distances.end(), 0.0));
  const auto blind = static_cast<double>(std::count_if(audit.places().begin(), audit.places().end(),
                                                       [](const AuditPlace& place) { return place.is_blind; }));
  fmt::print("{}: {} fixtures, {} places looked at, view of {:.2f} m radius\n", building.name, building.fixtures.size(),
             audit.places().size(), audit.view_radius());
  fmt::print("known at once from {:.0f} % of the places; no fixture in view from {:.0f} %\n",
             100.0 * known_at_once / count, 100.0 * blind / count);
  fmt::print("way to drive until the pose is resolvable: median {}, 95 % {}, longest {}\n",
             in_metres(findings.distance_quantile(0.5)), in_metres(findings.distance_quantile(0.95)),
             in_metres(findings.distance_quantile(1.0)));
  fmt::print("likewise if twins need not all be refuted on one drive: mean {:.2f} m\n", audit.mean_min_distance());
  if (audit.never_share() > 0.0) {
    fmt::print("never resolvable from {:.1f} % of the places: part of the building maps onto itself\n",
               100.0 * audit.never_share());
  }
  for (const AuditChange& change : changes) {
    fmt::print(
        "would help: fixture {} of another kind, or a vent beside it written into the file: that mean {:.2f} m, "
        "never {:.1f} %\n",
        change.fixture, change.mean_min_distance, 100.0 * change.never_share);
  }
}

void write_json(const std::string& file, const Findings& findings) {
  const auto& [building, audit, distances, changes] = findings;
  const auto finite = [](double distance) {
    return std::isinf(distance) ? nlohmann::json(nullptr) : nlohmann::json(distance);
  };
  nlohmann::json report = {{"building", building.name},
                           {"fixtures", building.fixtures.size()},
                           {"view_radius_m", audit.view_radius()},
                           {"median_way_m", finite(findings.distance_quantile(0.5))},
                           {"p95_way_m", finite(findings.distance_quantile(0.95))},
                           {"mean_least_way_m", audit.mean_min_distance()},
                           {"never_share", audit.never_share()},
                           {"places", nlohmann::json::array()},
                           {"changes", nlohmann::json::array()}};
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const AuditPlace& place = audit.places()[i];
    report["places"].push_back({{"x", place.point.x()},
                                {"y", place.point.y()},
                                {"blind", place.is_blind},
                                {"twins", place.aliases},
                                {"least_way_m", finite(place.min_distance)},
                                {"way_m", finite(distances[i])}});
  }
  for (const AuditChange& change : changes) {
    report["changes"].push_back({{"fixture", change.fixture},
                                 {"mean_least_way_m", change.mean_min_distance},
                                 {"never_share", change.never_share}});
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
  const auto& [building, audit, distances, changes] = findings;
  Eigen::Vector2d min(1e9, 1e9);
  Eigen::Vector2d max(-1e9, -1e9);
  for (const AuditPlace& place : audit.places()) {
    min = min.cwiseMin(place.point);
    max = max.cwiseMax(place.point);
  }
  const double margin = 0.8;  // [m]
  const double scale = std::clamp(1500.0 / std::max(1.0, (max - min).maxCoeff() + 2.0 * margin), 4.0, 80.0);
  const auto pixel = [&](const Eigen::Vector2d& point) {
    return cv::Point(static_cast<int>(scale * (point.x() - min.x() + margin)),
                     static_cast<int>(scale * (max.y() - point.y() + margin)));
  };
  const cv::Point corner = pixel({max.x() + margin, min.y() - margin});
  cv::Mat image(corner.y + 1, corner.x + 1, CV_8UC3, cv::Scalar(40, 40, 40));
  const double half = 0.5 * audit.params().cell;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const Eigen::Vector2d& point = audit.places()[i].point;
    cv::rectangle(image, pixel(point + Eigen::Vector2d(-half, half)), pixel(point + Eigen::Vector2d(half, -half)),
                  colour_of(distances[i]), cv::FILLED);
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
  bool with_elements = false;
  CommandLine line("audit",
                   "Says from where in a building the ceiling's fixtures do not tell the pose, how far the "
                   "robot must drive until they do, and which change would help.");
  line.positional("building", buildings, "building file, or its folder", true);
  line.text("--robot", robot_file, "robot file, for the camera; default: robots/p3dx.toml that comes with the project")
      .output_file("--json", json_file, "where the result is written, place by place")
      .output_file("--png", png_file, "where a picture is written")
      .flag("--elements", with_elements, "vents, detectors and the like count as landmarks too");
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
  AuditParams params;
  params.with_elements = with_elements;
  say(fmt::format("where do {} fixtures look alike?", building.fixtures.size()));
  const AmbiguityAudit audit(building, walls, read_robot(std::filesystem::path(robot_file)).camera, params);
  if (audit.places().empty()) {
    throw std::runtime_error(file.string() + ": its map has no place where a robot could stand");
  }
  say(fmt::format("how far to drive from each of {} places until the pose is told?", audit.places().size()));
  std::vector<double> distances = resolving_distances(audit.ground());
  say("which change would help?");
  const Findings findings{building, audit, std::move(distances), audit.best_changes(3)};
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
