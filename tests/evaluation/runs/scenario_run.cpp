#include "tests/evaluation/runs/scenario_run.hpp"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <luminav/control_status_t.hpp>
#include <memory>
#include <optional>
#include <set>

#include "services/common/process/channels.hpp"
#include "tests/evaluation/judge/drive_judge.hpp"
#include "tests/evaluation/judge/job_judge.hpp"
#include "tests/evaluation/judge/map_score.hpp"
#include "tests/evaluation/judge/run_judge.hpp"
#include "tests/evaluation/judge/run_picture.hpp"
#include "tests/evaluation/judge/zone_judge.hpp"
#include "tests/evaluation/runs/job_people.hpp"
#include "tests/evaluation/runs/mission.hpp"
#include "tests/evaluation/runs/run_log.hpp"
#include "tests/evaluation/sensing/sensing_survey.hpp"

namespace luminav {
namespace {

constexpr double kPlanningRadius = 0.30;  // [m] of the disc whose shortest way is the yardstick of path_efficiency

/// [s] that this thread has computed.
double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Writes every message of a handle into an LCM log, stamped with simulated time.
class Recorder {
 public:
  Recorder(lcm::LCM& lcm, const std::string& file, const WholeRobot& robot) : log_(file, "w"), robot_(robot) {
    if (!log_.good()) {
      throw std::runtime_error(fmt::format("{}: cannot be written", file));
    }
    lcm.subscribe(".*", &Recorder::on_message, this);
  }

 private:
  void on_message(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    lcm::LogEvent event{};
    event.timestamp = robot_.utime();
    event.channel = channel;
    event.data = buffer->data;
    event.datalen = static_cast<std::int32_t>(buffer->data_size);
    log_.writeEvent(&event);
  }
  lcm::LogFile log_;
  const WholeRobot& robot_;
};

/// One line a second for whoever looks for the cause of a failure.
class Tracer {
 public:
  Tracer(lcm::LCM& lcm, const RunJudge& judge) : judge_(judge), subscriber_(lcm) {
    subscriber_.on(channels::kControlStatus, &Tracer::on_control, this);
    subscriber_.on(channels::kJobStatus, &Tracer::on_jobs, this);
  }
  void line() const {
    if (!judge_.truth() || !judge_.pose()) {
      return;
    }
    const sim_truth_t& t = *judge_.truth();
    const pose_t& p = *judge_.pose();
    fmt::print(
        "{:6.1f} true ({:6.2f} {:6.2f} {:6.1f}) v {:5.2f} w {:6.1f} clear {:4.2f} c {} | {} err {:5.2f} {:5.1f} [{}] | "
        "nav {} {} | ctl {} {}{}{}\n",
        judge_.elapsed(), t.x, t.y, degrees(t.theta), t.linear, degrees(t.angular), t.clearance, t.contacts,
        int{p.state}, judge_.position_error(), degrees(judge_.heading_error()), p.reason,
        judge_.navigation() ? int{judge_.navigation()->state} : -1,
        judge_.navigation() ? judge_.navigation()->cause : "", control_ ? int{control_->state} : -1,
        control_ ? control_->reason : "", people_text(t), job_);
  }

 private:
  void on_control(const control_status_t& status) { control_ = status; }
  void on_jobs(const job_status_t& status) {
    job_ = status.jobs.empty() ? "" : fmt::format(" | job {} {}", status.jobs[0].id, status.jobs[0].sentence);
  }
  /// Where they are, robot frame.
  static std::string people_text(const sim_truth_t& truth) {
    std::string text;
    for (std::size_t i = 0; i < truth.person_x.size(); ++i) {
      const Eigen::Vector2d seen =
          Pose2{truth.x, truth.y, truth.theta}.inverse() * Eigen::Vector2d(truth.person_x[i], truth.person_y[i]);
      text += fmt::format(" | person ({:.1f} {:.1f})", seen.x(), seen.y());
    }
    return text;
  }
  const RunJudge& judge_;
  Subscriber subscriber_;
  std::optional<control_status_t> control_;
  std::string job_;
};

/// The people of a run's jobs, who watches them, and when the job service is killed.
class JobsRun {
 public:
  JobsRun(WholeRobot& robot, const Scenario& scenario)
      : robot_(robot),
        people_(robot.lcm(), scenario, draw_jobs(scenario, robot.believed_building()), robot.simulated_world()),
        judge_(robot.lcm(), robot.believed_building(), people_, robot.simulated_world()) {}

  void step(double elapsed) {
    if (next_kill_ < people_.drawn().kills.size() && elapsed >= people_.drawn().kills[next_kill_]) {
      ++next_kill_;
      robot_.restart("jobs");
      judge_.note_kill();
    }
  }
  [[nodiscard]] bool is_finished() const { return people_.is_finished(); }
  void conclude(RunReport& report) const {
    report.jobs = judge_.result();
    report.failure = report.failure.empty() ? JobJudge::failure(*report.jobs) : report.failure;
    report.passed = report.failure.empty();
  }

 private:
  WholeRobot& robot_;
  JobPeople people_;
  JobJudge judge_;
  std::size_t next_kill_ = 0;
};

/// Each event once.
void kill_due(WholeRobot& robot, const Scenario& scenario, double elapsed, std::set<std::size_t>& killed) {
  for (std::size_t i = 0; i < scenario.events.size(); ++i) {
    const ScenarioEvent& event = scenario.events[i];
    if (event.kind == EventKind::kKill && elapsed >= event.at && killed.insert(i).second) {
      robot.restart(event.process);
    }
  }
}

void judge_zones(ZoneJudge& judge, const Mission& mission, RunReport& report) {
  if (!judge.result()) {
    return;
  }
  const std::vector<Pose2>& from = mission.request_poses();
  // the first goal's way holds the search for the pose and is left out
  for (std::size_t i = 1; i < report.goals.size() && i < from.size() && report.carries == 0; ++i) {
    if (report.goals[i].reached) {
      judge.compare(mission.driven_for_goal(i),
                    judge.shortest(from[i].position(), {report.goals[i].x, report.goals[i].y}));
    }
  }
  report.zones = judge.result();
  report.failure = report.failure.empty() ? judge.failure(report.goals) : report.failure;
  report.passed = report.failure.empty();
}

}  // namespace

RunReport conclude(const RunJudge& judge, const Mission& mission, const WorldTruth& world) {
  RunReport report = judge.report(mission.final_results());
  report.failure = mission.failure();
  if (report.failure.empty() && report.contacts > 0) {
    report.failure = report.contacts == 1 ? "1 contact" : fmt::format("{} contacts", report.contacts);
  }
  if (report.failure.empty() && report.confident_wrong_s > 0.0) {
    report.failure = fmt::format("confidently wrong for {:.1f} s", report.confident_wrong_s);
  }
  report.passed = report.failure.empty();
  double shortest = 0.0;
  double driven = 0.0;
  const std::vector<Pose2>& from = mission.request_poses();
  for (std::size_t i = 1; i < report.goals.size() && i < from.size(); ++i) {
    // the first goal's way holds the search for the pose and is left out
    const double length =
        report.goals[i].reached && !world.walls.cells.empty()
            ? octile_length(world.walls, from[i].position(), {report.goals[i].x, report.goals[i].y}, kPlanningRadius)
            : -1.0;
    report.goals[i].shortest_m = length;
    if (length > 0.0) {
      shortest += length;
      driven += mission.driven_for_goal(i);
    }
  }
  report.path_efficiency = driven > 0.0 ? shortest / driven : 0.0;
  return report;
}

RunReport run_scenario(const Scenario& scenario, const ScenarioRunOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const double cpu_start = thread_seconds();
  WholeRobot robot(scenario, options.robot);
  std::optional<Recorder> recorder;
  if (!options.log_file.empty()) {
    recorder.emplace(robot.lcm(), options.log_file, robot);
  }
  std::optional<SensingSurvey> survey;
  if (options.survey != nullptr) {
    survey.emplace(robot.lcm(), robot.world(), robot.believed_building(), robot.believed_robot().camera, scenario.seed);
  }
  RunJudge judge(robot.lcm(), scenario, robot.world());
  const DriveJudge drive_judge(robot.lcm(), robot.world());
  ZoneJudge zone_judge(robot.lcm(), robot.believed_building().zones, robot.local_clock(), robot.world());
  Mission mission(robot.lcm(), scenario, options.patrol);
  const RunLog log(robot.lcm());
  const Tracer tracer(robot.lcm(), judge);
  const std::unique_ptr<JobsRun> jobs = scenario.jobs.count > 0 ? std::make_unique<JobsRun>(robot, scenario) : nullptr;
  std::set<std::size_t> killed;
  const std::int64_t first = robot.utime();
  double last = thread_seconds();
  double worst_step = 0.0;  // [s]
  for (std::int64_t steps = 0; static_cast<double>(steps) * 0.01 < scenario.duration && !mission.is_finished() &&
                               !(jobs && jobs->is_finished());
       ++steps) {
    robot.step();
    const double now = thread_seconds();
    worst_step = std::max(worst_step, now - last);
    last = now;
    const double elapsed = static_cast<double>(robot.utime() - first) * 1e-6;
    kill_due(robot, scenario, elapsed, killed);
    if (jobs) {
      jobs->step(elapsed);
    }
    if (options.trace && steps % 100 == 99) {
      tracer.line();
    }
  }
  RunReport report = conclude(judge, mission, robot.world());
  if (survey) {
    *options.survey = std::move(survey->result());
  }
  report.drive = drive_judge.result();
  judge_zones(zone_judge, mission, report);
  if (jobs) {
    jobs->conclude(report);
  }
  report.trail = judge.trail();
  report.log = log.lines();
  report.cpu_s = thread_seconds() - cpu_start;
  report.worst_step_ms = 1e3 * worst_step;
  report.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!options.picture_file.empty()) {
    const std::optional<OccupancyGrid> grid = judge.grid();
    draw_run(options.picture_file, robot.world(), robot.believed_building(), judge.trail(), report.goals,
             grid ? &*grid : nullptr);
  }
  return report;
}

}  // namespace luminav
