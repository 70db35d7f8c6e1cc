#include "services/operator/goal_target.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>

#include "services/common/configuration/shipped_file.hpp"
#include "services/common/configuration/toml_table.hpp"
#include "services/common/geometry/angle.hpp"
#include "services/common/process/option_values.hpp"

namespace luminav {

std::optional<std::vector<double>> read_numbers(const std::vector<std::string>& words) {
  std::vector<double> numbers;
  for (const std::string& word : words) {
    const std::optional<double> number = read_number(word);
    if (!number) {
      return std::nullopt;
    }
    numbers.push_back(*number);
  }
  return numbers;
}

std::optional<std::vector<double>> read_point(std::vector<std::string> words) {
  constexpr std::string_view kDegrees = "deg";
  const bool has_degrees = words.size() == 3 && words.back().ends_with(kDegrees);
  if (has_degrees) {
    words.back().resize(words.back().size() - kDegrees.size());
  }
  std::optional<std::vector<double>> numbers = read_numbers(words);
  if (numbers && has_degrees) {
    numbers->back() = radians(numbers->back());
  }
  return numbers;
}

goal_t make_goal(const std::vector<std::string>& words, const Building& building) {
  goal_pose_t stop{};
  if (const auto numbers = read_point(words)) {
    if (numbers->size() != 2 && numbers->size() != 3) {
      throw ConfigurationError("a point has two numbers, X and Y, and perhaps a heading, in radians or as 90deg");
    }
    stop.x = (*numbers)[0];
    stop.y = (*numbers)[1];
    stop.has_theta = numbers->size() == 3;
    stop.theta = stop.has_theta ? wrap_angle((*numbers)[2]) : 0.0;
  } else {
    const std::string name = fmt::format("{}", fmt::join(words, " "));
    const auto place =
        std::find_if(building.places.begin(), building.places.end(), [&](const Place& p) { return p.name == name; });
    if (place == building.places.end()) {
      std::vector<std::string> names;
      for (const Place& known : building.places) {
        names.push_back(known.name);
      }
      throw ConfigurationError(
          fmt::format("no place \"{}\" in {}; known: {}", name, building.name, fmt::join(names, ", ")));
    }
    stop.place = place->name;
    stop.x = place->pose.x;
    stop.y = place->pose.y;
    stop.has_theta = place->has_theta;
    stop.theta = place->pose.theta;
  }
  goal_t goal{};
  goal.action = goal_t::ACTION_GO;
  goal.policy = goal_t::POLICY_STOP;
  goal.count = 1;
  goal.poses.push_back(stop);
  return goal;
}

std::string default_building_file() {
  const auto launched = [](const char* variable) {
    const char* value = std::getenv(variable);
    return std::string(value == nullptr ? "" : value);
  };
  if (const std::string building = launched("LUMINAV_BUILDING"); !building.empty()) {
    return building;
  }
  if (const std::string scenario = launched("LUMINAV_SCENARIO"); !scenario.empty()) {
    return TomlTable::load(scenario).path("building");
  }
  return shipped_file("buildings/laboratory/building.toml");
}

}  // namespace luminav
