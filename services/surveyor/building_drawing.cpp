#include "services/surveyor/building_drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "services/common/image/picture_file.hpp"

namespace luminav {
namespace {

constexpr double kMargin = 1.0;  // [m] round the building
constexpr double kLegend = 1.4;  // [m] below it, for the scale bar

/// What is drawn, in metres, x to the right and y up.
struct Sheet {
  Eigen::Vector2d low;
  Eigen::Vector2d high;
  [[nodiscard]] double width() const { return high.x() - low.x(); }
  [[nodiscard]] double height() const { return high.y() - low.y(); }
};

Sheet sheet_of(const Building& building, const PriorMap* map) {
  Eigen::Vector2d low(1e9, 1e9);
  Eigen::Vector2d high(-1e9, -1e9);
  const auto include = [&](const Eigen::Vector2d& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  };
  if (map != nullptr) {
    const GridGeometry& geometry = map->geometry;
    include(geometry.origin);
    include(geometry.origin + geometry.resolution * Eigen::Vector2d(geometry.columns, geometry.rows));
  }
  for (const Fixture& fixture : building.fixtures) {
    include(fixture.world_from_fixture.position());
  }
  if (low.x() > high.x()) {
    low = high = Eigen::Vector2d::Zero();
  }
  return {low - Eigen::Vector2d(kMargin, kMargin + kLegend), high + Eigen::Vector2d(kMargin, kMargin)};
}

/// A round length that fills about a fifth of the sheet [m].
double scale_bar(const Sheet& sheet) {
  const double power = std::pow(10.0, std::floor(std::log10(0.2 * sheet.width())));
  for (const double step : {5.0, 2.0}) {
    if (step * power <= 0.25 * sheet.width()) {
      return step * power;
    }
  }
  return power;
}

bool is_marked(const std::vector<int>& marked, int id) {
  return std::find(marked.begin(), marked.end(), id) != marked.end();
}

std::vector<Eigen::Vector2d> outline(const Pose2& world_from_box, double length, double width) {
  std::vector<Eigen::Vector2d> corners;
  for (const auto& [a, b] : {std::pair{0.5, 0.5}, {-0.5, 0.5}, {-0.5, -0.5}, {0.5, -0.5}}) {
    corners.push_back(world_from_box * Eigen::Vector2d(a * length, b * width));
  }
  return corners;
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    result += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
  }
  return result;
}

/// Walls as one path of horizontal runs: an image embedded would not stay sharp.
std::string wall_path(const PriorMap& map, const Sheet& sheet) {
  std::string path;
  const GridGeometry& geometry = map.geometry;
  for (int row = 0; row < geometry.rows; ++row) {
    for (int column = 0; column < geometry.columns;) {
      if (map.cells[geometry.index({column, row})] != Prior::kOccupied) {
        ++column;
        continue;
      }
      const int first = column;
      while (column < geometry.columns && map.cells[geometry.index({column, row})] == Prior::kOccupied) {
        ++column;
      }
      const double side = geometry.resolution;
      path += fmt::format("M{:.2f} {:.2f}h{:.2f}v{:.2f}h{:.2f}z", geometry.origin.x() + first * side - sheet.low.x(),
                          sheet.high.y() - geometry.origin.y() - (row + 1) * side, (column - first) * side, side,
                          -(column - first) * side);
    }
  }
  return path;
}

}  // namespace

std::string draw_building_svg(const Building& building, const PriorMap* map, const std::vector<int>& marked) {
  const Sheet sheet = sheet_of(building, map);
  const auto x = [&](const Eigen::Vector2d& point) { return point.x() - sheet.low.x(); };
  const auto y = [&](const Eigen::Vector2d& point) { return sheet.high.y() - point.y(); };
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.2f} {1:.2f}\" width=\"{2:.0f}\" "
      "font-family=\"sans-serif\">\n"
      "<style>text {{ paint-order: stroke; stroke: #fff; stroke-width: 0.12 }}</style>\n<rect width=\"{0:.2f}\" "
      "height=\"{1:.2f}\" fill=\"#fff\"/>\n",
      sheet.width(), sheet.height(), std::min(1600.0, 40.0 * sheet.width()));
  const auto polygon = [&](const std::vector<Eigen::Vector2d>& corners, const char* style) {
    svg += "<polygon points=\"";
    for (const Eigen::Vector2d& corner : corners) {
      svg += fmt::format("{:.3f},{:.3f} ", x(corner), y(corner));
    }
    svg += fmt::format("\" {}/>\n", style);
  };
  if (map != nullptr) {
    svg += fmt::format("<path fill=\"#333\" d=\"{}\"/>\n", wall_path(*map, sheet));
  }
  for (const Window& window : building.windows) {
    polygon(outline(window.world_from_window, 0.12, window.width), "fill=\"#6ac\"");
  }
  for (const CeilingElement& element : building.elements) {
    polygon(outline(element.world_from_element, element.length, element.width),
            "fill=\"#bbb\" stroke=\"#777\" stroke-width=\"0.03\"");
  }
  for (const Fixture& fixture : building.fixtures) {
    const Eigen::Vector2d centre = fixture.world_from_fixture.position();
    const bool red = is_marked(marked, fixture.id);
    const std::string style =
        fmt::format("fill=\"{}\" stroke=\"{}\" stroke-width=\"0.04\"", red ? "#f55" : "#fc3", red ? "#900" : "#a70");
    if (fixture.shape == FixtureShape::kRound) {
      svg += fmt::format("<circle cx=\"{:.3f}\" cy=\"{:.3f}\" r=\"{:.3f}\" {}/>\n", x(centre), y(centre),
                         0.5 * fixture.length, style);
    } else {
      polygon(outline(fixture.world_from_fixture, fixture.length, fixture.width), style.c_str());
    }
    svg += fmt::format("<text x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"0.32\" fill=\"#850\">{}</text>\n", x(centre) + 0.2,
                       y(centre) - 0.25, fixture.id);
  }
  for (const Zone& zone : building.zones) {
    std::string corners;
    for (const Eigen::Vector2d& corner : zone.polygon) {
      corners += fmt::format("{:.3f},{:.3f} ", x(corner), y(corner));
    }
    const char* colour = zone.kind == ZoneKind::kKeepOut ? "#c22" : "#c80";
    svg += fmt::format(
        "<polygon points=\"{0}\" fill=\"{1}\" fill-opacity=\"0.15\" stroke=\"{1}\" stroke-width=\"0.06\"/>"
        "<text x=\"{2:.2f}\" y=\"{3:.2f}\" font-size=\"0.4\" fill=\"{1}\">{4}</text>\n",
        corners, colour, x(zone.polygon.front()) + 0.1, y(zone.polygon.front()) - 0.1, escaped(zone.name));
  }
  for (const Place& place : building.places) {
    svg += fmt::format(
        "<circle cx=\"{0:.2f}\" cy=\"{1:.2f}\" r=\"0.12\" fill=\"#16a\"/><text x=\"{2:.2f}\" y=\"{3:.2f}\" "
        "font-size=\"0.5\" fill=\"#16a\">{4}</text>\n",
        x(place.pose.position()), y(place.pose.position()), x(place.pose.position()) + 0.2,
        y(place.pose.position()) + 0.18, escaped(place.name));
  }
  const double bar = scale_bar(sheet);
  svg += fmt::format(
      "<path d=\"M{0} {1:.2f}h{2:.2f}\" stroke=\"#333\" stroke-width=\"0.1\"/><text x=\"{0}\" y=\"{3:.2f}\" "
      "font-size=\"0.6\" fill=\"#333\">{2:g} m - {4}: {5} fixtures</text>\n</svg>\n",
      kMargin, sheet.height() - 0.4, bar, sheet.height() - 0.6, escaped(building.name), building.fixtures.size());
  return svg;
}

void draw_building_png(const std::filesystem::path& file, const Building& building, const PriorMap* map,
                       const std::vector<int>& marked) {
  const Sheet sheet = sheet_of(building, map);
  const double scale = std::min(40.0, 1600.0 / sheet.width());  // [px per m]
  cv::Mat image(static_cast<int>(sheet.height() * scale), static_cast<int>(sheet.width() * scale), CV_8UC3,
                cv::Scalar::all(255));
  const auto at = [&](const Eigen::Vector2d& point) {
    return cv::Point(static_cast<int>(std::lround((point.x() - sheet.low.x()) * scale)),
                     static_cast<int>(std::lround((sheet.high.y() - point.y()) * scale)));
  };
  const auto polygon = [&](const Pose2& pose, double length, double width, const cv::Scalar& colour) {
    std::vector<cv::Point> corners;
    for (const Eigen::Vector2d& corner : outline(pose, length, width)) {
      corners.push_back(at(corner));
    }
    cv::fillConvexPoly(image, corners, colour, cv::LINE_AA);
    cv::polylines(image, corners, true, 0.6 * colour, 1, cv::LINE_AA);
  };
  const auto text = [&](cv::Point point, const std::string& words, double size, const cv::Scalar& colour) {
    const cv::Size room = cv::getTextSize(words, cv::FONT_HERSHEY_SIMPLEX, size, 1, nullptr);
    if (point.x + room.width > image.cols) {
      point.x = std::max(0, point.x - room.width - 14);  // on the other side of what it names
    }
    // a white rim, or what is drawn below makes it unreadable
    cv::putText(image, words, point, cv::FONT_HERSHEY_SIMPLEX, size, cv::Scalar::all(255), 4, cv::LINE_AA);
    cv::putText(image, words, point, cv::FONT_HERSHEY_SIMPLEX, size, colour, 1, cv::LINE_AA);
  };
  if (map != nullptr) {
    for (int row = 0; row < image.rows; ++row) {
      for (int column = 0; column < image.cols; ++column) {
        const Eigen::Vector2d point(sheet.low.x() + (column + 0.5) / scale, sheet.high.y() - (row + 0.5) / scale);
        const Prior prior = map->at(point);
        if (prior == Prior::kOccupied) {
          image.at<cv::Vec3b>(row, column) = {50, 50, 50};
        } else if (prior == Prior::kUnknown && map->geometry.contains(map->geometry.cell_at(point))) {
          image.at<cv::Vec3b>(row, column) = {225, 225, 225};
        }
      }
    }
  }
  for (const Window& window : building.windows) {
    polygon(window.world_from_window, 0.12, window.width, {204, 170, 100});
  }
  for (const CeilingElement& element : building.elements) {
    polygon(element.world_from_element, element.length, element.width, {190, 190, 190});
  }
  for (const Fixture& fixture : building.fixtures) {
    const cv::Scalar colour = is_marked(marked, fixture.id) ? cv::Scalar(80, 80, 255) : cv::Scalar(50, 200, 255);
    if (fixture.shape == FixtureShape::kRound) {
      cv::circle(image, at(fixture.world_from_fixture.position()), static_cast<int>(0.5 * fixture.length * scale) + 1,
                 colour, cv::FILLED, cv::LINE_AA);
    } else {
      polygon(fixture.world_from_fixture, fixture.length, fixture.width, colour);
    }
    if (scale > 15.0) {
      text(at(fixture.world_from_fixture.position()) + cv::Point(4, -6), std::to_string(fixture.id), 0.35,
           {0, 90, 150});
    }
  }
  for (const Zone& zone : building.zones) {
    std::vector<cv::Point> corners;
    for (const Eigen::Vector2d& corner : zone.polygon) {
      corners.push_back(at(corner));
    }
    const cv::Scalar colour = zone.kind == ZoneKind::kKeepOut ? cv::Scalar(40, 40, 200) : cv::Scalar(20, 140, 210);
    cv::polylines(image, corners, true, colour, 2, cv::LINE_AA);
    text(corners.front() + cv::Point(5, -5), zone.name, scale > 15.0 ? 0.5 : 0.35, colour);
  }
  for (const Place& place : building.places) {
    cv::circle(image, at(place.pose.position()), 4, {170, 100, 20}, cv::FILLED, cv::LINE_AA);
    text(at(place.pose.position()) + cv::Point(7, 5), place.name, scale > 15.0 ? 0.5 : 0.35, {170, 100, 20});
  }
  const double bar = scale_bar(sheet);
  const cv::Point left = at({sheet.low.x() + kMargin, sheet.low.y() + 0.4});
  cv::line(image, left, left + cv::Point(static_cast<int>(bar * scale), 0), {50, 50, 50}, 2);
  text(left + cv::Point(0, -6), fmt::format("{:g} m - {}: {} fixtures", bar, building.name, building.fixtures.size()),
       0.5, {50, 50, 50});
  write_picture(file, image);
}

}  // namespace luminav
