#include "tests/evaluation/survey_score/written_survey.hpp"

#include <array>
#include <nlohmann/json.hpp>

#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/whole_file.hpp"

namespace luminav {

WrittenFolder read_written_survey(const std::filesystem::path& building_file, const std::filesystem::path& json_file) {
  WrittenFolder written;
  written.building = read_building(building_file);
  written.map = read_map(written.building.map_file);
  const nlohmann::json report = nlohmann::json::parse(read_whole_file(json_file));
  const auto begin = report.at("begin").get<std::array<double, 3>>();
  written.begin = {begin[0], begin[1], begin[2]};
  written.begin_utime = report.at("begin_utime").get<std::int64_t>();
  for (std::size_t f = 0; f < written.building.fixtures.size(); ++f) {
    ScoredFixture scored{written.building.fixtures[f], {}};
    const auto covariance = report.at("fixtures").at(f).at("covariance").get<std::vector<double>>();
    scored.covariance = Eigen::Map<const Eigen::Matrix3d>(covariance.data());
    written.fixtures.push_back(scored);
  }
  return written;
}

}  // namespace luminav
