#include "services/common/building/map_file.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "services/common/building/map_picture.hpp"
#include "services/common/configuration/configuration_error.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/common/geometry/angle.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {
namespace {

namespace fs = std::filesystem;

void require_file(const fs::path& file) {
  std::error_code failure;
  if (!fs::is_regular_file(file, failure)) {
    throw ConfigurationError(fmt::format("{}: cannot be read", file.string()));
  }
}

void require_range(const fs::path& file, const char* key, double value, double min, double max) {
  if (!(value >= min && value <= max)) {  // also for what is no number
    throw ConfigurationError(
        fmt::format("{}: {} = {}, must be between {} and {}", file.string(), key, value, min, max));
  }
}

enum class MapMode { kTrinary, kScale, kRaw };

/// What the description says beside the picture.
struct MapDescription {
  fs::path picture;
  double resolution = 0.0;           // [m]
  Pose2 world_from_picture;          // of its lower left corner
  double free_threshold = 0.196;     // occupancy, 0..1
  double occupied_threshold = 0.65;  // likewise
  bool negate = false;
  MapMode mode = MapMode::kTrinary;
};

YAML::Node load(const fs::path& file) {
  require_file(file);  // a folder has no lines, and a pipe none yet
  try {
    return YAML::LoadFile(file.string());
  } catch (const YAML::BadFile&) {
    throw ConfigurationError(fmt::format("{}: cannot be read", file.string()));
  } catch (const YAML::Exception& error) {
    throw ConfigurationError(fmt::format("{}:{}: {}", file.string(), error.mark.line + 1, error.msg));
  }
}

MapMode mode_of(const fs::path& file, const std::string& word) {
  if (word == "trinary" || word == "scale" || word == "raw") {
    return word == "raw" ? MapMode::kRaw : word == "scale" ? MapMode::kScale : MapMode::kTrinary;
  }
  throw ConfigurationError(fmt::format("{}: mode = {}, must be trinary, scale or raw", file.string(), word));
}

/// 0 and 1 as much as false and true: both are in use.
bool read_flag(const YAML::Node& node) {
  bool flag = false;
  return YAML::convert<bool>::decode(node, flag) ? flag : node.as<int>() != 0;
}

MapDescription describe(const fs::path& file, const YAML::Node& yaml) {
  MapDescription map;
  const fs::path picture = yaml["image"].as<std::string>();
  map.picture = picture.is_absolute() ? picture : file.parent_path() / picture;
  map.resolution = yaml["resolution"].as<double>();
  const auto origin = yaml["origin"].as<std::vector<double>>();
  if (origin.size() != 2 && origin.size() != 3) {
    throw ConfigurationError(fmt::format("{}: origin must be [x, y, yaw]", file.string()));
  }
  map.world_from_picture = {origin[0], origin[1], origin.size() > 2 ? origin[2] : 0.0};
  map.free_threshold = yaml["free_thresh"] ? yaml["free_thresh"].as<double>() : map.free_threshold;
  map.occupied_threshold = yaml["occupied_thresh"] ? yaml["occupied_thresh"].as<double>() : map.occupied_threshold;
  map.negate = yaml["negate"] && read_flag(yaml["negate"]);
  map.mode = yaml["mode"] ? mode_of(file, yaml["mode"].as<std::string>()) : map.mode;
  return map;
}

MapDescription read_description(const fs::path& file) {
  const YAML::Node yaml = load(file);
  if (!yaml.IsMap() || !yaml["image"] || !yaml["resolution"] || !yaml["origin"]) {
    throw ConfigurationError(fmt::format("{}: must have image, resolution and origin", file.string()));
  }
  MapDescription map;
  try {
    map = describe(file, yaml);
  } catch (const YAML::Exception& error) {
    throw ConfigurationError(fmt::format("{}:{}: {}", file.string(), error.mark.line + 1, error.msg));
  }
  constexpr double kFarthest = 1e5;  // [m] as poses
  require_range(file, "resolution", map.resolution, 0.001, 10.0);
  require_range(file, "origin", map.world_from_picture.x, -kFarthest, kFarthest);
  require_range(file, "origin", map.world_from_picture.y, -kFarthest, kFarthest);
  require_range(file, "yaw of origin", map.world_from_picture.theta, -7.0, 7.0);  // a full turn either way
  require_range(file, "free_thresh", map.free_threshold, 0.0, 1.0);
  require_range(file, "occupied_thresh", map.occupied_threshold, map.free_threshold, 1.0);
  return map;
}

/// As map_server reads it. We know three states only, so `scale` is `trinary`; in `raw` a byte is a percentage, above
/// 100 unknown. What is transparent is unknown.
Prior prior_of(const MapPixel& pixel, const MapDescription& map) {
  if (pixel.opacity < 128) {
    return Prior::kUnknown;
  }
  const double value = map.negate ? 255.0 - pixel.grey : pixel.grey;
  if (map.mode == MapMode::kRaw && value > 100.0) {
    return Prior::kUnknown;
  }
  const double occupancy = map.mode == MapMode::kRaw ? value / 100.0 : 1.0 - value / 255.0;
  return occupancy > map.occupied_threshold ? Prior::kOccupied
         : occupancy < map.free_threshold   ? Prior::kFree
                                            : Prior::kUnknown;
}

PriorMap read_upright(const MapDescription& description) {
  MapPicture picture(description.picture);
  PriorMap map;
  map.geometry.resolution = description.resolution;
  map.geometry.columns = picture.width();
  map.geometry.rows = picture.height();
  map.cells.resize(map.geometry.size());
  for (int row = picture.height() - 1; row >= 0; --row) {
    int column = 0;
    for (const MapPixel& pixel : picture.next_row()) {
      map.cells[map.geometry.index({column++, row})] = prior_of(pixel, description);
    }
  }
  return map;
}

/// A grid along the axes of the world around a turned one. A cell is a wall where any of four points in it is one, so
/// that no thin wall gets holes, and free only where all of them are.
PriorMap turned(const PriorMap& map, const Pose2& world_from_map) {
  const double width = map.geometry.columns * map.geometry.resolution;
  const double height = map.geometry.rows * map.geometry.resolution;
  Eigen::AlignedBox2d box;
  for (const auto& [u, v] : {std::pair(0.0, 0.0), {width, 0.0}, {0.0, height}, {width, height}}) {
    box.extend(world_from_map * Eigen::Vector2d(u, v));
  }
  PriorMap result;
  result.geometry.resolution = map.geometry.resolution;
  result.geometry.origin = box.min();
  result.geometry.columns = static_cast<int>(std::ceil(box.sizes().x() / map.geometry.resolution - 1e-6));
  result.geometry.rows = static_cast<int>(std::ceil(box.sizes().y() / map.geometry.resolution - 1e-6));
  result.cells.assign(result.geometry.size(), Prior::kUnknown);
  const Pose2 map_from_world = world_from_map.inverse();
  const double quarter = 0.25 * map.geometry.resolution;
  for (int row = 0; row < result.geometry.rows; ++row) {
    for (int column = 0; column < result.geometry.columns; ++column) {
      const Eigen::Vector2d centre = result.geometry.centre_of({column, row});
      int free = 0;
      int occupied = 0;
      for (const auto& [u, v] : {std::pair(-1, -1), {1, -1}, {-1, 1}, {1, 1}}) {
        const Prior prior = map.at(map_from_world * (centre + quarter * Eigen::Vector2d(u, v)));
        free += prior == Prior::kFree ? 1 : 0;
        occupied += prior == Prior::kOccupied ? 1 : 0;
      }
      result.cells[result.geometry.index({column, row})] = occupied > 0 ? Prior::kOccupied
                                                           : free == 4  ? Prior::kFree
                                                                        : Prior::kUnknown;
    }
  }
  return result;
}

}  // namespace

PriorMap read_map(const fs::path& yaml_file) {
  const MapDescription description = read_description(yaml_file);
  PriorMap map = read_upright(description);
  if (wrap_angle(description.world_from_picture.theta) != 0.0) {
    return turned(map, description.world_from_picture);
  }
  map.geometry.origin = description.world_from_picture.position();
  return map;
}

void write_map(const fs::path& yaml_file, const PriorMap& map) {
  if (is_written_in_place(yaml_file)) {
    throw std::runtime_error(fmt::format("{}: a map is two files, NAME.yaml and NAME.pgm", yaml_file.string()));
  }
  const fs::path image_file = fs::path(yaml_file).replace_extension(".pgm");
  if (image_file == yaml_file) {
    throw std::runtime_error(
        fmt::format("{}: must be the map's description, NAME.yaml; NAME.pgm is drawn beside it", yaml_file.string()));
  }
  std::string image = fmt::format("P5\n{} {}\n255\n", map.geometry.columns, map.geometry.rows);
  for (int row = map.geometry.rows - 1; row >= 0; --row) {
    for (int column = 0; column < map.geometry.columns; ++column) {
      const Prior cell = map.cells[map.geometry.index({column, row})];
      image += static_cast<char>(cell == Prior::kFree ? 254 : cell == Prior::kUnknown ? 205 : 0);
    }
  }
  write_whole_file(image_file, image);
  write_whole_file(
      yaml_file,
      fmt::format(
          "image: {}\nresolution: {}\norigin: [{}, {}, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
          image_file.filename().string(), map.geometry.resolution, map.geometry.origin.x(), map.geometry.origin.y()));
}

}  // namespace luminav
