#include "tests/evaluation/survey_score/exploring_run.hpp"

#include <fmt/format.h>
#include <time.h>

#include <filesystem>
#include <luminav/navigation_status_t.hpp>
#include <luminav/sim_truth_t.hpp>
#include <luminav/survey_command_t.hpp>
#include <luminav/survey_status_t.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <optional>

#include "services/common/process/channels.hpp"
#include "services/common/process/subscriber.hpp"
#include "tests/evaluation/judge/map_canvas.hpp"
#include "tests/evaluation/judge/map_score.hpp"
#include "tests/evaluation/survey_score/written_survey.hpp"

namespace luminav {
namespace {

constexpr double kSpacing = 0.05;      // [m] between the poses of the path
constexpr double kRobotRadius = 0.25;  // [m] of the disc that reaches the floor, as what check-building takes for room
constexpr double kDrivenOver = 0.2;    // [m] beside the path the floor is free: the robot is as wide

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Notes what happens, on LCM.
class Witness {
 public:
  explicit Witness(lcm::LCM& lcm) : subscriber_(lcm) {
    subscriber_.on(channels::kSimTruth, &Witness::on_truth, this);
    subscriber_.on(channels::kSurveyStatus, &Witness::on_status, this);
    subscriber_.on(channels::kNavigationStatus, &Witness::on_navigation, this);
  }

  struct Point {
    std::int64_t utime = 0;  // [us]
    Pose2 pose;
  };
  [[nodiscard]] const std::vector<Point>& path() const { return path_; }
  [[nodiscard]] const sim_truth_t& truth() const { return truth_; }
  [[nodiscard]] const survey_status_t& status() const { return status_; }
  /// It has explored, and does no more.
  [[nodiscard]] bool has_ended() const { return was_exploring_ && status_.is_exploring == 0; }

  void print(double elapsed) const {
    fmt::print(
        "{:6.0f} true ({:5.1f} {:5.1f} {:4.0f}) clear {:4.2f} c {} | map ({:5.1f} {:5.1f}) {} | nav {} {:.1f} m {}\n",
        elapsed, truth_.x, truth_.y, degrees(truth_.theta), truth_.clearance, truth_.contacts, status_.x, status_.y,
        status_.exploring, int{navigation_.state}, navigation_.distance_left, navigation_.cause);
  }

 private:
  void on_truth(const sim_truth_t& truth) {
    truth_ = truth;
    const Pose2 pose{truth.x, truth.y, truth.theta};
    if (path_.empty() || distance(path_.back().pose, pose) >= kSpacing) {
      path_.push_back({truth.utime, pose});
    }
  }
  void on_status(const survey_status_t& status) {
    status_ = status;
    was_exploring_ = was_exploring_ || status.is_exploring != 0;
  }
  void on_navigation(const navigation_status_t& navigation) { navigation_ = navigation; }

  std::vector<Point> path_;
  sim_truth_t truth_{};
  survey_status_t status_{};
  bool was_exploring_ = false;
  navigation_status_t navigation_{};
  Subscriber subscriber_;
};

/// Marks the floor that was driven over.
std::vector<bool> driven_over(const GridGeometry& geometry, const std::vector<Pose2>& path) {
  std::vector<bool> marks(geometry.size(), false);
  const int reach = static_cast<int>(kDrivenOver / geometry.resolution);
  for (const Pose2& pose : path) {
    const Cell centre = geometry.cell_at(pose.position());
    for (int dr = -reach; dr <= reach; ++dr) {
      for (int dc = -reach; dc <= reach; ++dc) {
        const Cell cell{centre.column + dc, centre.row + dr};
        if (dc * dc + dr * dr <= reach * reach && geometry.contains(cell)) {
          marks[geometry.index(cell)] = true;
        }
      }
    }
  }
  return marks;
}

Eigen::Vector2d middle_of(const std::vector<ScoredFixture>& fixtures) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const ScoredFixture& scored : fixtures) {
    sum += scored.fixture.world_from_fixture.position() / static_cast<double>(fixtures.size());
  }
  return sum;
}

/// The map is laid on the floor by its fixtures, its scale taken out: how large it is, the score of the fixtures says.
double known_share(const WorldTruth& world, const std::vector<Pose2>& path, const WrittenFolder& written,
                   const SurveyScore& score) {
  const Pose2 survey_from_truth = score.truth_from_survey.inverse();
  const Eigen::Vector2d middle = middle_of(written.fixtures);
  const GridGeometry& geometry = world.walls.geometry;
  const std::vector<bool> reachable = reachable_cells(world.walls, world.start.position(), kRobotRadius);
  const std::vector<bool> driven = driven_over(geometry, path);
  double floor = 0.0;
  double known = 0.0;
  for (std::size_t i = 0; i < reachable.size(); ++i) {
    if (reachable[i]) {
      const Cell cell{static_cast<int>(i) % geometry.columns, static_cast<int>(i) / geometry.columns};
      floor += 1.0;
      const Eigen::Vector2d rigid = survey_from_truth * geometry.centre_of(cell);
      const bool is_known = written.map.at(middle + (1.0 + score.scale) * (rigid - middle)) == Prior::kFree;
      known += driven[i] || is_known ? 1.0 : 0.0;
    }
  }
  return known / std::max(1.0, floor);
}

void draw(const std::string& file, const WorldTruth& world, const std::vector<Pose2>& path,
          const std::optional<WrittenFolder>& written, const Pose2& truth_from_survey) {
  MapCanvas canvas(world.walls);
  for (const Fixture& fixture : world.building.fixtures) {
    canvas.rectangle(fixture.world_from_fixture, fixture.length, fixture.width, cv::Scalar(60, 190, 250));
  }
  if (written) {
    const GridGeometry& geometry = written->map.geometry;
    for (std::size_t i = 0; i < written->map.cells.size(); ++i) {
      const Cell cell{static_cast<int>(i) % geometry.columns, static_cast<int>(i) / geometry.columns};
      if (written->map.cells[i] != Prior::kUnknown) {
        canvas.dot(truth_from_survey * geometry.centre_of(cell), 1,
                   written->map.cells[i] == Prior::kFree ? cv::Scalar(120, 200, 120) : cv::Scalar(40, 40, 220));
      }
    }
    for (const ScoredFixture& scored : written->fixtures) {
      canvas.dot(truth_from_survey * scored.fixture.world_from_fixture.position(), 4, cv::Scalar(220, 90, 20));
    }
  }
  for (std::size_t i = 1; i < path.size(); ++i) {
    canvas.line(path[i - 1], path[i], cv::Scalar(150, 100, 150), 1);
  }
  canvas.write(file);
}

void judge(const WorldTruth& world, const Witness& witness, const ExploringOptions& options, ExploringResult& result) {
  std::vector<Pose2> path;
  for (const Witness::Point& point : witness.path()) {
    path.push_back(point.pose);
    result.driven += path.size() > 1 ? distance(path[path.size() - 2], path.back()) : 0.0;
  }
  result.home = distance(path.front(), {witness.truth().x, witness.truth().y, 0.0});
  result.fixtures = static_cast<int>(world.building.fixtures.size());
  std::optional<WrittenFolder> written;
  const std::filesystem::path folder = options.robot.survey_folder;
  if (std::filesystem::exists(folder / "building.toml")) {
    written = read_written_survey(folder / "building.toml", folder / "survey.json");
    Pose2 begin = path.front();
    for (const Witness::Point& point : witness.path()) {
      begin = point.utime <= written->begin_utime ? point.pose : begin;
    }
    result.score = score_survey(written->fixtures, world, path, begin * written->begin.inverse());
    const SurveyScore& score = result.score;
    result.found = static_cast<int>(written->fixtures.size()) - score.doubled - score.alike - score.invented;
    result.floor_share = known_share(world, path, *written, result.score);
  }
  if (!options.picture_file.empty()) {
    draw(options.picture_file, world, path, written, result.score.truth_from_survey);
  }
}

/// Somebody presses Finish: what the robot has seen counts.
void finish(WholeRobot& robot) {
  survey_command_t command{};
  command.utime = robot.utime();
  command.id = robot.utime();
  command.action = survey_command_t::ACTION_FINISH;
  robot.lcm().publish(channels::kSurveyCommand, &command);
  constexpr int kSteps = 1000;
  for (int step = 0; step < kSteps && !robot.has_surveyed(); ++step) {
    robot.step();
  }
}

}  // namespace

ExploringResult run_exploring(const Scenario& scenario, const ExploringOptions& options) {
  const double cpu_start = thread_seconds();
  WholeRobot robot(scenario, options.robot);
  const Witness witness(robot.lcm());
  ExploringResult result;
  const auto limit = static_cast<std::int64_t>(100.0 * scenario.duration);
  for (std::int64_t step = 0; step < limit && !witness.has_ended(); ++step) {
    robot.step();
    if (options.trace && step % 1000 == 999) {
      witness.print(0.01 * static_cast<double>(step));
    }
    result.simulated = 0.01 * static_cast<double>(step);
  }
  result.sentence = witness.status().exploring;
  result.is_finished = robot.has_surveyed();
  if (!result.is_finished) {
    finish(robot);
  }
  result.contacts = witness.truth().contacts;
  result.hard_contacts = witness.truth().hard_contacts;
  judge(robot.world(), witness, options, result);
  result.cpu = thread_seconds() - cpu_start;
  return result;
}

std::string to_text(const ExploringResult& result) {
  return fmt::format(
      "{} after {:.0f} s and {:.0f} m, {} contacts; {:.1f} % of the floor, {} of {} fixtures; {:.1f} m from home; "
      "\"{}\"\n  {}",
      result.is_finished ? "finished" : "NOT finished", result.simulated, result.driven, result.contacts,
      100.0 * result.floor_share, result.found, result.fixtures, result.home, result.sentence, to_text(result.score));
}

std::string to_json(const ExploringResult& result) {
  nlohmann::json figures = nlohmann::json::parse(to_json(result.score));
  figures["is_finished"] = result.is_finished;
  figures["sentence"] = result.sentence;
  figures["simulated_s"] = result.simulated;
  figures["distance"] = result.driven;
  figures["contacts"] = result.contacts;
  figures["hard_contacts"] = result.hard_contacts;
  figures["home_m"] = result.home;
  figures["floor_share"] = result.floor_share;
  figures["fixtures"] = result.fixtures;
  figures["found_of_all"] = result.found;
  figures["cpu_s"] = result.cpu;
  return figures.dump(1) + "\n";
}

}  // namespace luminav
