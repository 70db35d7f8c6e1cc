#include "tests/evaluation/report/html_drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <luminav/pose_t.hpp>
#include <opencv2/imgcodecs.hpp>

#include "drivers/simulator/world/scenario.hpp"
#include "drivers/simulator/world/world_truth.hpp"
#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/robot_file.hpp"

namespace luminav {
namespace {

constexpr std::size_t kMaxPoints = 1200;  // of a drawn way
constexpr double kTrailPeriod = 0.1;      // [s] between the points of a trail
constexpr double kFastest = 1.5;          // [m/s] no robot drives faster: such a step between points is a jump,
constexpr double kJump = 1.5;             // [m] when it is as long as this

std::string base64(const std::vector<std::uint8_t>& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::uint32_t group = (static_cast<std::uint32_t>(bytes[i]) << 16U) |
                                (i + 1 < bytes.size() ? static_cast<std::uint32_t>(bytes[i + 1]) << 8U : 0U) |
                                (i + 2 < bytes.size() ? static_cast<std::uint32_t>(bytes[i + 2]) : 0U);
    text += kDigits[(group >> 18U) & 63U];
    text += kDigits[(group >> 12U) & 63U];
    text += i + 1 < bytes.size() ? kDigits[(group >> 6U) & 63U] : '=';
    text += i + 2 < bytes.size() ? kDigits[group & 63U] : '=';
  }
  return text;
}

/// [m] of a map.
struct Frame {
  double left;
  double top;  // the largest y
  double width;
  double height;
};

Frame frame_of(const GridGeometry& g) {
  const double height = g.rows * g.resolution;
  return {g.origin.x(), g.origin.y() + height, g.columns * g.resolution, height};
}

/// Points of one colour: polylines, broken where the state changes or the pose jumps.
class Strokes {
 public:
  explicit Strokes(const Frame& frame) : frame_(frame) {}
  void add(const Pose2& from, const Pose2& to, bool joined) {
    if (!joined || path_.empty()) {
      path_ += fmt::format("M{:.2f} {:.2f}", from.x - frame_.left, frame_.top - from.y);
    }
    path_ += fmt::format("L{:.2f} {:.2f}", to.x - frame_.left, frame_.top - to.y);
  }
  [[nodiscard]] std::string svg(const char* style) const {
    return path_.empty() ? "" : fmt::format("<path class=\"{}\" d=\"{}\"/>", style, path_);
  }

 private:
  Frame frame_;
  std::string path_;
};

std::vector<TrailPoint> thinned(const std::vector<TrailPoint>& trail) {
  const std::size_t every = std::max<std::size_t>(1, trail.size() / kMaxPoints);
  std::vector<TrailPoint> kept;
  for (std::size_t i = 0; i < trail.size(); i += every) {
    kept.push_back(trail[i]);
  }
  return kept;
}

}  // namespace

std::string html_escape(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '&':
        escaped += "&amp;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string map_symbol(const RunReport& run, const std::string& map_id) {
  if (run.scenario_file.empty()) {
    return "";
  }
  const Scenario scenario = read_scenario(run.scenario_file);
  const Building building = read_building(scenario.building_file);
  if (building.map_file.empty()) {
    return "";
  }
  const PriorMap map = read_map(building.map_file);
  // Transparent where it is free, so that it goes with a light and with a dark page.
  cv::Mat picture(map.geometry.rows, map.geometry.columns, CV_8UC4);
  for (int row = 0; row < picture.rows; ++row) {
    for (int column = 0; column < picture.cols; ++column) {
      const Prior cell = map.cells[map.geometry.index({column, row})];
      picture.at<cv::Vec4b>(picture.rows - 1 - row, column) = cell == Prior::kFree       ? cv::Vec4b(0, 0, 0, 0)
                                                              : cell == Prior::kOccupied ? cv::Vec4b(118, 108, 98, 255)
                                                                                         : cv::Vec4b(128, 128, 128, 40);
    }
  }
  std::vector<std::uint8_t> png;
  cv::imencode(".png", picture, png);
  const Frame frame = frame_of(map.geometry);
  std::string symbol = fmt::format(
      "<symbol id=\"{}\" viewBox=\"0 0 {:.2f} {:.2f}\"><image class=\"map\" width=\"{:.2f}\" height=\"{:.2f}\" "
      "href=\"data:image/png;base64,{}\"/>",
      map_id, frame.width, frame.height, frame.width, frame.height, base64(png));
  for (const Fixture& fixture : building.fixtures) {
    const Pose2& pose = fixture.world_from_fixture;
    symbol += fmt::format(
        "<rect class=\"lamp\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" "
        "transform=\"translate({:.2f} "
        "{:.2f}) rotate({:.1f})\"/>",
        -0.5 * fixture.length, -0.5 * fixture.width, fixture.length, fixture.width, pose.x - frame.left,
        frame.top - pose.y, -degrees(pose.theta));
  }
  return symbol + "</symbol>";
}

std::string trajectory_svg(const RunReport& run, const std::string& map_id) {
  if (run.scenario_file.empty() || run.trail.empty()) {
    return "";
  }
  Scenario scenario = read_scenario(run.scenario_file);
  scenario.seed = run.seed;
  const Building building = read_building(scenario.building_file);
  if (building.map_file.empty()) {
    return "";
  }
  const WorldTruth world = draw_world(scenario, building, read_robot(scenario.robot_file));
  const Frame frame = frame_of(world.walls.geometry);
  Strokes truth(frame);
  Strokes odometry(frame);
  Strokes tracking(frame);
  std::string guesses;
  const std::vector<TrailPoint> trail = thinned(run.trail);
  std::optional<Pose2> world_from_odometry;
  bool is_path_joined = false;  // the step before was drawn
  const double points_per_kept_one = static_cast<double>(run.trail.size()) / kMaxPoints;
  const double step = std::max(kJump, kFastest * kTrailPeriod * points_per_kept_one);
  for (std::size_t i = 1; i < trail.size(); ++i) {
    const TrailPoint& a = trail[i - 1];
    const TrailPoint& b = trail[i];
    truth.add(a.truth, b.truth, i > 1);
    const bool tracks = b.state == pose_t::STATE_TRACKING;
    if (tracks && !world_from_odometry) {
      world_from_odometry = b.believed * b.odometry.inverse();
    } else if (world_from_odometry && distance(a.odometry, b.odometry) < step) {
      odometry.add(*world_from_odometry * a.odometry, *world_from_odometry * b.odometry, false);
    }
    const bool is_drawn = tracks && distance(a.believed, b.believed) < step;
    if (is_drawn) {
      tracking.add(a.believed, b.believed, is_path_joined && a.state == pose_t::STATE_TRACKING);
    }
    is_path_joined = is_drawn;
    if (!tracks) {
      guesses += fmt::format("<circle class=\"guess\" cx=\"{:.2f}\" cy=\"{:.2f}\" r=\".06\"/>",
                             b.believed.x - frame.left, frame.top - b.believed.y);
    }
  }
  std::string svg = fmt::format(
      "<svg class=\"way\" viewBox=\"0 0 {:.2f} {:.2f}\"><use href=\"#{}\" width=\"{:.2f}\" height=\"{:.2f}\"/>",
      frame.width, frame.height, map_id, frame.width, frame.height);
  for (const Obstacle& obstacle : world.obstacles) {
    if (obstacle.world_from_obstacle) {
      const Pose2& pose = *obstacle.world_from_obstacle;
      svg += fmt::format(
          "<rect class=\"box\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" "
          "transform=\"translate({:.2f} {:.2f}) rotate({:.1f})\"/>",
          -0.5 * obstacle.length, -0.5 * obstacle.width, obstacle.length, obstacle.width, pose.x - frame.left,
          frame.top - pose.y, -degrees(pose.theta));
    }
  }
  svg += truth.svg("truth") + odometry.svg("odometry") + guesses + tracking.svg("tracking");
  const double letter = std::max(frame.width, frame.height) / 45.0;
  const auto mark = [&](double x, double y, const char* style, const std::string& text) {
    svg += fmt::format(
        "<circle class=\"{}\" cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\"/><text class=\"{}\" x=\"{:.2f}\" y=\"{:.2f}\" "
        "font-size=\"{:.2f}\">{}</text>",
        style, x - frame.left, frame.top - y, 0.3 * letter, style, x - frame.left + 0.45 * letter,
        frame.top - y - 0.35 * letter, letter, text);
  };
  mark(trail.front().truth.x, trail.front().truth.y, "start", "start");
  constexpr std::size_t kMaxGoals = 12;
  for (std::size_t i = 0; i < std::min(run.goals.size(), kMaxGoals); ++i) {
    const GoalResult& goal = run.goals[i];
    const bool right = goal.expect_refused ? goal.refused : goal.reached;
    mark(goal.x, goal.y, right ? "goal" : "goal missed", std::to_string(i + 1));
  }
  for (const ContactEvent& contact : run.drive.contacts) {
    svg += fmt::format("<path class=\"contact\" d=\"M{0:.2f} {1:.2f}l{2:.2f} {2:.2f}m0 -{2:.2f}l-{2:.2f} {2:.2f}\"/>",
                       contact.x - frame.left - 0.4 * letter, frame.top - contact.y - 0.4 * letter, 0.8 * letter);
  }
  return svg + "</svg>";
}

std::string error_svg(const RunReport& run) {
  if (run.trail.size() < 2 || run.simulated_s <= 0.0) {
    return "";
  }
  constexpr double kWidth = 560.0;
  constexpr double kHeight = 150.0;
  constexpr double kLeft = 44.0;
  constexpr double kBottom = 22.0;
  constexpr double kTop = 8.0;
  constexpr double kMinDecade = -3.0;  // 1 mm
  constexpr double kMaxDecade = 1.0;   // 10 m
  const double end = std::max(1.0, run.trail.back().time);
  const auto x_of = [&](double time) { return kLeft + (kWidth - kLeft - 8.0) * time / end; };
  const auto y_of = [&](double metres) {
    const double decade = std::clamp(std::log10(std::max(metres, 1e-6)), kMinDecade, kMaxDecade);
    return kTop + (kHeight - kTop - kBottom) * (kMaxDecade - decade) / (kMaxDecade - kMinDecade);
  };
  std::string svg = fmt::format("<svg class=\"error\" viewBox=\"0 0 {} {}\">", kWidth, kHeight);
  for (const auto& [metres, label] :
       {std::pair{0.001, "1 mm"}, {0.01, "1 cm"}, {0.1, "10 cm"}, {1.0, "1 m"}, {10.0, "10 m"}}) {
    svg += fmt::format(
        "<line class=\"grid\" x1=\"{0:.1f}\" x2=\"{1:.1f}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/><text class=\"axis\" "
        "text-anchor=\"end\" x=\"{3:.1f}\" y=\"{4:.1f}\">{5}</text>",
        kLeft, kWidth - 8.0, y_of(metres), kLeft - 5.0, y_of(metres) + 3.5, label);
  }
  svg += fmt::format("<line class=\"bound\" x1=\"{0:.1f}\" x2=\"{1:.1f}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/>", kLeft,
                     kWidth - 8.0, y_of(0.5));
  svg += fmt::format("<text class=\"axis\" text-anchor=\"end\" x=\"{:.1f}\" y=\"{:.1f}\">error of the position</text>",
                     kWidth - 10.0, kTop + 10.0);
  const double step = end > 3600.0 ? 3600.0 : (end > 600.0 ? 300.0 : (end > 200.0 ? 60.0 : 20.0));
  for (double time = 0.0; time <= end; time += step) {
    svg += fmt::format("<text class=\"axis\" text-anchor=\"middle\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", x_of(time),
                       kHeight - 6.0,
                       end > 3600.0 ? fmt::format("{:.0f} h", time / 3600.0) : fmt::format("{:.0f} s", time));
  }
  std::string tracking;
  std::string guessing;
  const std::vector<TrailPoint> trail = thinned(run.trail);
  for (std::size_t i = 1; i < trail.size(); ++i) {
    const TrailPoint& a = trail[i - 1];
    const TrailPoint& b = trail[i];
    (b.state == pose_t::STATE_TRACKING ? tracking : guessing) +=
        fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", x_of(a.time), y_of(distance(a.truth, a.believed)), x_of(b.time),
                    y_of(distance(b.truth, b.believed)));
  }
  return svg + fmt::format("<path class=\"guessing\" d=\"{}\"/><path class=\"tracking\" d=\"{}\"/></svg>", guessing,
                           tracking);
}

}  // namespace luminav
