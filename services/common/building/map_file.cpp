#include "services/common/building/map_file.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <cctype>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "services/common/configuration/configuration_error.hpp"
#include "services/common/configuration/whole_file.hpp"

namespace luminav {
namespace {

namespace fs = std::filesystem;

/// What stands before a picture's pixels, which follow row by row from the top left.
struct PictureHeader {
  int width = 0;
  int height = 0;
  int maximum = 255;
};

/// Next number of a PGM header; comments run from # to the end of the line.
int read_header_number(std::istream& in, const fs::path& file) {
  while (true) {
    const int next = in.peek();
    if (next == '#') {
      std::string comment;
      std::getline(in, comment);
    } else if (std::isspace(next) != 0) {
      in.get();
    } else {
      break;
    }
  }
  int number = 0;
  if (!(in >> number) || number <= 0) {
    throw ConfigurationError(fmt::format("{}: not a binary PGM picture (P5)", file.string()));
  }
  return number;
}

PictureHeader read_pgm_header(std::istream& in, const fs::path& file) {
  char magic[2] = {};
  in.read(magic, 2);
  if (magic[0] != 'P' || magic[1] != '5') {
    throw ConfigurationError(fmt::format("{}: not a binary PGM picture (P5)", file.string()));
  }
  PictureHeader image;
  image.width = read_header_number(in, file);
  image.height = read_header_number(in, file);
  image.maximum = read_header_number(in, file);
  if (image.maximum > 255) {
    throw ConfigurationError(fmt::format("{}: 16-bit PGM, must be 8-bit", file.string()));
  }
  if (image.width > 20000 || image.height > 20000) {
    throw ConfigurationError(
        fmt::format("{}: {} x {} px, must be at most 20000 x 20000", file.string(), image.width, image.height));
  }
  in.get();
  return image;
}

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

}  // namespace

PriorMap read_map(const fs::path& yaml_file) {
  require_file(yaml_file);  // a folder has no lines, and a pipe none yet
  YAML::Node yaml;
  try {
    yaml = YAML::LoadFile(yaml_file.string());
  } catch (const YAML::BadFile&) {
    throw ConfigurationError(fmt::format("{}: cannot be read", yaml_file.string()));
  } catch (const YAML::Exception& error) {
    throw ConfigurationError(fmt::format("{}:{}: {}", yaml_file.string(), error.mark.line + 1, error.msg));
  }
  if (!yaml.IsMap() || !yaml["image"] || !yaml["resolution"] || !yaml["origin"]) {
    throw ConfigurationError(fmt::format("{}: must have image, resolution and origin", yaml_file.string()));
  }
  PriorMap map;
  double free_threshold = 0.196;
  double occupied_threshold = 0.65;
  bool negate = false;
  fs::path image_file;
  try {
    image_file = yaml["image"].as<std::string>();
    map.geometry.resolution = yaml["resolution"].as<double>();
    const auto origin = yaml["origin"].as<std::vector<double>>();
    if (origin.size() < 2 || (origin.size() > 2 && origin[2] != 0.0)) {
      throw ConfigurationError(
          fmt::format("{}: origin must be [x, y, 0]; turned maps are not read", yaml_file.string()));
    }
    map.geometry.origin = {origin[0], origin[1]};
    free_threshold = yaml["free_thresh"] ? yaml["free_thresh"].as<double>() : free_threshold;
    occupied_threshold = yaml["occupied_thresh"] ? yaml["occupied_thresh"].as<double>() : occupied_threshold;
    negate = yaml["negate"] && yaml["negate"].as<int>() != 0;
  } catch (const YAML::Exception& error) {
    throw ConfigurationError(fmt::format("{}:{}: {}", yaml_file.string(), error.mark.line + 1, error.msg));
  }
  constexpr double kFarthest = 1e5;  // [m] as poses
  require_range(yaml_file, "resolution", map.geometry.resolution, 0.001, 10.0);
  require_range(yaml_file, "origin", map.geometry.origin.x(), -kFarthest, kFarthest);
  require_range(yaml_file, "origin", map.geometry.origin.y(), -kFarthest, kFarthest);
  require_range(yaml_file, "free_thresh", free_threshold, 0.0, 1.0);
  require_range(yaml_file, "occupied_thresh", occupied_threshold, free_threshold, 1.0);
  const fs::path picture = image_file.is_absolute() ? image_file : yaml_file.parent_path() / image_file;
  require_file(picture);
  std::ifstream in(picture, std::ios::binary);
  if (!in) {
    throw ConfigurationError(fmt::format("{}: cannot be read", picture.string()));
  }
  const PictureHeader image = read_pgm_header(in, picture);
  map.geometry.columns = image.width;
  map.geometry.rows = image.height;
  map.cells.resize(map.geometry.size());
  const auto columns = static_cast<std::size_t>(image.width);
  std::vector<std::uint8_t> pixels(columns);  // a row at a time: the picture may be larger than all else in memory
  for (int row = image.height - 1; row >= 0; --row) {
    in.read(reinterpret_cast<char*>(pixels.data()), image.width);
    if (in.gcount() != image.width) {
      const std::size_t read = static_cast<std::size_t>(image.height - 1 - row) * columns;
      throw ConfigurationError(fmt::format("{}: cut off, {} of {} pixels", picture.string(),
                                           read + static_cast<std::size_t>(in.gcount()), map.geometry.size()));
    }
    for (int column = 0; column < image.width; ++column) {
      const double brightness = static_cast<double>(pixels[static_cast<std::size_t>(column)]) / image.maximum;
      const double occupancy = negate ? brightness : 1.0 - brightness;
      map.cells[map.geometry.index({column, row})] = occupancy > occupied_threshold ? Prior::kOccupied
                                                     : occupancy < free_threshold   ? Prior::kFree
                                                                                    : Prior::kUnknown;
    }
  }
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
