#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>

#include "services/common/building/building.hpp"
#include "services/common/building/occupancy_grid.hpp"

namespace luminav {

/// A building into whose solid block rooms and doors are carved. Metres, from the block's lower left corner.
class Drawing {
 public:
  Drawing(const char* name, double width, double depth, double ceiling_height);

  /// Free space between two corners.
  void carve(double west, double south, double east, double north);
  /// Walls between two corners.
  void build(double west, double south, double east, double north);
  /// A fixture below the ceiling, or at `height` where that is another one's.
  void hang(FixtureShape shape, double x, double y, double length, double width, double theta_deg = 0.0,
            double height = 0.0);
  /// Equal fixtures in rows: `columns` of them `dx` apart from x on, `rows` `dy` apart from y on.
  struct Grid {
    double x, y, dx, dy;
    int columns, rows;
  };
  void hang_grid(FixtureShape shape, const Grid& grid, double length, double width, double theta_deg = 0.0,
                 double height = 0.0);
  void name_place(const char* name, double x, double y);

  /// Building and map.
  void write(const std::filesystem::path& home) const;

 private:
  void fill(double west, double south, double east, double north, Prior prior);

  Building building_;
  PriorMap map_;
};

/// A scenario with an unknown start, a box that the map does not know, somebody who walks, and goals at places.
/// `duration` [s].
std::string drawn_scenario(const std::filesystem::path& building_file, double duration,
                           std::initializer_list<const char*> places);

}  // namespace luminav
