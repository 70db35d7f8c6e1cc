#include "services/detector/detector_config.hpp"

#include <algorithm>

#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

constexpr Range kGrey{0.0, 255.0};
constexpr Range kPixelError{0.001, 10.0};

PaperParams read_paper(const TomlTable& table) {
  PaperParams p;
  p.high_threshold = table.number("high_threshold", p.high_threshold, kGrey);
  p.high_above_median = table.number("high_above_median", p.high_above_median, {-255.0, 255.0});
  p.low_threshold = table.number("low_threshold", p.low_threshold, kGrey);
  p.low_below_median = table.number("low_below_median", p.low_below_median, {-255.0, 255.0});
  p.opening_size = table.count("opening_size", p.opening_size, {1, 31});
  p.opening_iterations = table.count("opening_iterations", p.opening_iterations, {0, 20});
  p.canny_low = table.number("canny_low", p.canny_low, {0.0, 1000.0});
  p.canny_high = table.number("canny_high", p.canny_high, {0.0, 1000.0});
  p.direct_contours = table.boolean("direct_contours", p.direct_contours);
  p.accept_cut = table.boolean("accept_cut", p.accept_cut);
  p.area_tolerance = table.number("area_tolerance", p.area_tolerance, kFraction);
  p.length_tolerance = table.number("length_tolerance", p.length_tolerance, kFraction);
  p.width_tolerance = table.number("width_tolerance", p.width_tolerance, kFraction);
  p.bloom = table.number("bloom", p.bloom, {0.0, 1.0});
  p.minimum_fill = table.number("minimum_fill", p.minimum_fill, kFraction);
  p.half_lit_share = table.number("half_lit_share", p.half_lit_share, {0.5, 1.0});
  p.position_sigma = table.number("position_sigma", p.position_sigma, {1e-5, 1.0});
  p.heading_sigma = table.number("heading_sigma", p.heading_sigma, {1e-5, 1.0});
  table.reject_unknown();
  return p;
}

ModernDetectorParams read_modern(const TomlTable& table) {
  ModernDetectorParams p;
  p.lit_contrast = table.number("lit_contrast", p.lit_contrast, kGrey);
  p.unlit_contrast = table.number("unlit_contrast", p.unlit_contrast, kGrey);
  p.lit_edge = table.number("lit_edge", p.lit_edge, kGrey);
  p.unlit_edge = table.number("unlit_edge", p.unlit_edge, kGrey);
  p.size_tolerance = table.number("size_tolerance", p.size_tolerance, {0.0, 0.5});
  p.max_bloom = table.number("max_bloom", p.max_bloom, {1e-4, 1.0});
  p.min_visible = table.number("min_visible", p.min_visible, {0.05, 1.0});
  p.min_side_support = table.number("min_side_support", p.min_side_support, kFraction);
  p.min_end_support = table.number("min_end_support", p.min_end_support, kFraction);
  p.edge_sigma_px = table.number("edge_sigma_px", p.edge_sigma_px, kPixelError);
  p.outline_sigma_px = table.number("outline_sigma_px", p.outline_sigma_px, kPixelError);
  table.reject_unknown();
  return p;
}

}  // namespace

DetectorConfig read_detector_config(const std::filesystem::path& robot_file,
                                    const std::filesystem::path& building_file) {
  return read_detector_config(robot_file, read_building(building_file), building_file);
}

DetectorConfig read_detector_config(const std::filesystem::path& robot_file, const Building& building,
                                    const std::filesystem::path& building_file) {
  const TomlTable root = TomlTable::load(robot_file);
  const RobotDescription robot = read_robot(root);
  DetectorConfig config;
  config.robot = robot.name;
  config.camera = robot.camera;
  config.catalogue = catalogue_of(building);

  const TomlTable table = root.table("detector");
  const bool paper = table.choice("mode", robot.mode, {"paper", "modern"}) == "paper";
  config.params.mode = paper ? DetectorMode::kPaper : DetectorMode::kModern;
  config.params.paper = read_paper(table.table("paper"));
  config.params.modern = read_modern(table.table("modern"));
  table.reject_unknown();
  double lowest = config.catalogue.ceiling_height;
  for (const CeilingKind& kind : config.catalogue.fixtures) {
    lowest = std::min(lowest, kind.height);
  }
  if (lowest < config.camera.mounting.z + 0.2) {
    throw ConfigurationError(building_file.string() + ": ceiling_height or a fixture's height " +
                             std::to_string(lowest) + " m: must be at least 0.2 m above the camera, which " +
                             robot_file.string() + " puts at " + std::to_string(config.camera.mounting.z) + " m");
  }
  return config;
}

}  // namespace luminav
